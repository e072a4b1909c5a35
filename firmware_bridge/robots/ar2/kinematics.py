"""The arm's kinematic model: from joints to the tool, and from its commanded motion to joint positions.

A set-point is where the joints are at the cycle's end, so that steps that are too small for one are made up
for in a later one. Source of the law: A. Seleit, MSc thesis, UCF, 2020, (3.15) and (3.16).
"""

import math
from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from firmware_bridge.drivers.driver import Feedback, Position, Reading, SetPoint
from firmware_bridge.families.ar2.settings import Ar2Axis
from firmware_bridge.motion.pose import Pose
from firmware_bridge.motion.ramp import MARGIN
from firmware_bridge.motion.resolved_rate import Rates, resolved, slowed
from firmware_bridge.robot import Robot
from firmware_bridge.robots.ar2.arm import AR2
from firmware_bridge.robots.ar2.geometry import Ar2Geometry
from firmware_bridge.robots.ar2.motion import STILL, Ar2Motion, Ar2State, motion_of
from firmware_bridge.units import Nanoseconds, to_seconds

TOOL: Final = "tool"
JOINTS: Final = ("j1", "j2", "j3", "j4", "j5", "j6")
GROUPS: Final = {TOOL: frozenset(JOINTS)}
NOTHING: Final[frozenset[str]] = frozenset()
MOVES: Final = 0.02
"""Share of its top speed from which a joint counts as moving."""
APART: Final = 0.75
"""Steps of a joint from its last set-point: one by rounding, and half of it is left."""
NEAR_TOP: Final = 0.95
"""Share of the joints' top speeds that is used: steps are whole."""


def changed(before: tuple[float, ...], wanted: tuple[float, ...], most: float) -> tuple[float, ...]:
    """Return a vector that comes as near to the wanted one as a step of this length allows."""
    way = [new - old for old, new in zip(before, wanted, strict=True)]
    length = math.hypot(*way)
    if not length > most:
        return wanted
    return tuple(old + most / length * step for old, step in zip(before, way, strict=True))


class Ar2Kinematics:
    """A `firmware_bridge.safety.kinematic_model.KinematicModel`."""

    __slots__ = ("_cycle_s", "_fastest", "_limits", "_margin", "_names", "_steps", "_travel", "rolling")

    def __init__(self, robot: Robot[Ar2Geometry]) -> None:
        axes = [robot.axis(role) for role in JOINTS]
        self._names = tuple(axis.name for axis in axes)
        self._fastest = tuple(axis.top_speed for axis in axes)
        self._steps = tuple(1.0 / Ar2Axis.of(axis).steps_per_unit(axis.ratio) for axis in axes)
        # Transposed: one row of lower ends, one of upper ends.
        self._travel = np.array([axis.travel for axis in axes]).T
        self._limits = robot.geometry.limits
        self._margin = math.radians(robot.geometry.limits.joint_margin_deg)
        self._cycle_s = to_seconds(robot.cycle)
        self.rolling: tuple[str, ...] = self._names
        """The arm rests when none of its joints moves; its pose stays, as its foot does."""

    def sensed(self, axes: Mapping[str, Feedback], _sensors: Mapping[str, Reading]) -> Ar2State:
        """Return where the joints are, as they are counted."""
        feedback = [axes[name] for name in self._names]
        return Ar2State(tuple(it.position for it in feedback), tuple(it.velocity for it in feedback))

    def requested(self, motion: Ar2Motion, _state: Ar2State) -> frozenset[str]:
        """Return the arm where the motion commands it to move."""
        return NOTHING if motion.twist == STILL else frozenset({TOOL})

    def moving(self, state: Ar2State) -> frozenset[str]:
        """Return the arm where a joint is counted to move."""
        slow = (abs(it) <= MOVES * top for it, top in zip(state.rates, self._fastest, strict=True))
        return NOTHING if all(slow) else frozenset({TOOL})

    def at_standstill(self, motion: Ar2Motion, groups: frozenset[str]) -> Ar2Motion:
        """Return the motion at standstill."""
        return motion_of(STILL, path_s=motion.path_s) if TOOL in groups else motion

    def ramped(
        self, commanded: Ar2Motion, allowed: Ar2Motion, state: Ar2State, elapsed: Nanoseconds
    ) -> Ar2Motion:
        """Return the next set-point on the way to what is allowed, with where the joints shall be."""
        seconds, limits = to_seconds(elapsed), self._limits
        twist = (
            *changed(commanded.speed, allowed.speed, MARGIN * limits.acceleration_mps2 * seconds),
            *changed(commanded.turn, allowed.turn, MARGIN * limits.turn_acceleration_rad_s2 * seconds),
        )
        if twist == STILL:
            return Ar2Motion(path_s=allowed.path_s)
        begin = self.begin(commanded, state)
        # One share for all joints keeps the tool's direction; the travel is clipped against rounding only.
        rates, share = self.rates(begin, twist)
        angles = np.clip(np.array(begin) + share * self._cycle_s * rates.joints, *self._travel)
        return motion_of(twist, tuple(map(float, angles)), allowed.path_s)

    def begin(self, commanded: Ar2Motion, state: Ar2State) -> tuple[float, ...]:
        """Return from where the joints go on: from where they were to be, unless they have not got there."""
        if commanded.angles is None:
            return state.angles
        # A joint that is further off than its rounding did not get there: it goes on from where it is
        # counted.
        apart = (
            abs(a - b) > APART * one
            for a, b, one in zip(commanded.angles, state.angles, self._steps, strict=True)
        )
        return state.angles if any(apart) else commanded.angles

    def rates(self, angles: tuple[float, ...], twist: tuple[float, ...]) -> tuple[Rates, float]:
        """Return the joints' rates for the tool's motion, and the share of them at which all may follow."""
        found = resolved(AR2, angles, np.array(twist))
        top = [NEAR_TOP * it for it in self._fastest]
        return found, slowed(AR2, angles, found.joints, top, self._cycle_s, margin=self._margin)

    def set_points(self, motion: Ar2Motion, _state: Ar2State) -> Mapping[str, SetPoint]:
        """Return where the joints shall be; those that shall stay rest."""
        if motion.angles is None:
            return {}
        return {name: Position(angle) for name, angle in zip(self._names, motion.angles, strict=True)}

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        sensors: Mapping[str, Reading],
    ) -> Pose:
        """Return the pose, in which the foot stays."""
        del before, after, sensors
        return pose


def reach(robot: Robot[Ar2Geometry]) -> Iterator[tuple[Ar2Motion, Ar2State]]:
    """Yield both ends of all joints, as far as they may go."""
    margin = math.radians(robot.geometry.limits.joint_margin_deg)
    for ends, inwards in ((AR2.least, margin), (AR2.most, -margin)):
        angles = tuple(end + inwards for end in ends)
        yield Ar2Motion(angles=angles), Ar2State(angles, STILL)
