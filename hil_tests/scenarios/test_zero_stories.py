"""A drive that has restarted counts from 0 in any position of its axis; nothing moves before a check.

The truth is the plant's. Each story runs over CAN and over the serial line.
"""

import math
from typing import Final

import pytest

from emulators.epos2.drive import Epos2
from firmware_bridge.canopen import objects as od
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, fault, step

CAN: Final = find("rars")
USB: Final = over_serial(CAN, Generation.V2)
LINKS: Final = pytest.mark.parametrize("robot", [CAN, USB], ids=["can", "serial"])
RAISED_M: Final = 0.05
TURNED_DEG: Final = 45.0
LIFT_ERROR_M: Final = 3e-4
STEER_ERROR_DEG: Final = 0.5


def steer_deg(one: Ride) -> float:
    return math.degrees(one.now["steer_rad"])


def answers(one: Ride, since: float) -> list[str]:
    """Return the results of the operator's commands."""
    entries = one.operator.diary.entries
    return [entry.text for entry in entries if entry.kind == "answered" and entry.at >= from_seconds(since)]


def kept_back(one: Ride) -> list[str]:
    """Return the guard's refusals, except its own commands for a bridge whose line was held up."""
    return [refusal.reason for refusal in one.rig.guard.refusals if refusal.packet is not None]


def reported(one: Ride) -> str:
    return " | ".join(entry.text for entry in one.operator.diary.entries)


@pytest.mark.long(keeps=["can"])
@LINKS
def test_a_raised_lift_that_restarts_is_believed_where_someone_saw_it(rides: Ridden, robot: AnyRobot) -> None:
    one = rides(
        ARMED,
        step(4.0, lift_m=RAISED_M),
        step(12.5, speed_mps=0.2),
        step(14.0, speed_mps=0.0),
        step(14.5, zero={"lift": RAISED_M}),
        step(15.5, arm=True),
        step(16.0, speed_mps=0.2),
        step(17.5, speed_mps=0.0),
        step(18.0, lift_m=0.0),
        step(24.0, speed_mps=0.2),
        step(10.0, arm=True),
        seconds=40,
        robot=robot,
        faults=[fault("drive_restart", 9.0, node="lift", for_s=0.2)],
    )
    one.runs_until(14.4)
    assert "reference lost: lift" in one.holding
    assert one.fastest(9.5, 14.4) < 0.002
    assert one.now["lift_m"] == pytest.approx(RAISED_M, abs=LIFT_ERROR_M)
    one.runs_until(17.4)
    assert "zero of lift: accepted" in answers(one, 14.5)
    assert one.operator.diary.armed
    assert "lift extended" in one.holding, "it knows that the lift is up"
    assert one.fastest(14.5, 17.4) < 0.002
    one.runs_until(23.9)
    assert one.now["lift_m"] == pytest.approx(0.0, abs=LIFT_ERROR_M), "0 is where it was"
    one.runs_until(26.0)
    assert one.now["speed_mps"] == pytest.approx(0.2, rel=0.03)
    assert kept_back(one) == []


@pytest.mark.long(keeps=["can"])
@LINKS
def test_steering_that_restarts_at_45_degrees_does_not_run_into_its_stop(
    rides: Ridden, robot: AnyRobot
) -> None:
    one = rides(
        ARMED,
        step(4.0, speed_mps=0.1, steer_deg=TURNED_DEG),
        step(10.5, speed_mps=0.0, steer_deg=0.0),
        step(11.0, arm=True),
        step(16.0, zero={"steering": TURNED_DEG}),
        step(17.0, arm=True),
        step(22.0, speed_mps=0.1, steer_deg=-TURNED_DEG),
        seconds=30,
        robot=robot,
        faults=[fault("drive_restart", 10.0, node="steer", for_s=0.2)],
    )
    one.runs_until(15.9)
    assert "reference lost: steer" in one.holding
    assert one.fastest(11.5, 15.9) < 0.002
    assert steer_deg(one) == pytest.approx(TURNED_DEG, abs=STEER_ERROR_DEG), "it stays where it was"
    one.runs_until(21.9)
    assert "zero of steering: accepted" in answers(one, 16.0)
    assert one.operator.diary.armed
    assert steer_deg(one) == pytest.approx(0.0, abs=STEER_ERROR_DEG)
    one.runs_until(28.0)
    assert steer_deg(one) == pytest.approx(-TURNED_DEG, abs=2 * STEER_ERROR_DEG)
    assert kept_back(one) == []


@pytest.mark.long(beside="test_steering_that_restarts_at_45_degrees_does_not_run_into_its_stop")
@LINKS
def test_a_lift_that_restarts_on_its_way_is_disarmed_and_stays(rides: Ridden, robot: AnyRobot) -> None:
    one = rides(
        ARMED,
        step(4.0, lift_m=0.3),
        step(7.0, arm=True),
        seconds=20,
        robot=robot,
        faults=[fault("drive_restart", 6.0, node="lift", for_s=0.05)],
    )
    one.runs_until(6.5)
    stood = one.now["lift_m"]
    assert 0.02 < stood < 0.28
    one.runs_until(17.0)
    assert one.now["lift_m"] == pytest.approx(stood, abs=1e-3)
    assert "reference lost: lift" in one.holding
    assert one.operator.diary.armed is False


@pytest.mark.long(keeps=["can"])
@LINKS
def test_a_robot_that_starts_with_its_lift_up_is_not_armed_unseen(rides: Ridden, robot: AnyRobot) -> None:
    """Its bridge has never seen it before; an operator who sends nothing drives nothing."""
    one = rides(ARMED, step(4.0, speed_mps=0.2), seconds=8, robot=robot, stands=False)
    one.runs_until(7.0)
    assert {"reference lost: steer", "reference lost: lift"} <= one.holding
    assert one.fastest() < 0.002
    assert "look where it stands, and confirm it" in reported(one)


@pytest.mark.long(beside="test_a_stop_in_the_middle_leaves_it_lost_and_the_drive_is_set_up_again")
def test_an_emergency_stop_while_a_zero_is_set_leaves_it_lost(rides: Ridden) -> None:
    """Over a serial line it takes long enough for that; what the drive took does not count."""
    one = rides(
        step(2.0, zero={"lift": RAISED_M}),
        step(2.02, emergency_stop=True),
        step(3.0, clear=True),
        step(4.0, arm=True),
        step(8.0, zero={"steering": 0.0, "lift": 0.0}),
        step(9.0, arm=True),
        seconds=12,
        robot=USB,
        stands=False,
    )
    one.runs_until(7.9)
    assert "reference lost: lift" in one.holding
    one.runs_until(11.0)
    assert answers(one, 8.0)[-1] == "arm: accepted"
    assert kept_back(one) == []


def test_a_wheel_that_restarts_needs_no_one(rides: Ridden) -> None:
    one = rides(
        ARMED,
        step(4.0, speed_mps=0.2),
        step(6.5, speed_mps=0.0),
        step(8.0, arm=True),
        step(10.0, speed_mps=0.2),
        seconds=14,
        faults=[fault("drive_restart", 6.0, node="left", for_s=0.2)],
    )
    one.runs_until(12.0)
    assert one.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
    assert not one.held("reference lost: left")


@pytest.mark.long(keeps=["can-0.05-right", "serial-0.339-left"])
@pytest.mark.parametrize("node", ["left", "right"])
@pytest.mark.parametrize("for_s", [0.05, 0.339])
@LINKS
def test_a_drive_that_restarts_before_it_is_armed_has_no_power_without_its_watch(
    rides: Ridden, robot: AnyRobot, node: str, for_s: float
) -> None:
    """Over a serial line its boot-up is not seen; `left` is the drive on the line, `right` one behind it."""
    one = rides(
        step(6.0, arm=True),
        step(8.0, arm=True),
        seconds=11,
        robot=robot,
        faults=[fault("drive_restart", 3.0, node=node, for_s=for_s)],
    )
    drives = one.rig.devices.nodes(Epos2)
    for tenth in range(30, 110):
        one.runs_until(tenth / 10)
        powered = {axis.name for axis in one.rig.devices.axes if axis.powered}
        unwatched = {
            name for name in powered if not int(drives[name].store.get(od.CONSUMER_HEARTBEAT_1)) & 0xFFFF
        }
        assert not unwatched, tenth
    assert powered == set(drives)
