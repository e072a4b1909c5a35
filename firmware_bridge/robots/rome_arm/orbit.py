"""The orbits that ROME shows: about the Earth, or one body as seen by another on a circle.

x and y are the base's, z is the tool's, and the heading stays (A. Seleit, MSc thesis, UCF, 2020, 2.4). Where
base or arm could not follow, the path's time is stretched: it flies the same way, later.
"""

import math
from collections.abc import Callable
from typing import Final, NamedTuple, TypeAlias

import numpy as np

from firmware_bridge.motion import orbit as two_bodies
from firmware_bridge.motion.orbit_relative import closed, transition
from firmware_bridge.motion.orbit_scale import Scale
from firmware_bridge.robots.ar2 import path_follower as arms
from firmware_bridge.robots.rome import paths as bases
from firmware_bridge.robots.rome_arm.geometry import RomeArmGeometry

USED: Final = 0.9
"""Share of the base's speed and acceleration, and of the tool's speed, that a path may ask for: the rest is
for the laws."""
LOOKED_AT: Final = 720
"""Instants of a revolution at which the base's ability to follow is checked."""

Flight: TypeAlias = Callable[[float], two_bodies.OrbitState]
"""Place and speed on the floor, m and m/s, at an instant of the path."""


class TimedPath(NamedTuple):
    """A path of base and tool, by its own seconds."""

    base: Callable[[float], bases.PathPoint]
    tool: Callable[[float], arms.CoursePoint]
    """From where it began."""
    stretch: float = 1.0
    """Ratio of its time to the body's own."""


def flown(flight: Flight, stretch: float, beside: tuple[float, float] = (0.0, 0.0)) -> TimedPath:
    """Return the path of a flight; where it begins the base stands beside, m."""

    def base(seconds: float) -> bases.PathPoint:
        at = flight(seconds)
        x, y = float(at.place[0]), float(at.place[1])
        # Only at the start: from then on this offset is an error that the law takes away.
        if not seconds > 0.0:
            x, y = x + beside[0], y + beside[1]
        return bases.PathPoint(x, y, 0.0, float(at.speed[0]), float(at.speed[1]), 0.0)

    height = float(flight(0.0).place[2])

    def tool(seconds: float) -> arms.CoursePoint:
        at = flight(seconds)
        return arms.CoursePoint((0.0, 0.0, float(at.place[2]) - height), (0.0, 0.0, float(at.speed[2])))

    return TimedPath(base, tool, stretch)


def orbit(geometry: RomeArmGeometry) -> TimedPath:
    """Return the orbit of the robot's file; for mu = 1 in DU and TU."""
    table, limits = geometry.orbit, geometry.base.limits
    begin = table.begin
    meant = Scale(table.m_per_du, table.height_per_du, table.s_per_tu)
    turn = two_bodies.period(begin)
    once = turn if turn < math.inf else LONGEST_TU
    states = (two_bodies.propagated(begin, once * it / LOOKED_AT) for it in range(LOOKED_AT))
    rising = USED * geometry.arm.limits.speed_mps
    # Looked at over one revolution, and slowed as a whole: the shape of the path stays.
    scale = meant.slowed(states, USED * limits.speed_mps, USED * limits.acceleration_mps2, rising)

    def flight(seconds: float) -> two_bodies.OrbitState:
        return scale.on_floor(two_bodies.propagated(begin, seconds / scale.seconds_per_tu))

    return flown(flight, scale.seconds_per_tu / meant.seconds_per_tu, table.sideways_m)


LONGEST_TU: Final = 100.0
"""So much of an orbit that never comes back is looked at, at most."""


def formation(geometry: RomeArmGeometry) -> TimedPath:
    """Return the closed ellipse, twice as long as wide, about a body on a circle: y' = -2 n x."""
    table, limits = geometry.formation, geometry.base.limits
    n = math.tau / table.turn_s
    # Twice as long, so twice as fast along its way: 2 n a, and n^2 of it as acceleration.
    along = 2.0 * table.half_width_m * n
    stretch = max(
        *(1.0, along / (USED * limits.speed_mps), math.sqrt(along * n / (USED * limits.acceleration_mps2))),
        abs(table.height_m) * n / (USED * geometry.arm.limits.speed_mps),
    )
    begin = closed((table.half_width_m, 0.0, 0.0), 0.0, table.height_m * n, n)
    first = np.concatenate((begin.place, begin.speed))

    def flight(seconds: float) -> two_bodies.OrbitState:
        at = transition(n, math.fmod(seconds / stretch, table.turn_s)) @ first
        # The same place at a later instant, so the speed falls by the stretch.
        return two_bodies.OrbitState(at[:3], at[3:] / stretch)

    return flown(flight, stretch)


def pose(geometry: RomeArmGeometry) -> TimedPath:
    """Return the poses beside as targets from the first instant: the laws alone take base and tool there."""
    (x, y), turn = geometry.pose.by_m, math.radians(geometry.pose.turn_deg)
    here, there = (bases.PathPoint(*place, 0.0, 0.0, 0.0) for place in ((0.0, 0.0, 0.0), (x, y, turn)))
    return TimedPath(
        lambda seconds: there if seconds > 0.0 else here,
        lambda seconds: arms.pose(geometry.arm.courses, seconds),
    )


PATHS: Final[dict[str, Callable[[RomeArmGeometry], TimedPath]]] = {
    "orbit": orbit,
    "formation": formation,
    "pose": pose,
}
"""Courses by the path followers' names."""
