"""Supervision of a drive: what the axis finds, its emergencies, how to react to them, and what may be reset.

A product's rows are in a `Supervision`. The power sequence brings the motor to standstill.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import reduce
from operator import or_
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.option_codes import FAULT_REACTION, ErrorReaction
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen.emergency import Emergency, FaultReaction, Recovery


@dataclass(frozen=True, slots=True)
class Watch:
    """A flag of the axis and the emergency that it stands for."""

    flag: int
    code: int
    measuring: int = 0
    """The emergency in its place while the drive looks for its commutation, in Measure init."""
    absolute: int = 0
    """The emergency in its place with a sensor that reports a position."""

    def code_in(self, state: PowerState, *, absolute: bool) -> int:
        """Return the emergency in this state, with this kind of position sensor."""
        if self.measuring and state is PowerState.MEASURE_INIT:
            return self.measuring
        return self.absolute if self.absolute and absolute else self.code


def _no_contradiction(_store: ObjectStore, _state: PowerState) -> int | None:
    return None


def _never(_store: ObjectStore) -> bool:
    return False


@dataclass(frozen=True, slots=True, kw_only=True)
class Supervision:
    """The errors of a product."""

    watches: tuple[Watch, ...]
    emergencies: Mapping[int, Emergency]
    """The reaction to each, and what resets it; a code without a row switches off."""
    fault_options: Mapping[int, ErrorReaction] = field(default_factory=lambda: FAULT_REACTION)
    """0x605E, for the errors that allow a ramp; others count as its default, 2."""
    position_lost: frozenset[int] = frozenset()
    """Emergencies after which the position is no longer referenced."""
    contradiction: Callable[[ObjectStore, PowerState], int | None] = _no_contradiction
    """The emergency in which enabling ends in a state, for its settings contradict each other."""
    contradicts: Callable[[ObjectStore, int], bool] = lambda _store, _code: False
    """True if an emergency's settings still contradict each other."""
    absolute: Callable[[ObjectStore], bool] = _never
    """True if the position sensor reports a position, not steps."""

    @property
    def flags(self) -> int:
        """The watched flags of the axis."""
        return reduce(or_, (watch.flag for watch in self.watches), 0)


class StandingErrors:
    """Emergency codes of one drive since the last fault reset, in the order in which they came."""

    def __init__(self, store: ObjectStore, axis: ServoAxis, supervision: Supervision) -> None:
        self._store: Final = store
        self._axis: Final = axis
        self.supervision: Final = supervision
        self.watched: Final = supervision.flags
        """The watched flags of the axis."""
        self.codes: tuple[int, ...] = ()

    def clear(self) -> None:
        """Begin as after power-on, or after a fault reset."""
        self.codes = ()

    def note(self, code: int) -> None:
        """Let an error stand."""
        if code not in self.codes:
            self.codes = (*self.codes, code)

    def found(self, state: PowerState) -> tuple[int, ...]:
        """Return what the axis finds in this state and what does not stand yet."""
        flags = self._axis.flags
        if not flags & self.watched:
            return ()
        absolute = self.supervision.absolute(self._store)
        return tuple(
            code
            for watch in self.supervision.watches
            if flags & watch.flag
            and (code := watch.code_in(state, absolute=absolute)) not in self.codes
            # One cured by a node reset only stands: the same wires must not add another to it.
            and watch.measuring not in self.codes
        )

    def reaction_to(self, code: int) -> ErrorReaction:
        """Return how the drive reacts to an error, as table and 0x605E have it."""
        row = self.supervision.emergencies.get(code)
        if row is None or row.reaction is FaultReaction.DISABLE:
            return ErrorReaction.DISABLE
        if row.reaction is FaultReaction.NONE:
            return ErrorReaction.NONE
        option = self._store.get_or(od.FAULT_REACTION_OPTION, 2)
        return self.supervision.fault_options.get(option, ErrorReaction.QUICK_STOP)

    def cured_by_communication_reset(self) -> None:
        """Let go of the errors that only the network's reset cures."""
        self.codes = tuple(
            code for code in self.codes if self._recovery(code) is not Recovery.RESET_COMMUNICATION
        )

    @property
    def curable(self) -> bool:
        """True if a fault reset succeeds: no cause is present any more."""
        # A cause that still exists would be reported again within 1 ms: then the reset fails instead.
        if self._axis.flags & self.watched:
            return False
        return not any(
            self._recovery(code) is not Recovery.FAULT_RESET
            or self.supervision.contradicts(self._store, code)
            for code in self.codes
        )

    def _recovery(self, code: int) -> Recovery:
        row = self.supervision.emergencies.get(code)
        return Recovery.FAULT_RESET if row is None else row.recovery
