"""A robot of two halves: each half's view of the whole, for its own rules, body and path followers.

A half is a robot type of its own. It sees its own motion, state and geometry, and everything that any robot
has, and does not know that there is another.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from typing import Any, Final, TypeAlias

from firmware_bridge.robot import Robot
from firmware_bridge.robot_type import AnyRobotType
from firmware_bridge.robots.ar2.kinematics import JOINTS
from firmware_bridge.robots.rome.kinematics import WHEELS
from firmware_bridge.robots.rome_arm.geometry import RomeArmGeometry
from firmware_bridge.robots.rome_arm.motion import RomeArmMotion, RomeArmState
from firmware_bridge.safety import interlock
from firmware_bridge.safety.snapshot import Snapshot

View: TypeAlias = interlock.View[RomeArmGeometry, RomeArmMotion, RomeArmState]
Interlock: TypeAlias = interlock.Interlock[RomeArmGeometry, RomeArmMotion, RomeArmState]
Limit: TypeAlias = interlock.Limit[RomeArmGeometry, RomeArmMotion, RomeArmState]
Seen: TypeAlias = Snapshot[RomeArmMotion, RomeArmState]
Clip: TypeAlias = Callable[[Any], tuple[Any, str | None]]


class Half:
    """One half, by the name that it has in geometry, motion and state."""

    def __init__(self, name: str, roles: Collection[str], label: str = "") -> None:
        """`roles` are its axes'; `label` stands before the names of its rows that the other half has, too."""
        self.name: Final = name
        self._roles: Final = frozenset(roles)
        self._label: Final = label

    def robot(self, whole: Robot[RomeArmGeometry]) -> Robot[Any]:
        """Return the robot with this half's geometry and axes alone."""
        axes = tuple(axis for axis in whole.axes if axis.role in self._roles)
        geometry = getattr(whole.geometry, self.name)
        half: Robot[Any] = whole.model_copy(update={"geometry": geometry, "axes": axes})
        return half

    def of(self, both: RomeArmMotion | RomeArmState) -> Any:
        """Return this half's motion or state."""
        return getattr(both, self.name)

    def put(self, whole: RomeArmMotion, motion: Any) -> RomeArmMotion:
        """Return the motion of both with another one of this half."""
        return replace(whole, **{self.name: motion})

    def seen(self, seen: Seen) -> Snapshot[Any, Any]:
        """Return what this half knows at that instant."""
        return Snapshot(
            facts=seen.facts,
            command=self.of(seen.command),
            commanded=self.of(seen.commanded),
            body=self.of(seen.body),
            pose=seen.pose,
            located=seen.located,
        )

    def view(self, view: View) -> "interlock.View[Any, Any, Any]":
        """Return the view of an interlock of this half, without the last decision, which was over both."""
        return interlock.View(
            self.robot(view.robot),
            self.seen(view.seen),
            self.of(view.allowed),
            view.requested,
            None,
            was_active=view.was_active,
        )

    def numbers(self, robot_type: AnyRobotType) -> dict[str, Callable[[RomeArmMotion], float | None]]:
        """Return what must be a finite number in this half's motion."""

        def of(read: Callable[[Any], float | None]) -> Callable[[RomeArmMotion], float | None]:
            return lambda motion: read(self.of(motion))

        return {title: of(read) for title, read in robot_type.numbers.items()}

    def interlocks(self, robot_type: AnyRobotType) -> Iterator[Interlock]:
        """Yield its interlocks; they stop both halves, as they stop the whole robot that the half is."""
        for row in robot_type.interlocks:
            yield interlock.Interlock(
                row.name,
                self._judging(row.judge),
                row.remedy,
                stops=row.stops,
                clear_after=row.clear_after,
                severity=row.severity,
                disarms=row.disarms,
                blocks_arming=row.blocks_arming,
                latches=row.latches,
                parts=row.parts,
                after_limits=row.after_limits,
            )

    def limits(self, robot_type: AnyRobotType) -> Iterator[Limit]:
        """Yield its limits; they clip its own motion."""
        for row in robot_type.limits:
            # Both halves have a speed limit; a name must be unique for its interlock event.
            name = row.name if row.name.startswith(self._label) else f"{self._label} {row.name}"
            clip = self.clipping(row.clip)
            yield interlock.Limit(name, clip, row.remedy, clear_after=row.clear_after, severity=row.severity)

    def clipping(self, clip: Clip) -> Callable[[View], tuple[RomeArmMotion, str | None]]:
        """Return what clips this half's motion in that of both."""

        def clipped(view: View) -> tuple[RomeArmMotion, str | None]:
            allowed, reason = clip(self.view(view))
            return self.put(view.allowed, allowed), reason

        return clipped

    def _judging(self, judge: Callable[[Any], str | None]) -> Callable[[View], str | None]:
        return lambda view: judge(self.view(view))


BASE: Final = Half("base", WHEELS)
ARM: Final = Half("arm", JOINTS, "tool")
