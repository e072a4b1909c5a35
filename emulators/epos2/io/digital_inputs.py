"""The digital inputs: functions that are active, those that count, and the motions that they forbid.

Sources: EPOS Firmware Specification, digital inputs (by analogy). A pin has one function (0x2070); the
polarity turns its sense round. The mask filters what a client reads; the execution mask selects the functions
that act by themselves. Assumed: two pins of one function act as if wired together.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.drive.inputs import DriveInputs
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen.cia402 import ControlwordCommand
from firmware_bridge.families.epos2.wire import emergency
from firmware_bridge.families.epos2.wire.functions import (
    INPUT_EXECUTION,
    INPUT_MASK,
    INPUT_PINS,
    INPUT_POLARITY,
    INPUT_STATE,
    InputFunction,
)

LIMITS: Final[Mapping[int, tuple[int, int]]] = MappingProxyType(
    {
        InputFunction.NEGATIVE_LIMIT: (-1, emergency.NEGATIVE_LIMIT),
        InputFunction.POSITIVE_LIMIT: (1, emergency.POSITIVE_LIMIT),
    }
)
"""The limit switches: the direction that each of them ends, and the emergency that it is."""
LIMIT_BITS: Final = sum(1 << function for function in LIMITS)
WATCHED: Final = range(6)
"""Functions whose edges wake the drive; a general purpose input is looked at on request."""


class DigitalInputs(DriveInputs):
    """The input pins of one drive, by their functions. Masks are those of 0x2071: bit n is function n."""

    def __init__(self, store: ObjectStore, axis: ServoAxis) -> None:
        super().__init__()
        self._store = store
        self._axis = axis
        self._pins = 0
        self._stale = True
        """An object has changed since the last refresh."""
        for address in (*INPUT_PINS, INPUT_POLARITY, INPUT_EXECUTION):
            store.on_write(address, self._note)
        store.on_read(INPUT_STATE, self._shown)

    def _note(self, _value: int) -> None:
        self._stale = True

    def reset(self) -> None:
        """Begin as after power-on."""
        self._stale = True
        self.executed = 0
        self.refresh()

    def refresh(self) -> None:
        """Take in the pins as the axis has sampled them last."""
        axis = self._axis
        self.risen = 0
        if axis.pins == self._pins and not self._stale:
            return
        if self._stale:
            self._stale = False
            functions = [self._store.get(address) for address in INPUT_PINS]
            # A set: two pins with one function are one bit.
            self.fitted = sum({1 << function for function in functions})
            axis.pins_watched = sum(1 << pin for pin, function in enumerate(functions) if function in WATCHED)
        self._pins = axis.pins
        self.active = self._now_active()
        execution = self._store.get(INPUT_EXECUTION)
        before, self.executed = self.executed, self.active & execution
        self.risen = self.executed & ~before
        self.restriction = self._restricts(execution)

    def _now_active(self) -> int:
        closed = fitted = 0
        for pin, address in enumerate(INPUT_PINS):
            bit = 1 << self._store.get(address)
            fitted |= bit
            if self._axis.pins >> pin & 1:
                closed |= bit
        # The mask comes last: an inverted function without a pin would else be active for ever.
        return (closed ^ self._store.get(INPUT_POLARITY)) & fitted

    def _shown(self) -> int:
        return self._now_active() & self._store.get(INPUT_MASK)

    def _restricts(self, execution: int) -> ControlwordCommand | None:
        # Device enable acts by its absence: a broken wire disables the drive.
        if execution & self.fitted & ~self.active & InputFunction.DEVICE_ENABLE.bit:
            return ControlwordCommand.DISABLE_VOLTAGE
        # Disable above wins: it removes the power, and a quick stop keeps it.
        if self.executed & InputFunction.QUICK_STOP.bit:
            return ControlwordCommand.QUICK_STOP
        return None

    def limits_met(self, heading: int, sought: int) -> tuple[int, ...]:
        """Return the emergencies of the limit switches that have just been met, or are headed into.

        Assumed: a switch that is still closed lets the shaft out again, and keeps it from going further in;
        without power none is met.
        """
        if not self.executed & LIMIT_BITS:
            return ()
        return tuple(
            code
            for function, (direction, code) in LIMITS.items()
            if self.executed & ~sought & 1 << function
            and (self.risen & 1 << function or heading == direction)
        )
