"""ROME's body: its base and its arm, each for itself, but for what the arm leaves of the base's ramp."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

from firmware_bridge.drivers.driver import Demand, Feedback, Reading
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.robots.ar2 import body as arms
from firmware_bridge.robots.ar2 import motion as arm
from firmware_bridge.robots.rome import body as bases
from firmware_bridge.robots.rome import motion as base
from firmware_bridge.robots.rome_arm.balance import balance
from firmware_bridge.robots.rome_arm.geometry import Geometry
from firmware_bridge.robots.rome_arm.halves import ARM, BASE
from firmware_bridge.robots.rome_arm.motion import Motion, State
from firmware_bridge.units import Nanoseconds

GROUPS: Final = {**bases.GROUPS, **arms.GROUPS}


class Body:
    """A `firmware_bridge.safety.body.Body`."""

    __slots__ = ("_arm", "_base", "_geometry", "rolling")

    def __init__(self, robot: Robot[Geometry]) -> None:
        self._base = bases.Body(BASE.robot(robot))
        self._arm = arms.Body(ARM.robot(robot))
        self._geometry = robot.geometry
        self.rolling: tuple[str, ...] = self._base.rolling
        """The wheels: where the joints are does not move the base."""

    def sensed(self, axes: Mapping[str, Feedback], sensors: Mapping[str, Reading]) -> State:
        """Return how the base moves, and where the joints are."""
        return State(self._base.sensed(axes, sensors), self._arm.sensed(axes, sensors))

    def requested(self, motion: Motion, state: State) -> frozenset[str]:
        """Return the groups that the motion commands to move."""
        return self._base.requested(motion.base, state.base) | self._arm.requested(motion.arm, state.arm)

    def moving(self, state: State) -> frozenset[str]:
        """Return what is seen to move."""
        return self._base.moving(state.base) | self._arm.moving(state.arm)

    def rested(self, motion: Motion, groups: frozenset[str]) -> Motion:
        """Return the motion with these at rest."""
        return replace(
            motion, base=self._base.rested(motion.base, groups), arm=self._arm.rested(motion.arm, groups)
        )

    def ramped(self, demanded: Motion, allowed: Motion, state: State, elapsed: Nanoseconds) -> Motion:
        """Return the next demand; with its arm stretched out the base changes its speed more slowly."""
        share = self.share(state)
        return replace(
            allowed,
            base=self._base.ramped(demanded.base, allowed.base, state.base, round(share * elapsed)),
            arm=self._arm.ramped(demanded.arm, allowed.arm, state.arm, elapsed),
        )

    def share(self, state: State) -> float:
        """Return the share of the base's acceleration with which the robot keeps its balance.

        It goes on to stop, as gently as that may be, also where there is no room left.
        """
        limit = self._geometry.base.limits.acceleration_mps2
        room = balance(self._geometry, state.arm.angles).gentlest(self._geometry.balance.margin_m)
        return max(LEAST, FOLLOWED * min(1.0, max(LEAST, room / limit)))

    def demands(self, motion: Motion, state: State) -> Mapping[str, Demand]:
        """Return the wheels' speeds, and where the joints shall be."""
        return {**self._base.demands(motion.base, state.base), **self._arm.demands(motion.arm, state.arm)}

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


def reach(robot: Robot[Geometry]) -> Iterator[tuple[Motion, State]]:
    """Yield the fastest motions of the base, and both ends of the joints."""
    still, stands = base.Motion(), base.State(0.0, 0.0, 0.0)
    for motion, state in arms.reach(ARM.robot(robot)):
        yield Motion(still, motion), State(stands, state)
        rests = state
    for fast, moves in bases.reach(BASE.robot(robot)):
        yield Motion(fast, arm.Motion()), State(moves, rests)
