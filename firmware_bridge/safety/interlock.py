"""The interlock with all its properties, and the view that it judges.

A predicate returns the reason while it is active, else None. It receives whether it is active already, so
that the threshold of its release may lie below the one of its trip. It keeps no state: timeouts are computed
from instants in the snapshot, and `firmware_bridge.safety.gate` keeps the release delays. A value that is not
a number or not known never counts as safe: comparisons are written so that a NaN trips.
"""

from collections.abc import Callable
from typing import Any, Final, Generic, TypeAlias, TypeVar

from firmware_bridge.drivers.driver import Feedback, Reports
from firmware_bridge.renamed import warn
from firmware_bridge.robot import Axis, Robot
from firmware_bridge.robot.table import Table
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from firmware_bridge.safety.snapshot import Decision, Facts, Group, Snapshot
from firmware_bridge.units import Nanoseconds

G = TypeVar("G", bound=Table)
M = TypeVar("M")
S = TypeVar("S")


class View(Generic[G, M, S]):
    """The input of an interlock: the robot, the snapshot, and the command as evaluated so far."""

    __slots__ = ("allowed", "before", "requested", "robot", "seen", "was_active")

    def __init__(
        self,
        robot: Robot[G],
        seen: Snapshot[M, S],
        allowed: M,
        requested: frozenset[Group],
        before: Decision[M] | None,
        *,
        was_active: bool = False,
    ) -> None:
        self.robot: Final = robot
        self.seen: Final = seen
        self.allowed: Final = allowed
        """The command as permitted so far; the original one before the first evaluation."""
        self.requested: Final = requested
        """The groups that the clipped command moves, stopped or not; only for interlocks after the limits."""
        self.before: Final = before
        """The decision before this one; None at the first."""
        self.was_active: Final = was_active
        """The interlock that looks is active already."""

    @property
    def holding(self) -> bool:
        """The old name of `was_active`."""
        warn("holding", "was_active", "View")
        return self.was_active

    @property
    def facts(self) -> Facts:
        """The facts known of any robot."""
        return self.seen.facts

    @property
    def body(self) -> S:
        """The state of this robot's body."""
        return self.seen.body

    @property
    def geometry(self) -> G:
        """The robot's geometry and limits."""
        return self.robot.geometry

    @property
    def asked(self) -> frozenset[Group]:
        """The old name of `requested`."""
        warn("asked", "requested", "View")
        return self.requested

    def active(self) -> "View[G, M, S]":
        """Return the same for an interlock that is active already."""
        return View(self.robot, self.seen, self.allowed, self.requested, self.before, was_active=True)


class Interlock(InterlockBase, Generic[G, M, S]):
    """A rule that stops the groups that it names while it is active."""

    __slots__ = ("after_limits", "judge")

    def __init__(
        self,
        name: str,
        judge: Callable[[View[G, M, S]], str | None],
        remedy: str,
        *,
        stops: frozenset[str] | None = None,
        clear_after: Nanoseconds = 0,
        severity: Severity = Severity.WARNING,
        disarms: bool = False,
        blocks_arming: bool = True,
        latches: bool = False,
        parts: bool = False,
        after_limits: bool = False,
    ) -> None:
        super().__init__(
            name,
            remedy,
            stops=stops,
            clear_after=clear_after,
            severity=severity,
            disarms=disarms,
            blocks_arming=blocks_arming,
            latches=latches,
            parts=parts,
        )
        self.judge: Final = judge
        self.after_limits: Final = after_limits
        """It judges what all interlocks and limits before it have allowed, not the command."""


class Limit(InterlockBase, Generic[G, M, S]):
    """A rule that clips an otherwise permitted command, and reports it; it stops nothing."""

    __slots__ = ("clip",)

    def __init__(
        self,
        name: str,
        clip: Callable[[View[G, M, S]], tuple[M, str | None]],
        remedy: str,
        *,
        clear_after: Nanoseconds,
        severity: Severity = Severity.WARNING,
    ) -> None:
        """Take its properties; one of `Severity.INFO` only ramps, and is reported once."""
        super().__init__(
            name, remedy, stops=frozenset(), clear_after=clear_after, severity=severity, blocks_arming=False
        )
        self.clip: Final = clip
        """Return `view.allowed` within the limit, and the reason where it was outside."""


AxisJudge: TypeAlias = Callable[[Axis, Feedback, Facts, Nanoseconds], str | None]
"""The axis, what is known of it, what is known of the robot, and the silence that its link allows."""


class AxisInterlock(InterlockBase):
    """Stops and disarms while it holds for one axis; the axis's name is added to its name.

    On a link that stops only some groups it stops those, and leaves the others armed.
    """

    __slots__ = ("judge", "needs", "replacement")

    def __init__(
        self,
        name: str,
        judge: AxisJudge,
        remedy: str,
        *,
        needs: frozenset[Reports] = frozenset(),
        replacement: "AxisInterlock | None" = None,
        stops: frozenset[str] | None = None,
        clear_after: Nanoseconds = 0,
        severity: Severity = Severity.WARNING,
        disables_power: bool = False,
    ) -> None:
        super().__init__(
            name,
            remedy,
            stops=stops,
            clear_after=clear_after,
            severity=severity,
            disarms=stops is None,
            disables_power=disables_power,
        )
        self.judge: Final = judge
        self.needs: Final = needs
        """Reports of the axis' driver that it needs."""
        self.replacement: Final = replacement
        """The weaker interlock for a driver without these reports; None: such a driver is refused."""

    def confined(self, stops: frozenset[str]) -> "AxisInterlock":
        """Return the same interlock for an axis on a link that stops only these groups."""
        return AxisInterlock(
            self.name,
            self.judge,
            self.remedy,
            needs=self.needs,
            stops=stops,
            clear_after=self.clear_after,
            severity=self.severity,
            disables_power=self.disables_power,
        )

    def fitting(self, reports: frozenset[Reports]) -> "AxisInterlock | None":
        """Return this interlock, or the first weaker one that `reports` suffice for; None: there is none."""
        interlock: AxisInterlock | None = self
        while interlock is not None and not interlock.needs <= reports:
            interlock = interlock.replacement
        return interlock


AnyView: TypeAlias = View[Any, Any, Any]
AnyInterlock: TypeAlias = Interlock[Any, Any, Any]
AnyLimit: TypeAlias = Limit[Any, Any, Any]
"""Of whichever robot."""
