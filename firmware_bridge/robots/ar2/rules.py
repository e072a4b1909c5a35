"""The arm's own interlock and limits, beside the common ones of `firmware_bridge.safety.common`.

They look at the tool where the joints are counted to be. A motion that takes it out of its workspace loses
the part that does; what is left goes along the edge.
"""

import math
from collections.abc import Callable, Iterator
from typing import Final, NamedTuple, TypeAlias

import numpy as np

from firmware_bridge.robot import Robot
from firmware_bridge.robots.ar2.arm import AR2
from firmware_bridge.robots.ar2.geometry import Ar2Geometry
from firmware_bridge.robots.ar2.kinematics import Ar2Kinematics, changed
from firmware_bridge.robots.ar2.motion import STILL, Ar2Motion, Ar2State, motion_of
from firmware_bridge.safety import interlock
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.limits import ROUNDING
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

View: TypeAlias = interlock.View[Ar2Geometry, Ar2Motion, Ar2State]
Interlock: TypeAlias = interlock.Interlock[Ar2Geometry, Ar2Motion, Ar2State]
Limit: TypeAlias = interlock.Limit[Ar2Geometry, Ar2Motion, Ar2State]

CLEARS_AFTER: Final[Nanoseconds] = 300 * MILLISECOND
HORIZON: Final = 2.0
"""Cycles that are looked ahead: the one that is being driven, and the next."""
OUTSIDE_M: Final = 0.01
"""Distance outside of its workspace at which the tool is where no command put it."""
TOLERANCE: Final = 1e-4
"""A step that the ramp shortens by less, in m/s or rad/s, is not reported."""


class Side(NamedTuple):
    """One side of the workspace: how far the tool is inside of it, m, and which way out is."""

    name: str
    room: float
    outwards: tuple[float, float, float]


def sides(robot: Robot[Ar2Geometry], place: tuple[float, float, float]) -> Iterator[Side]:
    """Yield the sides of the box, and of the arm's own base, for a place of the tool."""
    space = robot.geometry.workspace
    for axis, letter in enumerate("xyz"):
        for end, sign in ((space.lowest_m[axis], -1.0), (space.highest_m[axis], 1.0)):
            outwards = [0.0, 0.0, 0.0]
            outwards[axis] = sign
            yield Side(
                f"{letter} {end:g} m", sign * (end - place[axis]), (outwards[0], outwards[1], outwards[2])
            )
    away, over = math.hypot(place[0], place[1]), place[2] - space.base_height_m
    if over < 0.0 and away - space.base_radius_m < -over:
        x, y = (place[0] / away, place[1] / away) if away > 0.0 else (1.0, 0.0)
        yield Side("its own base", away - space.base_radius_m, (-x, -y, 0.0))
    elif away < space.base_radius_m:
        yield Side("its own base", over, (0.0, 0.0, -1.0))


def tool(state: Ar2State) -> tuple[float, float, float]:
    """Return where the tool is, as the joints are counted, m."""
    x, y, z = AR2.pose(state.angles)[:3, 3]
    return float(x), float(y), float(z)


def _outside(view: View) -> str | None:
    # Of an arm whose zero is lost no one knows where the tool is: one cause, one hold.
    if any(axis.reference_lost for axis in view.facts.axes.values()):
        return None
    for side in sides(view.robot, tool(view.body)):
        # Written so that a NaN trips.
        if not side.room >= -OUTSIDE_M:
            return f"the tool is {-1000.0 * side.room:.0f} mm beyond {side.name} of its workspace"
    return None


INTERLOCKS: Final = (
    Interlock(
        "tool outside",
        _outside,
        "look where the joints stand, and confirm it; or take it back by hand without power",
        clear_after=CLEARS_AFTER,
        severity=Severity.CRITICAL,
        disarms=True,
    ),
)


def _with(motion: Ar2Motion, speed: tuple[float, ...], turn: tuple[float, ...]) -> Ar2Motion:
    return motion_of((*speed, *turn), motion.angles, motion.path_s)


def _bounded(vector: tuple[float, ...], high: float) -> tuple[tuple[float, ...], float]:
    length = math.hypot(*vector)
    return (vector if length <= high else tuple(high / length * it for it in vector)), length


def slowed(view: View, share: float) -> tuple[Ar2Motion, str | None]:
    """Clip the tool's speed to a share of its top."""
    motion, high = view.allowed, share * view.geometry.limits.speed_mps
    speed, length = _bounded(motion.speed, high)
    if length <= high * (1.0 + ROUNDING):
        return _with(motion, speed, motion.turn), None
    return _with(motion, speed, motion.turn), f"requested {length:.3f} m/s, allowed is {high:.3f} m/s"


def _turn(view: View) -> tuple[Ar2Motion, str | None]:
    motion, high = view.allowed, view.geometry.limits.turn_rate_rad_s
    turn, length = _bounded(motion.turn, high)
    if length <= high * (1.0 + ROUNDING):
        return _with(motion, motion.speed, turn), None
    return _with(motion, motion.speed, turn), f"requested {length:.2f} rad/s, allowed is {high:.2f} rad/s"


def _workspace(view: View) -> tuple[Ar2Motion, str | None]:
    """Take away what would lead out of the workspace, one side after the other."""
    motion = view.allowed
    if motion.twist == STILL:
        return motion, None
    ahead_s = HORIZON * to_seconds(view.robot.cycle)
    speed, met = np.array(motion.speed), []
    for side in sides(view.robot, tool(view.body)):
        outwards = np.array(side.outwards)
        out = float(speed @ outwards)
        # Only the part across the side is taken away, so that the tool can go along it and back.
        if out > 0.0 and side.room < out * ahead_s:
            speed = speed - out * outwards
            met.append(side.name)
    if not met:
        return motion, None
    allowed = _with(motion, tuple(map(float, speed)), motion.turn)
    return allowed, f"the tool is at the end of its workspace: {', '.join(met)}"


def _joints(view: View) -> tuple[Ar2Motion, str | None]:
    """Take the share at which no joint is too fast or passes its end, so that the tool stays on its way."""
    motion = view.allowed
    if motion.twist == STILL:
        return motion, None
    body = Ar2Kinematics(view.robot)
    rates, share = body.rates(body.begin(view.seen.commanded, view.body), motion.twist)
    if rates.watch.damping and share >= 1.0:
        return motion, f"near a singular posture, at {rates.watch.smallest:.3f}: the tool leaves its path"
    if share >= 1.0:
        return motion, None
    allowed = motion_of([share * it for it in motion.twist], motion.angles, motion.path_s)
    return allowed, f"the joints follow at {100.0 * share:.0f} % of that"


def _acceleration(view: View) -> tuple[Ar2Motion, str | None]:
    """Clip nothing, the ramp does; say where it will take more than one cycle."""
    requested, limits, cycle_s = view.allowed, view.geometry.limits, to_seconds(view.robot.cycle)
    before = view.seen.commanded
    speed = changed(before.speed, requested.speed, limits.acceleration_mps2 * cycle_s)
    turn = changed(before.turn, requested.turn, limits.turn_acceleration_rad_s2 * cycle_s)
    if math.dist((*speed, *turn), requested.twist) <= TOLERANCE:
        return requested, None
    return (
        requested,
        f"requested a change of {1000.0 * math.dist(before.speed, requested.speed):.0f} mm/s at once",
    )


def _limit(
    name: str,
    clip: Callable[[View], tuple[Ar2Motion, str | None]],
    remedy: str,
    severity: Severity = Severity.WARNING,
) -> Limit:
    return Limit(name, clip, remedy, clear_after=CLEARS_AFTER, severity=severity)


LIMITS: Final = (
    _limit("tool speed limit", lambda view: slowed(view, 1.0), "reduce the speed"),
    _limit("tool turn limit", _turn, "turn more slowly"),
    _limit("workspace", _workspace, "take the tool back inside"),
    _limit("joint limit", _joints, "take the tool elsewhere, or more slowly"),
    _limit("acceleration limit", _acceleration, "change the speed more slowly", Severity.INFO),
)
"""Applied in this order; a later one sees what an earlier one left."""
