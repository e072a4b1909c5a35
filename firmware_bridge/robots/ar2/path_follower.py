"""The arm's path followers: resolved rate along a course of the tool; the gate judges their commands.

q' = J+ (x_r' + K e), with e = x_r - x, and for a pose the law (3.21) to (3.23) (A. Seleit, MSc thesis, UCF,
2020), with an integral and a derivative where their gains are not 0. A course begins where the tool is; while
the arm is held back it waits, and the integral is forgotten. The last set-points of the joints count as their
positions: they are there at the end of a move, and nothing measures them.

Tests of the source: (3.24), a ramp, and (3.25), a sine, both upwards, of 80 in 60 s; mm by context. Fig. 3.9
has the ramp in open loop, Fig. 3.10 the sine by PI, Fig. 3.11 the orbit's height, z of (4.10), by PID.
"""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final, NamedTuple, TypeAlias

import numpy as np

from firmware_bridge.motion.chain import Matrix
from firmware_bridge.motion.orbit import THESIS, propagated
from firmware_bridge.motion.resolved_rate import PoseControl, PoseGains
from firmware_bridge.robot import Robot
from firmware_bridge.robots.ar2.arm import AR2
from firmware_bridge.robots.ar2.geometry import Ar2Gains, Ar2Geometry, Courses
from firmware_bridge.robots.ar2.kinematics import Ar2Kinematics
from firmware_bridge.robots.ar2.motion import STILL, Ar2Motion, Ar2State, motion_of
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import Nanoseconds, to_seconds


class CoursePoint(NamedTuple):
    """A course's position at an instant, from where it began, m and m/s; turned by a vector, rad."""

    by: tuple[float, float, float]
    speed: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turned: tuple[float, float, float] = (0.0, 0.0, 0.0)


Course: TypeAlias = Callable[[Courses, float], CoursePoint]


def ramp(courses: Courses, seconds: float) -> CoursePoint:
    """Return the place on a ramp upwards, which ends at its height."""
    rate = courses.height_m / courses.ramp_s
    over = seconds >= courses.ramp_s
    height = courses.height_m if over else rate * seconds
    return CoursePoint((0.0, 0.0, height), (0.0, 0.0, 0.0 if over else rate))


def sine(courses: Courses, seconds: float) -> CoursePoint:
    """Return the place on one sine up and down, which ends where it began."""
    if seconds >= courses.ramp_s:
        return CoursePoint((0.0, 0.0, 0.0))
    rate = math.tau / courses.ramp_s
    height = courses.height_m * math.sin(rate * seconds)
    return CoursePoint((0.0, 0.0, height), (0.0, 0.0, courses.height_m * rate * math.cos(rate * seconds)))


def pose(courses: Courses, seconds: float) -> CoursePoint:
    """Return the pose beside as the target from the first instant: the law alone takes the tool there."""
    del seconds
    x, y, z = (math.radians(it) for it in courses.pose.tilt_deg)
    return CoursePoint(courses.pose.by_m, turned=(x, y, z))


def orbit_z(courses: Courses, seconds: float) -> CoursePoint:
    """Return the place on the height of the orbit (4.10), 1 TU in 1 s, again and again."""
    at, scale = propagated(THESIS, seconds), courses.orbit_m_per_du
    height = scale * float(at.place[2] - THESIS.place[2])
    return CoursePoint((0.0, 0.0, height), (0.0, 0.0, scale * float(at.speed[2])))


COURSES: Final[Mapping[str, Course]] = MappingProxyType({"ramp": ramp, "sine": sine, "pose": pose})
"""Courses by the path followers' names."""
LAWS: Final[Mapping[str, Course]] = MappingProxyType({"ramp_open": ramp, "sine_pi": sine, "orbit_z": orbit_z})
"""Courses of the path followers with gains of their own: their names are keys of `Ar2Control`."""
LIMITED: Final = 1e-9
"""A tool that does so much less than the last command, m/s, was limited."""


class Ar2PathFollower:
    """A `firmware_bridge.robot_type.PathFollower` along one course."""

    def __init__(self, robot: Robot[Ar2Geometry], course: Course, law: str = "") -> None:
        """`law` is the key of its own gains in `control`; empty for the gains of all others."""
        geometry = robot.geometry
        gains: Ar2Gains = getattr(geometry.control, law) if law else geometry.control
        self._courses: Final = geometry.courses
        self._control: Final = PoseControl(
            PoseGains(gains.kp_per_s, gains.ko_per_s, gains.ki_per_s2, gains.kd)
        )
        self._course: Final = course
        self._body: Final = Ar2Kinematics(robot)
        self._start: Matrix | None = None
        self._seconds = 0.0
        self._waits = False
        self._last: tuple[float, ...] | None = None
        """The tool's speed of the last command, m/s; None where the law begins again."""

    def reset(self) -> None:
        """Let the course wait, and forget the integral: the arm was held back."""
        self._waits, self._last = True, None
        self._control.reset()

    def command(self, seen: Snapshot[Ar2Motion, Ar2State], elapsed: Nanoseconds) -> Ar2Motion:
        """Return the motion towards where the course is now."""
        actual = AR2.pose(self._body.begin(seen.commanded, seen.body))
        # The first cycle only takes the place: the course begins where the tool is.
        if self._start is None:
            self._start = actual
        elif not self._waits:
            self._seconds += to_seconds(elapsed)
        self._waits = False
        place = self._course(self._courses, self._seconds)
        desired = np.eye(4)
        desired[:3, :3] = turned(place.turned) @ self._start[:3, :3]
        desired[:3, 3] = self._start[:3, 3] + place.by
        # The courses turn the tool to a fixed attitude, so their rate of turn is 0.
        feed = np.array((*place.speed, *STILL[3:]))
        limited = self._last is not None and math.dist(self._last, seen.commanded.speed) > LIMITED
        law = self._control.twist(desired, actual, feed, to_seconds(elapsed), limited=limited)
        motion = motion_of(law.tolist(), path_s=self._seconds)
        self._last = motion.speed
        return motion


def turned(by: tuple[float, float, float]) -> Matrix:
    """Return the matrix that turns about a vector by its length in rad (O. Rodrigues)."""
    angle = math.hypot(*by)
    if not angle:
        return np.eye(3)
    x, y, z = (it / angle for it in by)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # (O. Rodrigues): 1 + sin a K + (1 - cos a) K^2.
    found: Matrix = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
    return found
