"""The errors that stand since the last fault reset: what the axis finds, how to react, what may be reset.

The power sequence brings the motor to standstill.
"""

from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.option_codes import ErrorReaction
from emulators.epos2.control import enable_checks, supervision
from emulators.epos2.control.supervision import WATCHED
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at


class StandingErrors:
    """Emergency codes of one drive, in the order in which they came."""

    def __init__(self, store: ObjectStore, axis: ServoAxis) -> None:
        self._store: Final = store
        self._axis: Final = axis
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
        if not flags & WATCHED:
            return ()
        return tuple(supervision.findings(flags, state, self._store.get(at.SENSOR_TYPE), self.codes))

    def reaction_to(self, code: int) -> ErrorReaction:
        """Return how the drive reacts to an error, as table and 0x605E say."""
        return supervision.reaction_to(code, self._store.get(od.FAULT_REACTION_OPTION))

    def cured_by_communication_reset(self) -> None:
        """Let go of the errors that only the network's reset cures."""
        self.codes = supervision.left_by_communication_reset(self.codes)

    @property
    def curable(self) -> bool:
        """True if a fault reset succeeds: no cause is present any more."""
        # A cause that still exists would be reported again within 1 ms: then the reset fails instead.
        contradicted = any(enable_checks.stands(self._store, code) for code in self.codes)
        return supervision.curable(self.codes) and not contradicted and not self._axis.flags & WATCHED
