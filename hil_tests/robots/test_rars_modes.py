"""RARS's kinematic model in each mode after a failed actuator: set-points, state, pose and limits."""

import math
from types import SimpleNamespace
from typing import Any, Final, cast

import pytest

from firmware_bridge.drivers.driver import Feedback, Speed
from firmware_bridge.intent import USUAL_AGE_LIMIT
from firmware_bridge.mavlink import modes
from firmware_bridge.motion import davis
from firmware_bridge.motion.pose import Pose
from firmware_bridge.motion.tables import DavisBase
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.robots.rars.modes import STEERS_PER_M_S
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.safety.interlock import View
from firmware_bridge.units import SECOND
from hil_tests.robots.test_rars_body import axes
from hil_tests.rows import every

ROBOT: Final[Any] = find("rars")
BASE: Final[DavisBase] = ROBOT.geometry.base
R: Final = BASE.wheel_radius_m
WHOLE: Final[Any] = ROBOT_TYPE.kinematics(ROBOT)
ALL: Final = RarsMotion(speed_mps=0.1, steer_rad=0.2, lift_m=0.01)
LEFT_OUT: Final = {
    "steering_failed": "steer",
    "left_failed": "left",
    "right_failed": "right",
    "lift_failed": "lift",
}


def turned(steer: float, **wheels: tuple[float, float]) -> dict[str, Feedback]:
    """Every axis, with the steering at an angle."""
    seen: Any = axes
    return cast("dict[str, Feedback]", seen(steer=(at(steer), 0.0), **wheels))


def body(mode: str) -> Any:
    return ROBOT_TYPE.modes[mode].kinematics(ROBOT)


def at(steer: float) -> float:
    return davis.pinion_from_steer(BASE, steer)


@pytest.mark.parametrize(("mode", "name"), LEFT_OUT.items())
def test_what_a_mode_does_without_is_reported_nothing_and_the_rest_is_as_ever(mode: str, name: str) -> None:
    assert ROBOT_TYPE.rules(ROBOT)[mode].without == {name}
    state = RarsState(0.2, 0.0, 0.0, 0.1, 0.0)
    whole = WHOLE.set_points(ALL, state)
    left = {axis: reported for axis, reported in whole.items() if axis != name}
    if name in ("left", "right"):
        # A wheel that drives alone keeps no ratio: it brakes as hard as it may.
        left = {axis: Speed(it.value) if isinstance(it, Speed) else it for axis, it in left.items()}
    assert body(mode).set_points(ALL, state) == left


@pytest.mark.parametrize("steer", [-0.4, 0.0, 0.4])
@pytest.mark.parametrize(("mode", "name"), [("left_failed", "right"), ("right_failed", "left")])
def test_one_wheel_reports_how_the_robot_moves_in_the_turn_that_is_steered(
    mode: str, name: str, steer: float
) -> None:
    whole = dict(
        zip(("left", "right"), davis.wheel_speeds(BASE, 0.15, davis.curvature(BASE, steer)), strict=True)
    )
    state = body(mode).sensed(turned(steer, **{name: (0.0, whole[name])}), {})
    assert state.speed_mps == pytest.approx(0.15)
    assert state.yaw_rate_rad_s == pytest.approx(0.15 * davis.curvature(BASE, steer))
    assert body(mode).set_points(RarsMotion(speed_mps=0.15), state)[name].value == pytest.approx(whole[name])


@pytest.mark.parametrize("steer", [-0.4, 0.0, 0.4])
@pytest.mark.parametrize(("mode", "name"), [("left_failed", "right"), ("right_failed", "left")])
def test_one_wheel_carries_the_pose_along_the_turn_whatever_is_counted_of_the_other(
    mode: str, name: str, steer: float
) -> None:
    rolled = dict(
        zip(("left", "right"), davis.wheel_speeds(BASE, 1.0, davis.curvature(BASE, steer)), strict=True)
    )
    before = axes(steer=(at(steer), 0.0))
    after = turned(steer, **{name: (rolled[name], 0.0)})
    whole = WHOLE.advanced(
        Pose(), before, turned(0.0, **{each: (way, 0.0) for each, way in rolled.items()}), {}
    )
    pose = body(mode).advanced(Pose(), before, after, {})
    assert (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx((whole.x_m, whole.y_m, whole.heading_rad))
    assert body(mode).rolling == (name,)


def without_zero(name: str, seen: dict[str, Feedback]) -> dict[str, Feedback]:
    one = seen[name]
    seen[name] = Feedback(one.axis, position=one.position, received_at=one.received_at, reference_lost=True)
    return seen


def test_an_angle_or_a_height_is_unknown_where_the_dead_drive_has_lost_its_zero() -> None:
    seen = axes(steer=(at(0.3), 0.0), lift=(1.0, 0.0))
    assert body("steering_failed").sensed(seen, {}).steer_rad == pytest.approx(0.3)
    assert body("lift_failed").sensed(seen, {}).lift_m > 0.0
    assert body("steering_failed").sensed(without_zero("steer", dict(seen)), {}).steer_rad is None
    assert body("lift_failed").sensed(without_zero("lift", dict(seen)), {}).lift_m is None


def clipped(mode: str, command: RarsMotion) -> tuple[RarsMotion, list[str]]:
    """Return the command behind the mode's limits, and the names of those that reported something."""
    facts = SimpleNamespace(age_limit=USUAL_AGE_LIMIT)
    seen: Any = SimpleNamespace(
        body=RarsState(0.1, 0.0, 0.0, 0.0, 0.0), commanded=RarsMotion(), facts=facts, command=command
    )
    view: Any = View(ROBOT, seen, command, frozenset(), None)
    reported = []
    for row in ROBOT_TYPE.rules(ROBOT)[mode].limits:
        allowed, reason = row.clip(view)
        reported += [row.name] if reason is not None and row.name != "acceleration limit" else []
        view = View(ROBOT, seen, allowed, frozenset(), None)
    return view.allowed, reported


DEGREE: Final = math.radians(1.0)


@pytest.mark.parametrize(
    ("mode", "command", "allowed", "reported"),
    [
        ("left_failed", RarsMotion(0.2), RarsMotion(0.2), []),
        ("left_failed", RarsMotion(0.21), RarsMotion(0.2), ["speed limit"]),
        ("right_failed", RarsMotion(-0.21), RarsMotion(-0.2), ["speed limit"]),
        ("left_failed", RarsMotion(0.1, 30 * DEGREE), RarsMotion(0.1, 30 * DEGREE), []),
        (
            "left_failed",
            RarsMotion(0.1, 31 * DEGREE),
            RarsMotion(0.1, 30 * DEGREE),
            ["steer angle after a failure"],
        ),
        (
            "right_failed",
            RarsMotion(0.1, -31 * DEGREE),
            RarsMotion(0.1, -30 * DEGREE),
            ["steer angle after a failure"],
        ),
        ("steering_failed", RarsMotion(0.1, 0.1), RarsMotion(0.1, 0.1), []),
        ("steering_failed", RarsMotion(0.3), RarsMotion(0.2), ["speed limit"]),
        ("lift_failed", RarsMotion(0.1), RarsMotion(0.1), []),
        ("lift_failed", RarsMotion(0.1, 0.1, 0.3), RarsMotion(0.1, 0.1), ["lift out of use"]),
        ("lift_failed", RarsMotion(lift_rate_mps=-0.01), RarsMotion(), ["lift out of use"]),
    ],
)
def test_limits_after_a_failure(
    mode: str, command: RarsMotion, allowed: RarsMotion, reported: list[str]
) -> None:
    assert clipped(mode, command) == (allowed, reported)


@pytest.mark.parametrize("mode", LEFT_OUT)
def test_the_ramp_after_a_failure_is_the_narrow_one(mode: str) -> None:
    state = RarsState(0.0, 0.0, 0.0, 0.0, 0.0)
    step = body(mode).ramped(RarsMotion(), RarsMotion(0.2), state, ROBOT.cycle).speed_mps
    narrow = ROBOT.geometry.narrowed.acceleration_mps2 * ROBOT.cycle / SECOND
    assert 0.79 * narrow < step <= narrow


def test_narrowed_limits_widen_nothing() -> None:
    slow = ROBOT.geometry.limits.model_copy(update={"speed_mps": 0.1, "acceleration_g": 0.01})
    narrowed = ROBOT.geometry.model_copy(update={"limits": slow}).narrowed
    assert (narrowed.speed_mps, narrowed.acceleration_g) == (0.1, 0.01)


def test_the_modes_numbers_are_none_of_those_that_mean_something_else() -> None:
    numbers = [modes.number_of_own(place) for place in range(len(ROBOT_TYPE.modes) + 1)]
    assert numbers == [0, 20, 21, 22, 23]
    for place, number in enumerate(numbers):
        assert modes.requested(number, 0, len(numbers)) == modes.ModeRequest(
            modes.DrivingMode.MANUAL, place, px4=False
        )
        whole = modes.in_px4(number)
        assert modes.requested(whole, 0, len(numbers)) == modes.ModeRequest(
            modes.DrivingMode.MANUAL, place, px4=True
        )
    event = modes.requested(4, 0, len(numbers))
    assert event is not None
    assert event.driving_mode is modes.DrivingMode.HOLD


@every(("mode", "name"), [("left_failed", "right"), ("right_failed", "left")])
def test_one_wheel_carries_the_pose_by_what_it_rolled_since_the_last_sample(mode: str, name: str) -> None:
    before = turned(0.0, **{name: (5.0, 0.0)})
    after = turned(0.0, **{name: (5.5, 0.0)})
    pose = body(mode).advanced(Pose(), before, after, {})
    assert (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx((0.5 * R, 0.0, 0.0))


MOST: Final = ROBOT.geometry.degraded.wheel_curvature_per_m


@every(("beside", "reported"), [(0.999, False), (1.001, True), (-0.999, False), (-1.001, True)])
def test_the_wheels_steer_within_the_files_range_about_the_stuck_rack(
    beside: float, *, reported: bool
) -> None:
    rack = davis.curvature(BASE, 0.2)
    wanted = RarsMotion(0.1, davis.steer_from_curvature(BASE, rack + beside * MOST))
    seen: Any = SimpleNamespace(body=RarsState(0.2, 0.0, 0.0, 0.0, 0.0))
    row = ROBOT_TYPE.modes["steering_failed"].limits[0]
    allowed, reason = row.clip(View(ROBOT, seen, wanted, frozenset(), None))
    assert (reason is not None) is reported
    assert abs(davis.curvature(BASE, allowed.steer_rad or 0.0) - rack) <= MOST * (1.0 + 1e-9)
    assert reason is None or "with the rack at 11 deg the wheels steer from 0.10 to 0.66 1/m" in reason


@every("rack_deg", [-10.0, 0.0, 10.0])
@every("goal_per_m", [-0.2, 0.0, 0.25])
def test_wheels_that_steer_a_stuck_rack_are_commanded_more_by_the_share(
    rack_deg: float, goal_per_m: float
) -> None:
    """The robot turns by the rack's curvature and a share of the difference (thesis 2.2)."""
    share, failed = ROBOT.geometry.degraded.wheel_steering, body("steering_failed")
    rack = davis.curvature(BASE, math.radians(rack_deg))
    state = RarsState(math.radians(rack_deg), 0.0, 0.0, 0.1, 0.0)
    goal = RarsMotion(0.1, davis.steer_from_curvature(BASE, goal_per_m))
    left, right = (failed.set_points(goal, state)[name].value * R for name in ("left", "right"))
    stated = (right - left) / BASE.rear_track_m / 0.1
    assert rack + share * (stated - rack) == pytest.approx(goal_per_m)
    # The yaw rate and the pose follow from the same share.
    wheels = {"left": (left, left / R), "right": (right, right / R)}
    seen = failed.sensed(turned(math.radians(rack_deg), **wheels), {})
    assert seen.yaw_rate_rad_s == pytest.approx(0.1 * goal_per_m)
    before = turned(math.radians(rack_deg), left=(0.0, 0.0), right=(0.0, 0.0))
    after = turned(math.radians(rack_deg), left=(left / R, 0.0), right=(right / R, 0.0))
    assert failed.advanced(Pose(), before, after, {}).heading_rad == pytest.approx(0.1 * goal_per_m)


def test_the_wheels_come_to_a_curvature_at_a_rate() -> None:
    failed, state = body("steering_failed"), RarsState(0.0, 0.0, 0.0, 0.1, 0.0)
    goal = RarsMotion(0.1, davis.steer_from_curvature(BASE, 0.2))
    next_one = failed.ramped(RarsMotion(0.1), goal, state, ROBOT.cycle)
    assert davis.curvature(BASE, next_one.steer_rad) == pytest.approx(STEERS_PER_M_S * ROBOT.cycle / SECOND)
