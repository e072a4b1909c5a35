"""RARS's kinematic model, from its axes and to its axes: each wheel its own, to both sides."""

from typing import Any, Final

import pytest

from firmware_bridge.drivers.driver import Feedback, Position, Speed
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.motion import davis, scissor
from firmware_bridge.motion.pose import Pose
from firmware_bridge.motion.tables import DavisBase
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.robots.rars.kinematics import BASE_MOVES_MPS, LEASH_S, ramp_of
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.units import SECOND

ROBOT: Final[Any] = find("rars")
BODY: Final[Any] = ROBOT_TYPE.kinematics(ROBOT)
BASE: Final[DavisBase] = ROBOT.geometry.base
LIFT: Final = ROBOT.geometry.lift
RATE: Final = ROBOT.geometry.limits.lift_rate_mps
TOP: Final = scissor.highest(LIFT)
STATE: Final = RarsState(0.2, 0.1, 0.0, 0.0, 0.0)


def axes(*, received: bool = True, **changed: tuple[float, float]) -> dict[str, Feedback]:
    """Every axis at a position and with a velocity; what is not named rests at 0."""
    at = SECOND if received else NEVER_RECEIVED
    seen = {}
    for axis in ROBOT.axes:
        position, velocity = changed.get(axis.name, (0.0, 0.0))
        seen[axis.name] = Feedback(axis.name, position=position, velocity=velocity, received_at=at)
    return seen


@pytest.mark.parametrize(("left", "right"), [(3.0, 5.0), (-3.0, 5.0), (4.0, 0.0), (0.0, -4.0)])
def test_speed_and_turn_are_of_both_wheels_each_its_own(left: float, right: float) -> None:
    state = BODY.sensed(axes(left=(0.0, left), right=(0.0, right)), {})
    assert state.speed_mps == pytest.approx((left + right) / 2.0 * BASE.wheel_radius_m)
    assert state.yaw_rate_rad_s == pytest.approx((right - left) * BASE.wheel_radius_m / BASE.rear_track_m)


def test_angle_and_height_are_of_their_axes_and_unknown_until_they_were_received() -> None:
    screw = scissor.screw_from_height(LIFT, 0.1)
    seen = axes(steer=(davis.pinion_from_steer(BASE, 0.3), 9.0), lift=(screw, 7.0))
    state = BODY.sensed(seen, {})
    assert (state.steer_rad, state.lift_m, state.screw_rad_s) == pytest.approx((0.3, 0.1, 7.0))
    state = BODY.sensed(axes(received=False), {})
    assert (state.steer_rad, state.lift_m, state.screw_rad_s) == (None, None, None)


@pytest.mark.parametrize("steer", [-0.3, 0.0, 0.3])
@pytest.mark.parametrize("speed", [-0.2, 0.4])
def test_each_wheel_gets_its_own_speed_by_the_angle_that_is_steered(speed: float, steer: float) -> None:
    state = RarsState(steer, 0.1, 0.0, 0.0, 0.0)
    reported = BODY.set_points(RarsMotion(speed_mps=speed, steer_rad=0.1, lift_m=0.2), state)
    left, right = davis.wheel_speeds(BASE, speed, davis.curvature(BASE, steer))
    outer = max(abs(left), abs(right))
    # Each brakes by itself in proportion to its speed, so that a stop of the drives keeps the ratio.
    assert reported["left"] == Speed(left, abs(left) / outer)
    assert reported["right"] == Speed(right, abs(right) / outer)
    assert (left < right) == (steer * speed > 0.0)
    assert reported["steer"] == Position(davis.pinion_from_steer(BASE, 0.1))
    assert reported["lift"] == Position(scissor.screw_from_height(LIFT, 0.2))
    assert BODY.set_points(RarsMotion(), state).keys() == {"left", "right"}


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("turn", [1.0, -1.0, 0.0])
def test_the_base_moves_where_its_faster_wheel_does(turn: float, way: float) -> None:
    for wheel, moves in ((BASE_MOVES_MPS, True), (0.999 * BASE_MOVES_MPS, False)):
        other = 0.5 * wheel if turn else wheel
        yaw = turn * (wheel - other) / BASE.rear_track_m
        state = RarsState(0.0, 0.1, 0.0, way * (wheel + other) / 2.0, yaw)
        assert bool(BODY.moving(state)) is moves


def test_a_pose_goes_on_as_both_wheels_rolled() -> None:
    before = axes(left=(1.0, 0.0), right=(2.0, 0.0))
    pose = BODY.advanced(Pose(0.0, 0.0, 0.0), before, axes(left=(2.0, 0.0), right=(5.0, 0.0)), {})
    assert pose.heading_rad == pytest.approx(2.0 * BASE.wheel_radius_m / BASE.rear_track_m)


@pytest.mark.parametrize(
    ("before", "allowed", "height", "target"),
    [
        (None, RarsMotion(lift_m=0.3), 0.1, 0.1 + 0.05 * RATE),
        (None, RarsMotion(lift_m=0.0), 0.1, 0.1 - 0.05 * RATE),
        (0.1, RarsMotion(lift_m=0.1), 0.1, 0.1),
        (None, RarsMotion(lift_rate_mps=RATE / 2.0), 0.1, 0.1 + 0.025 * RATE),
        (0.1 + RATE, RarsMotion(lift_m=0.3), 0.1, 0.1 + LEASH_S * RATE),
        (0.1 - RATE, RarsMotion(lift_m=0.0), 0.1, 0.1 - LEASH_S * RATE),
        (0.0, RarsMotion(lift_rate_mps=-RATE), 0.0, 0.0),
        (TOP, RarsMotion(lift_rate_mps=RATE), TOP, TOP),
        (None, RarsMotion(lift_m=0.3), None, None),
        (0.1, RarsMotion(), 0.1, None),
    ],
)
def test_the_lifts_target_travels_at_its_rate_near_the_platform(
    before: float | None, allowed: RarsMotion, height: float | None, target: float | None
) -> None:
    state = RarsState(0.2, height, 0.0, 0.0, 0.0)
    next_ = BODY.ramped(RarsMotion(lift_m=before), allowed, state, SECOND // 20)
    assert next_.lift_m == (None if target is None else pytest.approx(target, abs=1e-12))
    assert next_.lift_rate_mps == 0.0


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_straight_ahead_the_speed_is_on_its_ramp_up_to_its_top(way: float) -> None:
    state, top = RarsState(0.0, 0.1, 0.0, 0.0, 0.0), ROBOT.geometry.limits.speed_mps
    step = ramp_of(ROBOT).step(0.0, way * top, 0.0, SECOND // 20)
    assert BODY.ramped(RarsMotion(), RarsMotion(speed_mps=way * top), state, SECOND // 20).speed_mps == step
    faster = RarsMotion(speed_mps=way * 2.0 * top)
    assert BODY.ramped(RarsMotion(speed_mps=way * top), faster, state, SECOND // 20).speed_mps == way * top
