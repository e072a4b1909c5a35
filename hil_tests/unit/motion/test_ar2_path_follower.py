"""The arm's path followers with a law of their own: open loop, integral, derivative, and their reset."""

import math
from typing import Any, Final

import numpy as np
import pytest
from pydantic import ValidationError

from firmware_bridge.motion.pose import Pose
from firmware_bridge.motion.resolved_rate import PoseControl, PoseGains, pose_law
from firmware_bridge.robot import Robot
from firmware_bridge.robot_types import find
from firmware_bridge.robots.ar2 import ROBOT_TYPE
from firmware_bridge.robots.ar2.arm import AR2
from firmware_bridge.robots.ar2.geometry import Ar2Control, Ar2Gains, Ar2Geometry
from firmware_bridge.robots.ar2.motion import STILL, Ar2Motion, Ar2State, motion_of
from firmware_bridge.robots.ar2.path_follower import COURSES, LAWS, Ar2PathFollower, ramp
from firmware_bridge.safety.snapshot import Facts, Snapshot

ROBOT: Final[Robot[Ar2Geometry]] = find("ar2")
BENT: Final = tuple(map(math.radians, (0.0, -90.0, 90.0, 0.0, 60.0, 0.0)))
CYCLE_S: Final = 0.1
OFF: Final = np.array((0.006, -0.004, 0.005))


def seen(commanded: Ar2Motion) -> Snapshot[Ar2Motion, Ar2State]:
    """Return what is known of an arm that stays where it is."""
    facts = Facts(0, True, False, 0, True, {}, {}, {})  # noqa: FBT003 - in the order of its fields
    return Snapshot(
        facts=facts, command=commanded, commanded=commanded, body=Ar2State(BENT, STILL), pose=Pose()
    )


def with_gains(**gains: Any) -> Robot[Ar2Geometry]:
    """Return the robot with other gains."""
    table = Ar2Control(**{"kp_per_s": 0.0, "ko_per_s": 0.0, **gains})
    geometry = ROBOT.geometry.model_copy(update={"control": table})
    return ROBOT.model_copy(update={"geometry": geometry})


def upwards(path_follower: Any, cycles: int, *, follows: bool = True) -> list[float]:
    """Return the commanded speeds upwards, m/s, of an arm that stays, and was limited or not."""
    speeds, commanded = [], Ar2Motion()
    for _ in range(cycles):
        command = path_follower.command(seen(commanded), ROBOT.cycle)
        speeds.append(command.up_mps)
        commanded = motion_of(command.twist) if follows else Ar2Motion()
    return speeds


def test_a_law_without_integral_and_derivative_is_the_pose_law_to_the_last_bit() -> None:
    actual, rng, control = AR2.pose(BENT), np.random.default_rng(3), PoseControl(PoseGains(3.0, 1.5))
    for _ in range(50):
        desired, feed = AR2.pose(np.array(BENT) + rng.uniform(-0.2, 0.2, 6)), rng.normal(size=6)
        expected = pose_law(desired, actual, feed, (3.0, 1.5))
        assert control.twist(desired, actual, feed, CYCLE_S).tobytes() == expected.tobytes()


def test_the_law_adds_the_integral_and_the_difference_of_the_error() -> None:
    control = PoseControl(PoseGains(2.0, 0.0, 0.5, 0.25))
    actual, desired, further = AR2.pose(BENT), AR2.pose(BENT), AR2.pose(BENT)
    desired[:3, 3] += OFF
    further[:3, 3] += 2.0 * OFF
    first = control.twist(desired, actual, np.zeros(6), CYCLE_S)
    assert first[:3] == pytest.approx(2.0 * OFF + 0.5 * 0.1 * OFF)
    second = control.twist(further, actual, np.zeros(6), CYCLE_S)
    assert second[:3] == pytest.approx(4.0 * OFF + 0.5 * 0.3 * OFF + 0.25 * OFF / 0.1)
    assert second[3:] == pytest.approx(np.zeros(3))


def test_a_limited_tool_adds_nothing_to_the_integral_and_a_reset_forgets_it() -> None:
    control = PoseControl(PoseGains(0.0, 0.0, 1.0, 0.5))
    actual, desired = AR2.pose(BENT), AR2.pose(BENT)
    desired[:3, 3] += OFF
    feed = np.zeros(6)
    assert control.twist(desired, actual, feed, CYCLE_S)[:3] == pytest.approx(0.1 * OFF)
    assert control.twist(desired, actual, feed, CYCLE_S, limited=True)[:3] == pytest.approx(0.1 * OFF)
    assert control.twist(desired, actual, feed, CYCLE_S)[:3] == pytest.approx(0.2 * OFF)
    control.reset()
    desired[:3, 3] += OFF
    assert control.twist(desired, actual, feed, CYCLE_S)[:3] == pytest.approx(0.2 * OFF)


def test_in_no_time_there_is_no_derivative() -> None:
    control = PoseControl(PoseGains(0.0, 0.0, 0.0, 0.5))
    actual, desired = AR2.pose(BENT), AR2.pose(BENT)
    control.twist(desired, actual, np.zeros(6), 0.0)
    desired[:3, 3] += OFF
    assert control.twist(desired, actual, np.zeros(6), 0.0) == pytest.approx(np.zeros(6))


def test_in_open_loop_an_error_changes_nothing() -> None:
    """(3.24), Fig. 3.9: 80 mm in 60 s."""
    speeds = upwards(ROBOT_TYPE.path_followers["ramp_open"](ROBOT), 50)
    assert speeds == [pytest.approx(0.08 / 60.0)] * 50
    assert upwards(ROBOT_TYPE.path_followers["ramp"](ROBOT), 50)[-1] > 2.0 * speeds[-1]


def test_an_arm_that_stays_is_commanded_more_by_an_integral_unless_it_is_limited() -> None:
    rate, robot = 0.08 / 60.0, with_gains(ki_per_s2=1.0)
    errors = rate * CYCLE_S * np.arange(20)
    summed = rate + CYCLE_S * np.cumsum(errors)
    assert upwards(Ar2PathFollower(robot, ramp), 20) == pytest.approx(list(summed))
    limited = upwards(Ar2PathFollower(robot, ramp), 20, follows=False)
    assert limited == pytest.approx([rate] * 20)


def test_an_arm_that_was_held_back_begins_with_an_integral_of_0() -> None:
    rate, path_follower = 0.08 / 60.0, Ar2PathFollower(with_gains(ki_per_s2=1.0), ramp)
    late = upwards(path_follower, 20)[-1]
    error = 19 * rate * CYCLE_S
    path_follower.reset()
    (waited,) = upwards(path_follower, 1)
    assert waited == pytest.approx(rate + CYCLE_S * error)
    assert waited < late


def test_the_derivative_takes_a_share_of_an_error_that_grows() -> None:
    rate = 0.08 / 60.0
    first, *others = upwards(Ar2PathFollower(with_gains(kd=0.2), ramp), 5)
    assert first == pytest.approx(rate)
    assert others == pytest.approx([1.2 * rate] * 4)


def test_the_height_of_the_orbit_begins_at_0_and_comes_back_after_a_turn_by_the_assumed_scale() -> None:
    """(4.10), Fig. 3.11; 60.84 s from its rounded numbers."""
    courses, course = ROBOT.geometry.courses, LAWS["orbit_z"]
    assert course(courses, 0.0).by == (0.0, 0.0, 0.0)
    assert course(courses, 0.0).speed == pytest.approx((0.0, 0.0, 0.9 * 0.0110))
    assert course(courses, 60.8352).by[2] == pytest.approx(0.0, abs=1e-6)
    heights = [course(courses, 0.5 * it).by[2] for it in range(122)]
    assert (min(heights), max(heights)) == pytest.approx((-0.1011, 0.01377), abs=1e-4)
    speeds = [abs(course(courses, 0.1 * it).speed[2]) for it in range(610)]
    assert max(speeds) < ROBOT.geometry.limits.speed_mps


def test_path_followers_with_a_law_come_behind_those_without_so_that_numbers_stay() -> None:
    assert tuple(ROBOT_TYPE.path_followers) == (*COURSES, *LAWS)
    assert set(LAWS) == set(Ar2Control.model_fields) - set(Ar2Gains.model_fields)


@pytest.mark.parametrize(
    ("key", "value"), [("ki_per_s2", -0.1), ("kd", -0.1), ("kd", 1.0), ("ki_per_s2", math.inf)]
)
def test_a_gain_that_cannot_be_is_refused(key: str, value: float) -> None:
    with pytest.raises(ValidationError, match=key):
        Ar2Gains.model_validate({"kp_per_s": 1.0, "ko_per_s": 1.0, key: value})


def test_gains_without_integral_and_derivative_are_those_of_files_before() -> None:
    gains = Ar2Control(kp_per_s=3.0, ko_per_s=1.5)
    assert (gains.ki_per_s2, gains.kd) == (0.0, 0.0)
    assert ROBOT.geometry.control == gains
