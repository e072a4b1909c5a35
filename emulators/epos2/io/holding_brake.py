"""The holding brake: released once the motor holds, closed before it lets go. Without a pin there is none.

Sources: EDS for the times 0x2100 and 0x2101. Assumed: the brake is released with Operation enabled, and
set-points wait for the rise time; on the way out the shaft comes to standstill (0x2101, for at most its
time-out), the brake closes, and power goes after the fall time; 0x2100:3 bounds all of that, but for its
largest value.
"""

from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.drive.brake import Brake
from emulators.epos2.io.digital_outputs import DigitalOutputs
from emulators.servo.axis import AT_REST, ServoAxis
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire.functions import OutputFunction
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

RISE_TIME: Final = Address(0x2100, 1)
FALL_TIME: Final = Address(0x2100, 2)
TIMEOUT: Final = Address(0x2100, 3)
STANDSTILL_TIMEOUT: Final = Address(0x2101, 3)
UNBOUNDED: Final = 0xFFFF


class HoldingBrake(Brake):
    """The brake on one output pin."""

    def __init__(self, store: ObjectStore, axis: ServoAxis, outputs: DigitalOutputs) -> None:
        super().__init__()
        self._store = store
        self._axis = axis
        self._outputs = outputs
        self._released = False
        self._begun: Nanoseconds = NEVER
        """Begin of the sequence to power off, in which the shaft is stopped first."""

    @property
    def fitted(self) -> bool:
        """True if an output pin is configured for a brake."""
        return self._outputs.has(OutputFunction.HOLDING_BRAKE)

    def release(self) -> bool:
        """Release the brake; say whether it takes time, until `due`."""
        # A closing that is under way is given up: the motor takes the load again.
        self._begun = NEVER
        if self._released or not self.fitted:
            return False
        self._show(released=True)
        self.due = self._after(self._axis.now, RISE_TIME)
        return self.due > self._axis.now

    def released(self) -> bool:
        """Return whether the brake is open, or there is none; then there is nothing to wait for."""
        if self.fitted and self._axis.now < self.due:
            return False
        self.due = NEVER
        return True

    def interrupt(self) -> None:
        """Wait for the brake no longer, whatever it does."""
        self.due = NEVER

    def close(self) -> None:
        """Close the brake at once: power is gone."""
        self._begun = self.due = NEVER
        self._show(released=False)

    def closes(self) -> bool:
        """Continue to close the brake, shaft at standstill first; return True if it holds or is absent."""
        if not self.fitted:
            return True
        if self._begun == NEVER:
            self._begun = self._axis.now
        now, begun = self._axis.now, self._begun
        bound = self._after(begun, TIMEOUT) if self._store.get(TIMEOUT) != UNBOUNDED else NEVER
        if self._released:
            # Bounded: a shaft that the load keeps turning would otherwise keep the power on.
            rest_by = min(self._after(begun, STANDSTILL_TIMEOUT), bound)
            if not self._axis.flags & AT_REST and now < rest_by:
                self.due = rest_by
                return False
            self._show(released=False)
            self.due = NEVER
        # Power stays until the fall time is over, or the load would drop before the brake has closed.
        if self.due == NEVER:
            self.due = min(self._after(now, FALL_TIME), bound)
        return self.due <= now

    def _after(self, begin: Nanoseconds, address: Address) -> Nanoseconds:
        return begin + self._store.get(address) * MILLISECOND

    def _show(self, *, released: bool) -> None:
        self._released = released
        self._outputs.show(OutputFunction.HOLDING_BRAKE, active=released)
