"""RARS on CiA 402 drives: its missions, interlocks and stops as on its EPOS2; and each difficult drive."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from emulators.bench import mission as missions
from emulators.cia402.servo import Servo
from emulators.cia402.variations import VARIATIONS
from emulators.robots.rars import BENCH_SETUP
from emulators.run import RunOrder, drive
from emulators.testing.rig import VirtualRig
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from hil_tests.unit.cia402_drives.on_servos import rars

ARMED_S = 5.0
LASTING_S = {"mode-synchronizes": 24.0, "mode-without-power": 12.0, "no-mode-while-halted": 12.0}
"""A drive that takes 5 s for a mode changes it three times; one that takes none is tried again and again."""
FORWARD_MPS = 0.2
STANDS_MPS = 0.003
"""Without power the frame rocks on its wheels."""
REFUSED = {
    "mode-without-power": ("lift", "it takes no mode with its power on"),
    "no-mode-while-halted": ("lift", "no-mode-while-halted"),
    "statusword-by-event": ("left", "the bridge samples its drives by SYNC"),
}
"""The variations with which the robot is not armed: the varied axis, and the reason."""


@pytest.fixture
def rigs() -> Iterator[list[VirtualRig]]:
    made: list[VirtualRig] = []
    yield made
    for rig in made:
        rig.bench.finish()


def servos(rig: VirtualRig) -> dict[str, Servo]:
    return rig.bench.devices.nodes(Servo)


def states(rig: VirtualRig) -> dict[str, PowerState]:
    return {name: servo.motion.state for name, servo in servos(rig).items()}


def within_limits(rig: VirtualRig) -> None:
    """No axis is faster than its file allows, at any sample, and the guard has refused nothing."""
    assert rig.bench.guard.refused == 0
    for axis in rig.robot.axes:
        fastest = max(map(abs, rig.bench.samples.column(f"motor_speed_{axis.name}_rad_s")))
        assert fastest <= axis.top_speed * axis.ratio * 1.05, axis.name


@pytest.mark.parametrize("name", [*VARIATIONS])
def test_with_each_difficult_drive_it_drives_and_stops_or_is_not_armed(
    rigs: list[VirtualRig], name: str
) -> None:
    rigs.append(rig := VirtualRig(rars()))
    for node in ("left", "lift"):
        rig.fault("drive_variation", node=node, names=[name])
    rig.bench.runs(LASTING_S.get(name, ARMED_S))
    if name == "mode-synchronizes":
        rig.operator.arms()
        rig.bench.runs(1.0)
    assert VARIATIONS[name].bridge.startswith("drives") or name in REFUSED
    if name in REFUSED:
        axis, reason = REFUSED[name]
        texts = " ".join((*rig.interlock_events.values(), *rig.operator.texts))
        assert reason in texts
        assert rig.robot.axes[[it.name for it in rig.robot.axes].index(axis)].title in texts
        assert not rig.operator.armed
        rig.operator.drives(FORWARD_MPS)
        rig.bench.runs(1.0)
        assert max(map(abs, rig.bench.samples.column("speed_mps"))) == 0.0
        return
    assert rig.operator.armed
    assert set(states(rig).values()) == {PowerState.OPERATION_ENABLED}
    rig.operator.drives(FORWARD_MPS)
    rig.bench.runs(2.0)
    assert rig.body.speed_mps == pytest.approx(FORWARD_MPS, abs=0.01)
    rig.operator.stops()
    rig.bench.runs(3.0)
    assert abs(rig.body.speed_mps) < STANDS_MPS
    assert set(states(rig).values()) <= {PowerState.SWITCH_ON_DISABLED}
    within_limits(rig)


@pytest.mark.parametrize("silenced", ["bridge", "left"])
def test_without_the_bridge_each_drive_stops_by_itself_and_ends_without_power(
    rigs: list[VirtualRig], silenced: str
) -> None:
    rigs.append(rig := VirtualRig(rars()))
    rig.bench.runs(4.0)
    rig.operator.drives(FORWARD_MPS)
    rig.bench.runs(2.0)
    rig.bench.world.silence(silenced, rig.bench.world.now)
    rig.bench.runs(2.0)
    off = {PowerState.SWITCH_ON_DISABLED, PowerState.FAULT}
    assert {state for name, state in states(rig).items() if name in {"left", "right"}} <= off
    assert max(map(abs, rig.bench.samples.column("speed_mps")[-20:])) < STANDS_MPS
    within_limits(rig)


def test_a_drive_that_restarts_is_set_up_again_and_not_enabled(rigs: list[VirtualRig]) -> None:
    rigs.append(rig := VirtualRig(rars()))
    rig.bench.runs(4.0)
    rig.fault("drive_restart", node="lift", for_s=0.5)
    rig.bench.runs(4.0)
    assert states(rig)["lift"] is PowerState.SWITCH_ON_DISABLED
    assert "axis restarted: lift" in rig.interlock_events
    assert not rig.operator.armed


def confirmed_at(rig: VirtualRig, height_m: float) -> None:
    """Disarm, and state how high the lift is."""
    rig.operator.disarms()
    rig.bench.runs(3.0)
    rig.operator.does("confirms", zero={"lift": height_m})
    rig.bench.runs(3.0)


@pytest.mark.parametrize("home", ["negative", "itself"])
def test_a_drive_that_reads_its_home_offset_the_other_way_is_not_referenced(
    rigs: list[VirtualRig], home: str
) -> None:
    """By the sign of 0x607C the lift would stand far below its end: the drive's count shows it."""
    rigs.append(rig := VirtualRig(rars(("node = 4\n", f'node = 4\nhome = "{home}"\n'))))
    rig.fault("drive_variation", node="lift", names=["offset-added"])
    rig.bench.runs(4.0)
    confirmed_at(rig, 0.3)
    rig.operator.arms()
    rig.bench.runs(1.0)
    assert "where its zero was set to" in " ".join(rig.operator.texts)
    assert "axis restarted: lift" in rig.interlock_events


@pytest.mark.parametrize("home", ["negative", "itself"])
def test_a_drive_is_referenced_by_either_reading_of_its_home_offset(
    rigs: list[VirtualRig], home: str
) -> None:
    rigs.append(rig := VirtualRig(rars(("node = 4\n", f'node = 4\nhome = "{home}"\n'))))
    rig.bench.runs(4.0)
    confirmed_at(rig, 0.3)
    # Its height is known again, and too high for driving.
    assert set(rig.interlock_events) == {"not armed", "lift extended"}


def test_the_battery_is_measured_by_a_drive(rigs: list[VirtualRig]) -> None:
    rigs.append(rig := VirtualRig(rars()))
    rig.bench.runs(4.0)
    assert rig.interlock_events == {}
    rig.fault("supply_sag", to_v=20.0, for_s=30.0)
    rig.bench.runs(20.0)
    assert "battery low" in rig.interlock_events


@pytest.mark.long(beside="test_with_each_difficult_drive_it_drives_and_stops_or_is_not_armed")
def test_the_circles_of_the_thesis_are_driven_as_by_its_own_drives(tmp_path: Path) -> None:
    paths = [driven(robot, tmp_path / str(number)) for number, robot in enumerate((rars(), find("rars")))]
    (servo, servo_events), (epos2, epos2_events) = paths
    assert servo == pytest.approx(epos2, rel=0.001)
    names = {"axis restarted: steer": "reference lost: steer", "axis restarted: lift": "reference lost: lift"}
    assert {names.get(name, name) for name in servo_events} == set(epos2_events)


def driven(robot: AnyRobot, folder: Path) -> tuple[float, list[str]]:
    """Drive the circles; return the length of the path, and the interlocks that were active."""
    mission = missions.find("circles", robot, BENCH_SETUP)
    drive(RunOrder(robot, BENCH_SETUP, "circles", mission, 0, folder), lambda _: None)
    read = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return read["path_length_m"], [event["name"] for event in read["interlock_events"]]
