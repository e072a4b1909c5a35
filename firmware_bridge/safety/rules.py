"""The robot's half of what the gate judges by: its own rows, in the mode in which it is."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import Any, Final

from firmware_bridge.safety.interlock import AnyInterlock, AnyLimit
from firmware_bridge.safety.kinematic_model import AnyKinematicModel
from firmware_bridge.safety.snapshot import AnySnapshot, Facts, Group, Snapshot
from firmware_bridge.units import Nanoseconds


class Rules:
    """One mode's body, groups, interlocks and limits, in their order."""

    __slots__ = (
        "_rests_below",
        "_silent_after",
        "after_limits",
        "body",
        "carriers",
        "groups",
        "interlocks",
        "limits",
        "numbers",
        "travelling",
        "without",
    )  # fmt: skip

    def __init__(
        self,
        *,
        body: AnyKinematicModel,
        without: frozenset[str],
        groups: frozenset[Group],
        travelling: frozenset[Group],
        standstill_below: Mapping[str, float],
        silent_after: Mapping[str, Nanoseconds],
        numbers: Mapping[str, Callable[[Any], float | None]],
        interlocks: tuple[AnyInterlock, ...],
        limits: tuple[AnyLimit, ...],
    ) -> None:
        self.body: Final = body
        self.without: Final = without
        """The names of the axes that the mode does without."""
        self.groups: Final = groups
        self.travelling: Final = travelling
        """The groups that take the robot from its place."""
        self._rests_below: Final = tuple(standstill_below.items())
        """The axes that do, by their names, and the speed at which each does not stand any more."""
        self.carriers: Final = frozenset(without.intersection(standstill_below))
        """Those of the axes left out that take the robot from its place, and hold it where it is."""
        self._silent_after: Final = silent_after
        self.numbers: Final = numbers
        """The values of a motion that must be finite numbers, by their titles for people."""
        self.interlocks: Final = tuple(row for row in interlocks if not row.after_limits)
        self.limits: Final = limits
        self.after_limits: Final = tuple(row for row in interlocks if row.after_limits)
        """Those that judge what all rows and limits before them have allowed."""

    def at_standstill(self, seen: AnySnapshot) -> bool:
        """Return whether the robot is at standstill, and is not commanded otherwise.

        Each axis is judged: wheels that turn against each other leave the robot in place, and are not at
        standstill.
        """
        return not self.body.requested(seen.commanded, seen.body) & self.travelling and self.stands(seen)

    def stands(self, seen: AnySnapshot) -> bool:
        """Return whether the robot is at standstill, whatever it is commanded."""
        axes = seen.facts.axes
        return not self.body.moving(seen.body) & self.travelling and all(
            # An excluded axis that has timed out can prove no standstill: without this no degraded mode could
            # begin.
            abs(axes[name].velocity) < bound or self._is_silent(name, seen.facts)
            for name, bound in self._rests_below
        )

    def sensed(self, seen: AnySnapshot) -> AnySnapshot:
        """Return the snapshot as this mode's body would have sensed it."""
        return self._of(seen, seen.facts)

    def believed(self, seen: AnySnapshot, untrusted: Collection[str]) -> AnySnapshot | None:
        """Return the snapshot with the untrusted axes at standstill; None where no trusted one carries."""
        if all(name in untrusted for name, _ in self._rests_below):
            return None
        stand = {name: replace(seen.facts.axes[name], velocity=0.0) for name in untrusted}
        return self._of(seen, replace(seen.facts, axes={**seen.facts.axes, **stand}))

    def _of(self, seen: AnySnapshot, facts: Facts) -> AnySnapshot:
        return Snapshot(
            facts=facts,
            command=seen.command,
            commanded=seen.commanded,
            body=self.body.sensed(facts.axes, facts.sensors),
            pose=seen.pose,
            located=seen.located,
        )

    def _is_silent(self, name: str, facts: Facts) -> bool:
        """Return whether an axis that the mode does without has timed out: its last report is old."""
        return name in self.without and facts.now - facts.axes[name].received_at >= self._silent_after[name]
