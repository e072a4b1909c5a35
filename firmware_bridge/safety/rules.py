"""The robot's half of what the gate judges by: its own interlocks, in the mode in which it is."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import Any, Final

from firmware_bridge.safety.interlock import AnyInterlock, AnyLimit
from firmware_bridge.safety.kinematic_model import AnyKinematicModel
from firmware_bridge.safety.snapshot import AnySnapshot, Facts, Group, Snapshot
from firmware_bridge.units import Nanoseconds


class Rules:
    """One mode's kinematic model, groups, interlocks and limits, in their order."""

    __slots__ = (
        "_silent_after",
        "_standstill_below",
        "after_limits",
        "carriers",
        "groups",
        "interlocks",
        "kinematics",
        "limits",
        "numbers",
        "travelling",
        "without",
    )  # fmt: skip

    def __init__(
        self,
        *,
        kinematics: AnyKinematicModel,
        without: frozenset[str],
        groups: frozenset[Group],
        travelling: frozenset[Group],
        standstill_below: Mapping[str, float],
        silent_after: Mapping[str, Nanoseconds],
        numbers: Mapping[str, Callable[[Any], float | None]],
        interlocks: tuple[AnyInterlock, ...],
        limits: tuple[AnyLimit, ...],
    ) -> None:
        self.kinematics: Final = kinematics
        self.without: Final = without
        """The names of the axes that the mode does without."""
        self.groups: Final = groups
        self.travelling: Final = travelling
        """The groups that take the robot from its place."""
        self._standstill_below: Final = tuple(standstill_below.items())
        """The axes that do, by their names, and the speed at which each does not stand any more."""
        self.carriers: Final = frozenset(without.intersection(standstill_below))
        """Those of the axes left out that take the robot from its place, and hold it where it is."""
        self._silent_after: Final = silent_after
        self.numbers: Final = numbers
        """The values of a motion that must be finite numbers, by their titles for people."""
        self.interlocks: Final = tuple(interlock for interlock in interlocks if not interlock.after_limits)
        self.limits: Final = limits
        self.after_limits: Final = tuple(interlock for interlock in interlocks if interlock.after_limits)
        """Those that judge what all interlocks and limits before them have allowed."""

    def at_standstill(self, seen: AnySnapshot) -> bool:
        """Return whether the robot is at standstill, and is not commanded otherwise.

        Each axis is judged: wheels that turn against each other leave the robot in place, and are not at
        standstill.
        """
        return not self.kinematics.requested(seen.commanded, seen.body) & self.travelling and self.stopped(
            seen
        )

    def stopped(self, seen: AnySnapshot) -> bool:
        """Return whether the robot is at standstill, whatever it is commanded."""
        axes = seen.facts.axes
        return not self.kinematics.moving(seen.body) & self.travelling and all(
            # An excluded axis that has timed out can prove no standstill: without this no degraded mode could
            # begin.
            abs(axes[name].velocity) < bound or self._is_silent(name, seen.facts)
            for name, bound in self._standstill_below
        )

    def sensed(self, seen: AnySnapshot) -> AnySnapshot:
        """Return the snapshot as this mode's kinematic model would have sensed it."""
        return self._of(seen, seen.facts)

    def believed(self, seen: AnySnapshot, untrusted: Collection[str]) -> AnySnapshot | None:
        """Return the snapshot with the untrusted axes at standstill; None where no trusted one carries."""
        if all(name in untrusted for name, _ in self._standstill_below):
            return None
        stand = {name: replace(seen.facts.axes[name], velocity=0.0) for name in untrusted}
        return self._of(seen, replace(seen.facts, axes={**seen.facts.axes, **stand}))

    def _of(self, seen: AnySnapshot, facts: Facts) -> AnySnapshot:
        return Snapshot(
            facts=facts,
            command=seen.command,
            commanded=seen.commanded,
            body=self.kinematics.sensed(facts.axes, facts.sensors),
            pose=seen.pose,
            located=seen.located,
        )

    def _is_silent(self, name: str, facts: Facts) -> bool:
        """Return whether an axis that the mode does without has timed out: its last report is old."""
        return name in self.without and facts.now - facts.axes[name].received_at >= self._silent_after[name]
