"""ROME's kinematic model: base and arm, each for itself, but for what the arm leaves of the base's ramp."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

from firmware_bridge.drivers.driver import Feedback, Reading, SetPoint
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.robots.ar2 import kinematics as arms
from firmware_bridge.robots.ar2 import motion as arm
from firmware_bridge.robots.rome import kinematics as bases
from firmware_bridge.robots.rome import motion as base
from firmware_bridge.robots.rome_arm.balance import balance
from firmware_bridge.robots.rome_arm.geometry import RomeArmGeometry
from firmware_bridge.robots.rome_arm.halves import ARM, BASE
from firmware_bridge.robots.rome_arm.motion import RomeArmMotion, RomeArmState
from firmware_bridge.units import Nanoseconds

GROUPS: Final = {**bases.GROUPS, **arms.GROUPS}


class RomeArmKinematics:
    """A `firmware_bridge.safety.kinematic_model.KinematicModel`."""

    __slots__ = ("_arm", "_base", "_geometry", "rolling")

    def __init__(self, robot: Robot[RomeArmGeometry]) -> None:
        self._base = bases.RomeKinematics(BASE.robot(robot))
        self._arm = arms.Ar2Kinematics(ARM.robot(robot))
        self._geometry = robot.geometry
        self.rolling: tuple[str, ...] = self._base.rolling
        """The wheels: where the joints are does not move the base."""

    def sensed(self, axes: Mapping[str, Feedback], sensors: Mapping[str, Reading]) -> RomeArmState:
        """Return how the base moves, and where the joints are."""
        return RomeArmState(self._base.sensed(axes, sensors), self._arm.sensed(axes, sensors))

    def requested(self, motion: RomeArmMotion, state: RomeArmState) -> frozenset[str]:
        """Return the groups that the motion commands to move."""
        return self._base.requested(motion.base, state.base) | self._arm.requested(motion.arm, state.arm)

    def moving(self, state: RomeArmState) -> frozenset[str]:
        """Return what is seen to move."""
        return self._base.moving(state.base) | self._arm.moving(state.arm)

    def at_standstill(self, motion: RomeArmMotion, groups: frozenset[str]) -> RomeArmMotion:
        """Return the motion with these at standstill."""
        return replace(
            motion,
            base=self._base.at_standstill(motion.base, groups),
            arm=self._arm.at_standstill(motion.arm, groups),
        )

    def ramped(
        self, commanded: RomeArmMotion, allowed: RomeArmMotion, state: RomeArmState, elapsed: Nanoseconds
    ) -> RomeArmMotion:
        """Return the next set-point; with its arm stretched out the base changes its speed more slowly."""
        share = self.share(state)
        return replace(
            allowed,
            # Less time for the ramp is less acceleration, in the same proportion for all directions.
            base=self._base.ramped(commanded.base, allowed.base, state.base, round(share * elapsed)),
            arm=self._arm.ramped(commanded.arm, allowed.arm, state.arm, elapsed),
        )

    def share(self, state: RomeArmState) -> float:
        """Return the share of the base's acceleration with which the robot keeps its balance.

        It goes on to stop, as gently as that may be, also where there is no room left.
        """
        limit = self._geometry.base.limits.acceleration_mps2
        room = balance(self._geometry, state.arm.angles).gentlest(self._geometry.balance.margin_m)
        # Never 0: a base that may not slow down would not stop either.
        return max(LEAST, FOLLOWED * min(1.0, max(LEAST, room / limit)))

    def set_points(self, motion: RomeArmMotion, state: RomeArmState) -> Mapping[str, SetPoint]:
        """Return the wheels' speeds, and where the joints shall be."""
        return {
            **self._base.set_points(motion.base, state.base),
            **self._arm.set_points(motion.arm, state.arm),
        }

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        sensors: Mapping[str, Reading],
    ) -> Pose:
        """Return the pose after the wheels rolled on."""
        return self._base.advanced(pose, before, after, sensors)


FOLLOWED: Final = 0.93
"""Share that set-points use: where the base turns back under the arm its wheels stick, and then catch up."""
LEAST: Final = 0.2
"""So much of its acceleration the base has at least, or it would not stop."""


def reach(robot: Robot[RomeArmGeometry]) -> Iterator[tuple[RomeArmMotion, RomeArmState]]:
    """Yield the fastest motions of the base, and both ends of the joints."""
    still, stands = base.RomeMotion(), base.RomeState(0.0, 0.0, 0.0)
    for motion, state in arms.reach(ARM.robot(robot)):
        yield RomeArmMotion(still, motion), RomeArmState(stands, state)
        rests = state
    for fast, moves in bases.reach(BASE.robot(robot)):
        yield RomeArmMotion(fast, arm.Ar2Motion()), RomeArmState(moves, rests)
