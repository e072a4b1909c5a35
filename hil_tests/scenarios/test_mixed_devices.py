"""Devices of several links, and of several families, above one plant: ROME's base with its wheels apart."""

from enum import StrEnum
from typing import Any

import pytest
import typer

from emulators.arduino_omni.board import Board
from emulators.cli.emulate_robot import RobotOptions, run
from emulators.devices import devices
from emulators.epos2.drive import Epos2
from emulators.epos2.family import FAMILY
from emulators.family import family_of
from emulators.rig import BRIDGE
from emulators.testing.inherited.scripted import scripted
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.families.motor_shield.settings import ShieldAxis
from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.robot.table import LinkTable
from firmware_bridge.robot_types import find
from hil_tests.scenarios.rome_ride import AHEAD, STANDSTILL_MPS, speed


def two_boards() -> AnyRobot:
    """Return the base with its third wheel at the shield of a second board."""
    rome = over_protocol(find("rome"), "arduinoio", 2)
    *others, third = rome.axes
    settings = ShieldAxis.of(third).model_copy(update={"port": 1, "encoder_pins": (2, 3)})
    third = third.model_copy(update={"link": "second", "settings": settings})
    return rome.with_links({"second": rome.links["board"]}).model_copy(update={"axes": (*others, third)})


def board_and_drive() -> AnyRobot:
    """Return the base with its third wheel at a drive."""
    rome, rars = over_protocol(find("rome"), "arduinoio", 2), find("rars")
    *others, third = rome.axes
    settings = Epos2Axis.of(next(axis for axis in rars.axes if axis.name == "left"))
    third = third.model_copy(update={"link": "drives", "settings": settings})
    return rome.with_links(rars.links).model_copy(update={"axes": (*others, third)})


ROBOTS = {"two boards": two_boards, "board and drive": board_and_drive}


@pytest.mark.parametrize("name", ROBOTS)
def test_wheels_of_several_devices_carry_one_base_and_lose_their_power_together(name: str) -> None:
    mission = AHEAD.format(duration=9.0, faults="", title="go", word="speed_mps = 0.2")
    with scripted(ROBOTS[name](), mission) as rig:
        rig.runs(7.0)
        assert speed(rig) == pytest.approx(0.2, abs=0.005)
        assert abs(rig.samples[-1]["yaw_rate_rad_s"]) < 0.01
        moment = rig.snapshot()
        rig.runs(1.0)
        first = rig.world.trace_sha256
        rig.restore(moment)
        rig.runs(1.0)
        assert rig.world.trace_sha256 == first
        rig.world.stop(BRIDGE)
        rig.runs(4.0)
        assert rig.bridge.finished
        assert rig.bridge.not_acknowledged == ()
        assert not any(axis.powered for axis in rig.devices.axes)
        assert speed(rig) < STANDSTILL_MPS


def test_each_device_has_a_station_on_the_wires_of_its_link() -> None:
    made = devices(board_and_drive())
    with made.plant:
        assert made.nodes(Board).keys() == {"board"}
        assert made.nodes(Epos2).keys() == {"three"}
        assert sorted(axis.name for axis in made.axes) == ["one", "three", "two"]


def test_boards_and_drives_are_not_put_on_real_ports_together(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("firmware_bridge.cli.robot_argument.find_robot", lambda _: board_and_drive())
    given: Any = {"robot": "rome"}
    with pytest.raises(typer.Exit):
        run(RobotOptions(**given))
    assert "rome has boards and drives" in capsys.readouterr().err


def test_two_arms_cannot_be_on_one_plant() -> None:
    arm = find("ar2")
    both = arm.with_links({"second": arm.links["arm"]})
    with pytest.raises(RobotFileError, match="the arm on 'arm' and the arm on 'second' both set the plant's"):
        devices(both)


def test_devices_that_step_the_plant_themselves_do_not_share_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("emulators.devices.families_of", lambda _: (FAMILY, FAMILY))
    with pytest.raises(RobotFileError, match="EPOS2 drives and EPOS2 drives cannot move one plant"):
        devices(find("rars"))


class Driver(StrEnum):
    OTHER = "other"


class OtherLink(LinkTable):
    driver: Driver


def test_a_link_that_no_family_emulates_is_refused_by_the_word_of_its_driver() -> None:
    rars = find("rars")
    other = OtherLink(driver=Driver.OTHER, silent_ms=100)
    robot = rars.model_copy(update={"links": {**rars.links, "more": other}})
    assert family_of(robot, "drives") is FAMILY
    with pytest.raises(RobotFileError, match="'other' is not emulated: no installed package has a family"):
        devices(robot)
