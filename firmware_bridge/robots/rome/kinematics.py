"""ROME's kinematic model: from wheels to the base's state, and from a motion to the wheels' set-points."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

from firmware_bridge.drivers.driver import Feedback, Reading, SetPoint, Speed
from firmware_bridge.motion.omni import BodyTwist, OmniRamp, moved, rims, shortened, twist
from firmware_bridge.motion.pose import Pose
from firmware_bridge.motion.ramp import MARGIN
from firmware_bridge.robot import Robot
from firmware_bridge.robots.rome.geometry import RomeGeometry
from firmware_bridge.robots.rome.motion import RomeMotion, RomeState
from firmware_bridge.units import Nanoseconds

BASE: Final = "base"
WHEELS: Final = ("wheel_one", "wheel_two", "wheel_three")
GROUPS: Final = {BASE: frozenset(WHEELS)}
NOTHING: Final[frozenset[str]] = frozenset()

MOVES_MPS: Final = 0.010
"""Speed at which the base counts as driving."""
TURNS_RAD_S: Final = 0.060
"""Turn rate at which it counts as turning: 10 mm/s at the rims."""
DIRECTIONS: Final = 24
"""In which its bounds are looked at."""


def ramp_of(robot: Robot[RomeGeometry]) -> OmniRamp:
    """Return the bounds of how fast the motion changes."""
    limits = robot.geometry.limits
    return OmniRamp(MARGIN * limits.acceleration_mps2, MARGIN * limits.turn_acceleration_rad_s2, robot.cycle)


class RomeKinematics:
    """A `firmware_bridge.safety.kinematic_model.KinematicModel`."""

    __slots__ = ("_distance", "_radius", "_ramp", "rolling")

    def __init__(self, robot: Robot[RomeGeometry]) -> None:
        self._radius = robot.geometry.base.wheel_radius_m
        self._distance = robot.geometry.base.wheel_distance_m
        self._ramp = ramp_of(robot)
        self.rolling: tuple[str, ...] = tuple(robot.axis(role).name for role in WHEELS)
        """The axes from whose positions the pose is carried on."""

    def sensed(self, axes: Mapping[str, Feedback], _sensors: Mapping[str, Reading]) -> RomeState:
        """Return how the base moves."""
        return RomeState(*self._twist([axes[name].velocity for name in self.rolling]))

    def requested(self, motion: RomeMotion, _state: RomeState) -> frozenset[str]:
        """Return the base where the motion commands it to move."""
        return NOTHING if motion.twist == (0.0, 0.0, 0.0) else frozenset({BASE})

    def moving(self, state: RomeState) -> frozenset[str]:
        """Return the base where it is seen to move."""
        slow = math.hypot(state.ahead_mps, state.left_mps) < MOVES_MPS
        return NOTHING if slow and abs(state.turn_rad_s) < TURNS_RAD_S else frozenset({BASE})

    def at_standstill(self, motion: RomeMotion, groups: frozenset[str]) -> RomeMotion:
        """Return the motion at standstill."""
        return replace(motion, ahead_mps=0.0, left_mps=0.0, turn_rad_s=0.0) if BASE in groups else motion

    def ramped(
        self, commanded: RomeMotion, allowed: RomeMotion, _state: RomeState, elapsed: Nanoseconds
    ) -> RomeMotion:
        """Return the next set-point on the way to what is allowed."""
        return replace(allowed, **_as_motion(self._ramp.step(commanded.twist, allowed.twist, elapsed)))

    def set_points(self, motion: RomeMotion, _state: RomeState) -> Mapping[str, SetPoint]:
        """Return the wheels' speeds."""
        speeds = rims(motion.twist, self._distance)
        return {name: Speed(rim / self._radius) for name, rim in zip(self.rolling, speeds, strict=True)}

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        _sensors: Mapping[str, Reading],
    ) -> Pose:
        """Return the pose after the wheels rolled on."""
        # From positions and not from speeds: a lost sample then loses no way.
        return moved(pose, self._twist([after[it].position - before[it].position for it in self.rolling]))

    def _twist(self, turned: list[float]) -> BodyTwist:
        one, two, three = (self._radius * it for it in turned)
        return twist((one, two, three), self._distance)


def _as_motion(wanted: BodyTwist) -> dict[str, float]:
    return {"ahead_mps": wanted.ahead, "left_mps": wanted.left, "turn_rad_s": wanted.turn}


def with_twist(motion: RomeMotion, wanted: BodyTwist) -> RomeMotion:
    """Return the motion with another twist."""
    return replace(motion, **_as_motion(wanted))


def reach(robot: Robot[RomeGeometry]) -> Iterator[tuple[RomeMotion, RomeState]]:
    """Yield the fastest motions: in all directions, turning to either side and not."""
    limits, base = robot.geometry.limits, robot.geometry.base
    for place in range(DIRECTIONS):
        course = math.tau * place / DIRECTIONS
        for turn in (-limits.turn_rate_rad_s, 0.0, limits.turn_rate_rad_s):
            for speed in (0.0, limits.setpoint_mps):
                wanted = BodyTwist(speed * math.cos(course), speed * math.sin(course), turn)
                # Driving and turning share the rims' speed: both at full is beyond what the wheels can do.
                reached = shortened(wanted, base.wheel_distance_m, limits.rim_mps)
                yield with_twist(RomeMotion(), reached), RomeState(*reached)
