"""After an actuator has failed: each mode of RARS, entered on an order, then 5 m on by the truth."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Final

import pytest

from emulators.bench.faults import Fault
from emulators.epos2.drive import Epos2
from emulators.robots.rars import RarsStep as Step
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen.objects import STATUSWORD
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.wire.power_states import state_of
from firmware_bridge.motion import davis
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, fault, step

RARS: Final[AnyRobot] = find("rars")
BASE: Final = RARS.geometry.base
DIES_AT_S: Final = 6.0
MODE_AT_S: Final = 9.0
GOES_AT_S: Final = MODE_AT_S + 2.5
GOAL_M: Final = 5.0
MOST_PER_M: Final = RARS.geometry.degraded.wheel_curvature_per_m
NARROW_MPS: Final = RARS.geometry.degraded.speed_mps
DEAD: Final = {
    "left_failed": "left",
    "right_failed": "right",
    "steering_failed": "steer",
    "lift_failed": "lift",
}


def unpowered(node: str, at_s: float = DIES_AT_S, **how: float) -> Fault:
    """Return a fault of the gate drivers' supply: a motor that cannot be switched on, and is reported."""
    return fault("gate_supply_sag", at_s, node=node, to_v=0.0, **how)


def silenced(node: str, at_s: float = DIES_AT_S, **how: float) -> Fault:
    """All cables of a drive are out: nothing is received from it any more."""
    return fault("node_silent", at_s, node=node, **how)


def goes_on(mode: str, *more: Step, steer_deg: float = 0.0) -> tuple[Step, ...]:
    """Return the operator's steps: drive, be stopped, order the mode, arm, and drive on."""
    return (
        ARMED,
        step(4.0, speed_mps=0.3, steer_deg=steer_deg),
        step(7.5, speed_mps=0.0, steer_deg=0.0),
        step(MODE_AT_S, mode=mode),
        step(MODE_AT_S + 0.5, arm=True),
        *more,
    )


def drives(seconds: float, speed_mps: float = 0.2) -> tuple[Step, Step]:
    return step(GOES_AT_S, speed_mps=speed_mps), step(GOES_AT_S + seconds, speed_mps=0.0)


def reached(ride: Ride, since_s: float) -> float:
    """Return the robot's distance since then, in m along its way, by the plant."""
    places = [(row["x_m"], row["y_m"]) for row in ride.rows(since_s, 1e6)]
    return sum(math.dist(before, after) for before, after in pairwise(places))


def odometry_error(ride: Ride) -> float:
    """Return the error of the bridge's pose in the motion since the mode was entered, in m."""
    rows = ride.rows(MODE_AT_S + 2.0, 1e6)
    first, last = rows[0], rows[-1]
    reported = ride.operator.diary.odometry
    began, ended = next(one for one in reported if one.received_at >= first.at), reported[-1]
    true = _from(first["x_m"], first["y_m"], first["heading_rad"], last["x_m"], last["y_m"])
    return math.dist(true, _from(began.x_m, began.y_m, began.heading_rad, ended.x_m, ended.y_m))


def _from(x: float, y: float, heading: float, to_x: float, to_y: float) -> tuple[float, float]:
    ahead, aside = to_x - x, to_y - y
    cosine, sine = math.cos(heading), math.sin(heading)
    return ahead * cosine + aside * sine, aside * cosine - ahead * sine


def power(ride: Ride, name: str) -> PowerState | None:
    return state_of(ride.rig.devices.nodes(Epos2)[name].store.get(STATUSWORD))


def texts(ride: Ride) -> str:
    return " | ".join(entry.text for entry in ride.operator.diary.entries)


@pytest.mark.long(beside="test_a_wheel_that_drives_alone_takes_the_robot_on")
@pytest.mark.parametrize("dies", [unpowered, silenced])
@pytest.mark.parametrize("mode", DEAD)
def test_after_a_failure_in_motion_the_goal_five_meters_away_is_reached(
    rides: Ridden, mode: str, dies: Callable[[str], Fault]
) -> None:
    ride = rides(*goes_on(mode, *drives(28.0)), seconds=45, faults=(dies(DEAD[mode]),))
    ride.runs_until(MODE_AT_S)
    assert abs(ride.now["speed_mps"]) < 0.002, "a dead actuator stops the robot"
    ride.runs_until(42.0)
    assert reached(ride, MODE_AT_S) > GOAL_M
    assert ride.fastest(MODE_AT_S) < NARROW_MPS + 0.005
    assert abs(ride.now["speed_mps"]) < 0.002
    # One wheel that drives alone pulls the robot aside, by some 0.02 1/m.
    alone = mode in ("left_failed", "right_failed")
    assert odometry_error(ride) < (0.4 if alone else 0.05)
    assert power(ride, DEAD[mode]) is not PowerState.OPERATION_ENABLED


def test_a_wheel_that_drives_alone_takes_the_robot_on(rides: Ridden) -> None:
    ride = rides(*goes_on("left_failed", *drives(3.0)), seconds=20, faults=(unpowered("left"),))
    ride.runs_until(15.5)
    assert reached(ride, MODE_AT_S) > 0.5
    assert ride.operator.diary.armed
    assert power(ride, "left") is PowerState.FAULT


@pytest.mark.long(beside="test_a_wheel_that_drives_alone_takes_the_robot_on")
def test_with_a_failed_steering_the_wheels_steer_as_straight_as_they_can(rides: Ridden) -> None:
    ride = rides(
        *goes_on("steering_failed", *drives(8.0), steer_deg=10.0),
        seconds=30,
        faults=(unpowered("steer"),),
    )
    ride.runs_until(22.5)
    rows = ride.rows(GOES_AT_S + 1.0, GOES_AT_S + 8.0)
    turned = rows[-1]["heading_rad"] - rows[0]["heading_rad"]
    # The rack alone would turn it by 0.33 1/m; the wheels take 0.28 1/m from that.
    bend = davis.curvature(BASE, ride.now["steer_rad"])
    assert bend == pytest.approx(0.331, rel=0.05)
    assert turned / reached_in(rows) == pytest.approx(bend - MOST_PER_M, abs=0.03)
    assert ride.now["steer_rad"] == pytest.approx(math.radians(10.0), rel=0.05)
    assert any("with the rack at 10 deg the wheels" in reason for reason in ride.held("steering out of use"))


def reached_in(rows: list) -> float:  # type: ignore[type-arg]
    """The way of the rear axle's middle."""
    return sum(math.dist((a["x_m"], a["y_m"]), (b["x_m"], b["y_m"])) for a, b in pairwise(rows))


def test_a_mode_is_not_entered_in_motion_nor_while_armed(rides: Ridden) -> None:
    ride = rides(
        ARMED,
        step(4.0, speed_mps=0.3),
        step(5.0, mode="left_failed"),
        step(8.5, mode="left_failed"),
        seconds=20,
    )
    ride.runs_until(8.0)
    assert "stop and disarm first" in texts(ride)
    assert abs(ride.now["speed_mps"]) < 0.002, "a station that requests another mode does not drive by hand"
    ride.runs_until(10.0)
    assert power(ride, "left") is PowerState.OPERATION_ENABLED


@pytest.mark.long(beside="test_a_wheel_that_drives_alone_takes_the_robot_on")
def test_a_drive_that_heals_is_given_no_power_until_the_robot_is_whole_again(rides: Ridden) -> None:
    ride = rides(
        *goes_on("left_failed", *drives(4.0)),
        step(17.0, disarm=True),
        step(18.0, mode=""),
        step(19.0, arm=True),
        step(21.0, arm=True),
        step(23.0, speed_mps=0.2),
        seconds=30,
        faults=(silenced("left", for_s=6.0),),
    )
    ride.runs_until(16.5)
    assert reached(ride, MODE_AT_S) > 0.5
    assert power(ride, "left") is not PowerState.OPERATION_ENABLED
    ride.runs_until(25.0)
    assert power(ride, "left") is PowerState.OPERATION_ENABLED
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)


@pytest.mark.long(beside="test_a_wheel_that_drives_alone_takes_the_robot_on")
def test_a_second_failure_stops_the_robot_for_good(rides: Ridden) -> None:
    ride = rides(
        *goes_on("left_failed", *drives(16.0)),
        step(18.0, mode="right_failed"),
        step(19.0, arm=True),
        seconds=30,
        faults=(unpowered("left"), unpowered("right", 14.0)),
    )
    ride.runs_until(22.0)
    assert ride.stands_from(14.0, slower_than=0.01) < 17.5
    assert not ride.operator.diary.armed


def test_a_platform_that_stays_up_keeps_the_base_where_it_is(rides: Ridden) -> None:
    ride = rides(
        ARMED,
        step(4.0, lift_m=0.05),
        step(7.0, mode="lift_failed"),
        step(7.5, arm=True),
        step(9.5, speed_mps=0.2),
        seconds=20,
        faults=(unpowered("lift", 6.0),),
    )
    ride.runs_until(12.0)
    assert ride.fastest(6.0) < 0.002
    assert ride.held("lift extended")


@pytest.mark.long(beside="test_a_wheel_that_drives_alone_takes_the_robot_on")
@pytest.mark.parametrize("mode", ["left_failed", "steering_failed"])
def test_over_serial_it_is_the_same(rides: Ridden, mode: str) -> None:
    ride = rides(
        *goes_on(mode, *drives(6.0)),
        seconds=25,
        robot=over_serial(RARS),
        faults=(unpowered(DEAD[mode]),),
    )
    ride.runs_until(18.5)
    assert reached(ride, MODE_AT_S) > 0.8


BEFORE_SET_UP: Final = (step(0.0, zero={"steering": 0.0, "lift": 0.0}), step(0.0, mode="steering_failed"))
"""Both are ordered before the drives are set up: what has to wait is answered so, and repeated."""


def test_a_mode_waits_until_the_position_before_it_is_confirmed(rides: Ridden) -> None:
    ride = rides(*BEFORE_SET_UP, step(6.0, arm=True), *drives(1.0), seconds=14)
    ride.runs_until(8.0)
    assert "mode: the position of node 3 (steering) is being confirmed; wait" in texts(ride)
    assert ride.operator.diary.armed
    assert "mode: accepted" in texts(ride)


def test_in_a_mode_the_position_of_the_axis_that_it_excludes_is_refused_with_the_reason(
    rides: Ridden,
) -> None:
    ride = rides(*BEFORE_SET_UP[::-1], step(6.0, arm=True), seconds=14)
    ride.runs_until(8.0)
    assert "zero: this mode excludes node 3 (steering); leave it, confirm, then enter it again" in texts(ride)
    assert not ride.operator.diary.armed
    assert "mode: accepted" in texts(ride)
