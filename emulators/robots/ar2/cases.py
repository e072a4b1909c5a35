"""The arm's interlocks at the edges of their thresholds; for the inherited tests."""

import math
from collections.abc import Iterator
from typing import Final, TypeAlias

from emulators.bench import cases as bench
from firmware_bridge.robot import Axis, Robot
from firmware_bridge.robots.ar2.geometry import Ar2Geometry
from firmware_bridge.robots.ar2.kinematics import Ar2Kinematics
from firmware_bridge.robots.ar2.motion import STILL, Ar2Motion, Ar2State, motion_of
from firmware_bridge.robots.ar2.rules import HORIZON, OUTSIDE_M, tool

Case: TypeAlias = bench.Case[Ar2Motion, Ar2State]
Situation: TypeAlias = bench.Situation[Ar2Motion, Ar2State]
JUST: Final = 1.0 + 1e-5
"""A limit reports what is beyond it by more than a millionth."""
STRAIGHT: Final = Ar2State(tuple(map(math.radians, (0.0, -90.0, 90.0, 0.0, 0.0, 0.0))), STILL)
"""Its wrist is: the fourth and sixth joint turn about one axis."""
BENT: Final = Ar2State(tuple(map(math.radians, (0.0, -90.0, 90.0, 0.0, 60.0, 0.0))), STILL)
"""Posture of the arm as it begins on the bench: far from singular ones."""


def cases(robot: Robot[Ar2Geometry]) -> Iterator[Case]:
    """Yield at least one case for each interlock and limit."""
    limits = robot.geometry.limits
    yield _outside(robot)
    yield _beyond(
        "tool speed limit",
        0,
        limits.speed_mps,
        f"requested {JUST * limits.speed_mps:.3f} m/s, allowed is {limits.speed_mps:.3f} m/s",
    )
    turn = limits.turn_rate_rad_s
    yield _beyond(
        "tool turn limit", 4, turn, f"requested {JUST * turn:.2f} rad/s, allowed is {turn:.2f} rad/s"
    )
    yield _at_the_end(robot)
    yield _too_fast_for_joints(robot)
    yield Case(
        "joint limit",
        trips=_moving(upwards(0.01), STRAIGHT),
        spares=_moving(upwards(0.01), BENT),
        reason="near a singular posture, at 0.000: the tool leaves its path",
    )
    step = limits.acceleration_mps2 * robot.cycle_ms / 1000.0
    yield Case(
        "acceleration limit",
        trips=Situation(command=upwards(1.2 * step), body=BENT),
        spares=Situation(command=upwards(step), body=BENT),
        reason=f"requested a change of {1200.0 * step:.0f} mm/s at once",
    )


def upwards(speed: float) -> Ar2Motion:
    """Return the motion with which the tool rises, m/s."""
    return Ar2Motion(up_mps=speed)


def _moving(motion: Ar2Motion, body: Ar2State) -> Situation:
    """Return the situation of an arm that moves so already."""
    return Situation(command=motion, commanded=motion, body=body)


def _beyond(interlock: str, axis: int, high: float, reason: str) -> Case:
    """Return the case of one of the tool's six speeds."""
    within, beyond = ([0.0] * 6, [0.0] * 6)
    within[axis], beyond[axis] = high, JUST * high
    commanded = motion_of(within)
    return Case(
        interlock,
        trips=Situation(command=motion_of(beyond), commanded=commanded, body=BENT),
        spares=Situation(command=commanded, commanded=commanded, body=BENT),
        reason=reason,
    )


def _with_box(
    robot: Robot[Ar2Geometry], *, behind: float | None = None, high: float | None = None
) -> Robot[Ar2Geometry]:
    """Return the robot with another side behind, or another ceiling, of its workspace."""
    space = robot.geometry.workspace
    corners = {
        "lowest_m": space.lowest_m if behind is None else (behind, *space.lowest_m[1:]),
        "highest_m": space.highest_m if high is None else (*space.highest_m[:2], high),
    }
    geometry = robot.geometry.model_copy(update={"workspace": space.model_copy(update=corners)})
    return robot.model_copy(update={"geometry": geometry})


def _outside(robot: Robot[Ar2Geometry]) -> Case:
    j1, j2, *others = BENT.angles
    back = Ar2State((j1, j2 - 1e-5, *others), STILL)
    behind = tool(back)[0] + OUTSIDE_M + 1e-7
    return Case(
        "tool outside",
        trips=Situation(body=back),
        spares=Situation(body=BENT),
        reason=f"the tool is {1000.0 * OUTSIDE_M:.0f} mm beyond x {behind:g} m of its workspace",
        robot=_with_box(robot, behind=behind),
    )


def _at_the_end(robot: Robot[Ar2Geometry]) -> Case:
    speed = robot.geometry.limits.speed_mps / 2.0
    ceiling = tool(BENT)[2] + speed * HORIZON * robot.cycle_ms / 1000.0
    return Case(
        "workspace",
        trips=_moving(upwards(JUST * speed), BENT),
        spares=_moving(upwards(speed / JUST), BENT),
        reason=f"the tool is at the end of its workspace: z {ceiling:g} m",
        robot=_with_box(robot, high=ceiling),
    )


def _too_fast_for_joints(robot: Robot[Ar2Geometry]) -> Case:
    slow = robot.model_copy(update={"axes": tuple(_slower(axis) for axis in robot.axes)})
    speed = robot.geometry.limits.speed_mps / 2.0
    _, share = Ar2Kinematics(slow).rates(BENT.angles, upwards(speed).twist)
    return Case(
        "joint limit",
        trips=_moving(upwards(JUST * share * speed), BENT),
        spares=_moving(upwards(share * speed / JUST), BENT),
        reason="the joints follow at 100 % of that",
        robot=slow,
    )


def _slower(axis: Axis) -> Axis:
    return axis.model_copy(update={"top_speed": axis.top_speed / 10.0})
