"""After an actuator has failed: each mode of RARS, entered on an order, and 5 m further on by the plant's truth."""

import math
from typing import Final

import pytest

from emulators.bench.faults import Fault
from emulators.robots.rars import RarsStep as Step
from firmware_bridge.kinds import find
from firmware_bridge.robot import AnyRobot
from firmware_bridge.wire.cia402 import State, state_of
from firmware_bridge.wire.epos2.address import STATUSWORD
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, fault, step

RARS: Final[AnyRobot] = find("rars")
BASE: Final = RARS.geometry.base
DIES_AT_S: Final = 6.0
MODE_AT_S: Final = 9.0
GOAL_M: Final = 5.0
NARROW_MPS: Final = RARS.geometry.failed.speed_mps
DEAD: Final = {
    "left_failed": "left",
    "right_failed": "right",
    "steering_failed": "steer",
    "lift_failed": "lift",
}


def unpowered(node: str, at_s: float = DIES_AT_S) -> Fault:
    """The power stage's gate drivers have no supply any more: a motor that nobody can switch on, told."""
    return fault("gate_supply_sag", at_s, node=node, to_v=0.0)


def silenced(node: str, at_s: float = DIES_AT_S) -> Fault:
    """All cables of a drive are out: nothing is heard of it any more."""
    return fault("node_silent", at_s, node=node)


def goes_on(mode: str, *faults: Fault, steer_deg: float = 0.0, drives: float = 30.0) -> tuple[Step, ...]:
    """What an operator does: drives, finds himself stopped, orders the mode, arms, and drives on."""
    del faults
    return (
        ARMED,
        step(4.0, speed_mps=0.3, steer_deg=steer_deg),
        step(7.5, speed_mps=0.0),
        step(MODE_AT_S, mode=mode),
        step(MODE_AT_S + 0.5, arm=True),
        step(MODE_AT_S + 2.5, speed_mps=0.2),
        step(MODE_AT_S + 2.5 + drives, speed_mps=0.0),
    )


def reached(ride: Ride, since_s: float) -> float:
    """How far the robot came since then, in m along its way, by the plant."""
    rows = ride.rows(since_s, 1e6)
    return sum(
        math.hypot(after["x_m"] - before["x_m"], after["y_m"] - before["y_m"])
        for before, after in zip(rows, rows[1:], strict=False)
    )


def odometry_error(ride: Ride) -> float:
    """How far the bridge's pose is from where the robot has come since the mode was entered, in m."""
    rows = ride.rows(MODE_AT_S + 2.0, 1e6)
    first, last = rows[0], rows[-1]
    began = next(one for one in ride.operator.diary.odometry if one.heard_at >= first.at)
    ended = ride.operator.diary.odometry[-1]
    true = _moved(first["x_m"], first["y_m"], first["heading_rad"], last["x_m"], last["y_m"])
    told = _moved(began.x_m, began.y_m, began.heading_rad, ended.x_m, ended.y_m)
    return math.dist(true, told)


def _moved(x: float, y: float, heading: float, to_x: float, to_y: float) -> tuple[float, float]:
    ahead, aside = to_x - x, to_y - y
    cosine, sine = math.cos(heading), math.sin(heading)
    return ahead * cosine + aside * sine, aside * cosine - ahead * sine


def power(ride: Ride, name: str) -> State | None:
    return state_of(ride.rig.devices.drives[name].store.get(STATUSWORD))


@pytest.mark.parametrize("dies", [unpowered, silenced])
@pytest.mark.parametrize("mode", DEAD)
def test_after_a_failure_in_motion_the_goal_five_metres_away_is_reached(rides: Ridden, mode, dies) -> None:  # type: ignore[no-untyped-def]
    steps = goes_on(mode)
    ride = rides(*steps, seconds=45, faults=(dies(DEAD[mode]),))
    ride.runs_until(MODE_AT_S)
    assert abs(ride.now["speed_mps"]) < 0.002, "a dead actuator stops the robot"
    ride.runs_until(44.0)
    assert reached(ride, MODE_AT_S) > GOAL_M
    assert ride.fastest(MODE_AT_S) < NARROW_MPS + 0.005
    assert odometry_error(ride) < 0.05
    assert power(ride, DEAD[mode]) is not State.OPERATION_ENABLED
