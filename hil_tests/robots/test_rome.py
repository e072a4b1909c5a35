"""ROME's base in closed form: wheels, stick, control law (2.15) and paths (2.20) to (2.22)."""

import math
from dataclasses import replace
from typing import Any, Final

import pytest

from firmware_bridge.drivers.driver import Feedback, Power, Speed
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robot_types import find, parse, robot_type_of
from firmware_bridge.robots.rome import ROBOT_TYPE
from firmware_bridge.robots.rome.motion import RomeMotion, RomeState
from firmware_bridge.robots.rome.path_follower import named
from firmware_bridge.robots.rome.paths import by_points, ellipse, line
from firmware_bridge.safety.snapshot import Facts, Snapshot
from firmware_bridge.teleop.station import Stick, Velocity
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

ROBOT: Final[Any] = find("rome")
BODY: Final[Any] = ROBOT_TYPE.kinematics(ROBOT)
R: Final = ROBOT.geometry.base.wheel_radius_m
HALF_ROOT: Final = math.sqrt(3.0) / 2.0
REST: Final = RomeState(0.0, 0.0, 0.0)


def seen(pose: Pose, now: Nanoseconds, sampled_at: Nanoseconds) -> Snapshot[RomeMotion, RomeState]:
    """Return the base armed, with a pose and wheels that were sampled then."""
    axes = {
        axis.name: Feedback(axis.name, Power.ON, received_at=now, sampled_at=sampled_at)
        for axis in ROBOT.axes
    }
    facts = Facts(
        now=now,
        armed=True,
        emergency_stopped=False,
        received_at=NEVER_RECEIVED,
        neutral=True,
        axes=axes,
        sensors={},
        links_lost={},
    )
    return Snapshot(facts=facts, command=RomeMotion(), commanded=RomeMotion(), body=REST, pose=pose)


@pytest.mark.parametrize(
    ("motion", "rims"),
    [
        (RomeMotion(ahead_mps=0.2), (0.0, -0.2 * HALF_ROOT, 0.2 * HALF_ROOT)),
        (RomeMotion(left_mps=0.2), (0.2, -0.1, -0.1)),
        (RomeMotion(turn_rad_s=1.0), (0.16, 0.16, 0.16)),
    ],
)
def test_each_wheel_gets_its_own_speed(motion: RomeMotion, rims: tuple[float, ...]) -> None:
    reported = BODY.set_points(motion, REST)
    assert [reported[axis].value for axis in ("one", "two", "three")] == pytest.approx(
        [rim / R for rim in rims], abs=1e-12
    )
    axes = {
        name: Feedback(name, velocity=one.value) for name, one in reported.items() if isinstance(one, Speed)
    }
    state = BODY.sensed(axes, {})
    assert (state.ahead_mps, state.left_mps, state.turn_rad_s) == pytest.approx(
        (motion.ahead_mps, motion.left_mps, motion.turn_rad_s), abs=1e-12
    )


def test_a_stick_and_a_velocity_ask_for_three_ways_to_move() -> None:
    limits = ROBOT.geometry.limits
    station = ROBOT_TYPE.station
    command = station.stick(Stick(0.5, -0.25, 1.0, None), RomeMotion(), ROBOT)
    full = 0.98 * limits.speed_mps
    assert command == RomeMotion(0.5 * full, -0.25 * full, limits.turn_rate_rad_s)
    assert station.target(Velocity(0.1, 0.2, None), RomeMotion(), ROBOT) == RomeMotion(0.1, 0.2, 0.0)


def test_the_control_law_is_2_15_with_the_error_actual_less_desired() -> None:
    """On the path the command is its own speed; off it, less K_p times the error and K_i its integral."""
    path_follower = named(ROBOT, "circle")
    control = ROBOT.geometry.control
    first = path_follower.command(seen(Pose(), SECOND, SECOND), 0)
    assert (first.ahead_mps, first.left_mps) == pytest.approx((0.0, 0.25))
    late = SECOND + 50 * MILLISECOND
    # The pose is that of the samples before: of SECOND, where the path was at its begin.
    command = path_follower.command(seen(Pose(0.01, -0.02, 0.0), late, late), 50 * MILLISECOND)
    swept = 0.25 * 0.05
    kp, ki = control.kp_per_s, control.ki_per_s2
    assert command.ahead_mps == pytest.approx(-0.25 * math.sin(swept) - 0.01 * (kp + ki * 0.05))
    assert command.left_mps == pytest.approx(0.25 * math.cos(swept) + 0.02 * (kp + ki * 0.05))
    assert command.path_s == pytest.approx(0.05)


def test_a_turned_base_gets_the_same_way_in_its_own_frame() -> None:
    path_follower = named(ROBOT, "line")
    path_follower.command(seen(Pose(), SECOND, SECOND), 0)
    turned = path_follower.command(seen(Pose(0.0, 0.0, math.pi / 2.0), SECOND, SECOND), 0)
    assert (turned.ahead_mps, turned.left_mps) == pytest.approx((0.0, -0.5), abs=1e-12)
    assert turned.turn_rad_s == pytest.approx(-ROBOT.geometry.control.kp_per_s * math.pi / 2.0)


def test_a_path_begins_where_the_base_stands_and_as_it_looks() -> None:
    path_follower = named(ROBOT, "line")
    command = path_follower.command(seen(Pose(3.0, -1.0, 1.0), SECOND, SECOND), 0)
    assert (command.ahead_mps, command.left_mps, command.turn_rad_s) == pytest.approx((0.5, 0.0, 0.0))


def test_while_the_base_is_held_back_the_path_waits_and_the_integral_is_forgotten() -> None:
    path_follower = named(ROBOT, "line")
    path_follower.command(seen(Pose(), SECOND, SECOND), 0)
    for _ in range(3):
        held = path_follower.command(seen(Pose(-0.1, 0.0, 0.0), SECOND, SECOND), 50 * MILLISECOND)
        path_follower.reset()
    assert held.path_s == pytest.approx(0.05)
    fresh = named(ROBOT, "line")
    fresh.command(seen(Pose(), SECOND, SECOND), 0)
    first = fresh.command(seen(Pose(-0.1, 0.0, 0.0), SECOND, SECOND), 50 * MILLISECOND)
    assert held.ahead_mps == pytest.approx(first.ahead_mps)


def test_the_integral_stops_where_a_rim_is_at_its_limit() -> None:
    path_follower = named(ROBOT, "line")
    path_follower.command(seen(Pose(), SECOND, SECOND), 0)
    far = seen(Pose(-5.0, 0.0, 0.0), SECOND, SECOND)
    first, *_, last = [path_follower.command(far, 50 * MILLISECOND) for _ in range(20)]
    grown = 2.0 * last.path_s * 0.5 if last.path_s is not None else math.nan
    assert last.ahead_mps - first.ahead_mps < grown


@pytest.mark.parametrize(
    ("path", "place", "rates"),
    [
        (ellipse(1.0, 1.0), lambda t: (math.cos(0.25 * t), math.sin(0.25 * t)), 0.25),
        (ellipse(1.0, 1.5), lambda t: (math.cos(0.25 * t), 1.5 * math.sin(0.25 * t)), None),
        (line(0.5), lambda t: (0.5 * t, 0.0), 0.5),
    ],
)
def test_the_paths_are_the_thesis_own_and_their_rates_are_their_slopes(
    path: Any, place: Any, rates: float | None
) -> None:
    for t in (0.0, 1.3, 7.0, 20.0):
        at, step = path(t), 1e-6
        assert (at.x, at.y, at.heading) == pytest.approx((*place(t), 0.0))
        before, after = place(t - step), place(t + step)
        slopes = [(b - a) / (2.0 * step) for a, b in zip(before, after, strict=True)]
        assert (at.x_rate, at.y_rate) == pytest.approx(slopes, abs=1e-6)
        if rates is not None:
            assert math.hypot(at.x_rate, at.y_rate) == pytest.approx(rates)


def test_a_path_by_points_goes_straight_and_rests_at_its_end() -> None:
    path = by_points(((0.0, 0.0, 0.0, 0.0), (2.0, 1.0, 0.5, 0.2), (3.0, 1.0, 0.0, 0.2)))
    assert path(1.0) == pytest.approx((0.5, 0.25, 0.1, 0.5, 0.25, 0.1))
    assert path(2.5) == pytest.approx((1.0, 0.25, 0.2, 0.0, -0.5, 0.0))
    assert path(9.0) == pytest.approx((1.0, 0.0, 0.2, 0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("old", "new", "stated"),
    [
        (
            "line = 0.5 ",
            "line = 1.0 ",
            "the path line needs 1 m/s, .* leaves 0.568 to set-points; use line = 0.568",
        ),
        ("ellipse = 1.0", "ellipse = 2.0", "the path ellipse needs 0.75 m/s"),
        ("rim_mps = 0.58", "rim_mps = 0.70", "the bound is 11.8 rad/s"),
    ],
)
def test_what_is_too_fast_is_refused_with_the_figure(old: str, new: str, stated: str) -> None:
    text = ROBOT_TYPE.file.read_text(encoding="utf-8")
    assert text.count(old) == 1
    with pytest.raises(RobotFileError, match=stated):
        parse(text.replace(old, new), "rome.toml")


def test_at_its_limits_the_guards_sums_let_it_go() -> None:
    for motion, state in robot_type_of(ROBOT).reach(ROBOT):
        reported = BODY.set_points(replace(motion, path_s=1.0), state)
        for row in ROBOT.guard.sums:
            assert abs(sum(factor * reported[axis].value for axis, factor in row.of.items())) <= row.bound
