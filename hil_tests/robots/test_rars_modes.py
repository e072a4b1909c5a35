"""RARS's kinematic model in each mode after a failed actuator: set-points, state, pose and limits."""

import math
from types import SimpleNamespace
from typing import Any, Final, cast

import pytest

from firmware_bridge.drivers.driver import Feedback
from firmware_bridge.intent import USUAL_AGE_LIMIT
from firmware_bridge.motion import davis
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.robots.rars.modes import STAYS_WITHIN_RAD
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.safety.interlock import View
from firmware_bridge.teleop import modes
from firmware_bridge.units import SECOND
from hil_tests.robots.test_rars_body import axes
from hil_tests.rows import every

ROBOT: Final[Any] = find("rars")
BASE: Final[davis.DavisBase] = ROBOT.geometry.base
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
    assert body(mode).set_points(ALL, state) == {
        axis: reported for axis, reported in whole.items() if axis != name
    }


@pytest.mark.parametrize("steer", [-0.4, 0.0, 0.4])
@pytest.mark.parametrize(("mode", "name"), [("left_failed", "right"), ("right_failed", "left")])
def test_one_wheel_reports_how_the_robot_moves_in_the_turn_that_is_steered(
    mode: str, name: str, steer: float
) -> None:
    whole = dict(zip(("left", "right"), davis.wheel_speeds(BASE, 0.15, steer), strict=True))
    state = body(mode).sensed(turned(steer, **{name: (0.0, whole[name])}), {})
    assert state.speed_mps == pytest.approx(0.15)
    assert state.yaw_rate_rad_s == pytest.approx(0.15 * davis.curvature(BASE, steer))
    assert body(mode).set_points(RarsMotion(speed_mps=0.15), state)[name].value == pytest.approx(whole[name])


@pytest.mark.parametrize("steer", [-0.4, 0.0, 0.4])
@pytest.mark.parametrize(("mode", "name"), [("left_failed", "right"), ("right_failed", "left")])
def test_one_wheel_carries_the_pose_along_the_turn_whatever_is_counted_of_the_other(
    mode: str, name: str, steer: float
) -> None:
    rolled = dict(zip(("left", "right"), davis.wheel_speeds(BASE, 1.0, steer), strict=True))
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
        ("steering_failed", RarsMotion(0.1, 0.1), RarsMotion(0.1), []),
        ("steering_failed", RarsMotion(0.1, 0.1 + 0.9 * DEGREE), RarsMotion(0.1), []),
        ("steering_failed", RarsMotion(0.1, 0.1 - 1.1 * DEGREE), RarsMotion(0.1), ["steering out of use"]),
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


@every(
    ("command", "reported"),
    [
        (RarsMotion(steer_rad=0.2 + 1.005 * DEGREE), "the steering stays at 11 deg"),
        (RarsMotion(steer_rad=0.2 - 1.005 * DEGREE), "the steering stays at 11 deg"),
        (RarsMotion(steer_rad=0.2 + 0.995 * DEGREE), None),
        (RarsMotion(steer_rad=0.2 - 0.995 * DEGREE), None),
    ],
)
def test_who_wants_to_steer_a_degree_beside_the_angle_is_reported_the_angle(
    command: RarsMotion, reported: str | None
) -> None:
    seen: Any = SimpleNamespace(body=RarsState(0.2, 0.0, 0.0, 0.0, 0.0))
    view: Any = View(ROBOT, seen, command, frozenset(), None)
    limits = {row.name: row for row in ROBOT_TYPE.rules(ROBOT)["steering_failed"].limits}
    assert limits["steering out of use"].clip(view) == (RarsMotion(), reported)


@every(("mode", "name"), [("left_failed", "right"), ("right_failed", "left")])
def test_one_wheel_carries_the_pose_by_what_it_rolled_since_the_last_sample(mode: str, name: str) -> None:
    before = turned(0.0, **{name: (5.0, 0.0)})
    after = turned(0.0, **{name: (5.5, 0.0)})
    pose = body(mode).advanced(Pose(), before, after, {})
    assert (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx((0.5 * R, 0.0, 0.0))


def test_an_angle_just_as_far_as_may_be_is_not_reported() -> None:
    still = RarsState(0.0, 0.0, 0.0, 0.0, 0.0)
    row = ROBOT_TYPE.modes["steering_failed"].limits[0]
    for beside, reported in ((STAYS_WITHIN_RAD, False), (math.nextafter(STAYS_WITHIN_RAD, 1.0), True)):
        seen: Any = SimpleNamespace(body=still)
        _, reason = row.clip(View(ROBOT, seen, RarsMotion(0.1, beside), frozenset(), None))
        assert (reason is not None) is reported
