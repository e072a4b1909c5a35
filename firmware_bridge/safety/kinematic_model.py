"""The kinematic model of a robot: from axes to state, from a motion to axes, and the groups that move."""

from collections.abc import Mapping
from typing import Any, Protocol, TypeAlias, TypeVar

from firmware_bridge.drivers.driver import Feedback, Reading, SetPoint
from firmware_bridge.motion.pose import Pose
from firmware_bridge.safety.snapshot import Group
from firmware_bridge.units import Nanoseconds

M = TypeVar("M")
S = TypeVar("S")


class KinematicModel(Protocol[M, S]):
    """One robot's kinematic model: pure, numbers in, numbers out; SI units, axes by their names."""

    @property
    def rolling(self) -> tuple[str, ...]:
        """The axes from whose positions the pose is carried on; they are sampled at one instant for it."""

    def sensed(self, axes: Mapping[str, Feedback], sensors: Mapping[str, Reading]) -> S:
        """Return the state of the body by its axes and sensors; unknown values are None."""

    def requested(self, motion: M, state: S) -> frozenset[Group]:
        """Return the groups that this motion commands to move."""

    def moving(self, state: S) -> frozenset[Group]:
        """Return the groups that are seen to move."""

    def at_standstill(self, motion: M, groups: frozenset[Group]) -> M:
        """Return the motion with these groups at standstill."""

    def ramped(self, commanded: M, allowed: M, state: S, elapsed: Nanoseconds) -> M:
        """Return the next motion on the way to the allowed one, `elapsed` after `commanded`."""

    def set_points(self, motion: M, state: S) -> Mapping[str, SetPoint]:
        """Return the axes' set-points for this motion, the first first; an excluded axis is at standstill."""

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        sensors: Mapping[str, Reading],
    ) -> Pose:
        """Return the pose after the `rolling` axes moved between two samples; `sensors` are the newest."""


AnyKinematicModel: TypeAlias = KinematicModel[Any, Any]
