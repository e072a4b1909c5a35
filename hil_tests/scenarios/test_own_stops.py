"""Drives that stop by themselves in a turn: each wheel brakes in proportion to its speed, for the ratio."""

from typing import Final

import pytest

from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.motion import davis
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, step

BASE: Final = find("rars").geometry.base
DOWN_TO: Final = 0.2
"""Share of the speed at its begin down to which the stop is judged."""
BOUND: Final = 0.05


def without_proportion() -> AnyRobot:
    """RARS whose drives keep the quick stop deceleration of the robot file."""
    robot, axes = find("rars"), []
    for axis in robot.axes:
        profile = Epos2Axis.of(axis).profile.model_copy(update={"quick_stop_least_rpm_s": None})
        settings = Epos2Axis.of(axis).model_copy(update={"profile": profile})
        axes.append(axis.model_copy(update={"settings": settings}))
    return robot.model_copy(update={"axes": tuple(axes)})


def worst_ratio(ride: Ride, began_s: float) -> float:
    """Return the largest error of the wheels' ratio at any instant of the stop, by the plant."""
    rows = ride.rows(began_s, began_s + 3.0)
    slow, worst = DOWN_TO * abs(rows[0]["speed_mps"]), 0.0
    for row in rows:
        across = BASE.rear_track_m / 2.0 * davis.curvature(BASE, row["steer_rad"])
        left, right = row["motor_speed_left_rad_s"], row["motor_speed_right_rad_s"]
        if abs(row["speed_mps"]) < slow:
            return worst
        worst = max(worst, abs(right / left * (1.0 - across) / (1.0 + across) - 1.0))
    raise AssertionError("it has not stopped")


def stopped(rides: Ridden, speed: float, steer: float, **how: object) -> Ride:
    ride = rides(
        ARMED, step(4.0, speed_mps=0.01, steer_deg=steer), step(6.0, speed_mps=speed), seconds=20, **how
    )
    ride.runs_until(9.0)
    # Without the bridge's heartbeat each drive stops by itself.
    ride.rig.world.silence("bridge", ride.rig.world.now)
    ride.runs_until(12.0)
    return ride


@pytest.mark.parametrize(
    ("speed", "steer"), [(0.5, 10.0), (0.5, 30.0), (0.5, -58.0), (0.3, 58.0), (-0.5, 30.0), (0.2, 58.0)]
)
def test_drives_that_lose_the_bridge_in_a_turn_keep_the_ratio(
    rides: Ridden, speed: float, steer: float
) -> None:
    assert worst_ratio(stopped(rides, speed, steer), 9.0) < BOUND


def test_with_equal_decelerations_the_inner_wheel_would_stand_first(rides: Ridden) -> None:
    ride = stopped(rides, 0.5, 10.0, robot=without_proportion())
    assert worst_ratio(ride, 9.0) > 4.0 * BOUND
