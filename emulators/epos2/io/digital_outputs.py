"""The digital outputs: what the functions of the drive and the master's bits make of the pins.

Sources: EPOS Firmware Specification, digital outputs (by analogy). A master's write changes only the general
purpose bits that the mask lets through. The polarity turns a pin's sense round. Assumed: "ready" is active
while there is no fault; "holding brake" is active while the brake is released, for that takes current.
"""

from emulators.canopen.object_store import ObjectStore
from emulators.servo.axis import ServoAxis
from emulators.servo.pins import BRAKE_CLOSED
from firmware_bridge.families.epos2.wire.functions import (
    GENERAL_OUTPUTS,
    OUTPUT_MASK,
    OUTPUT_PINS,
    OUTPUT_POLARITY,
    OUTPUT_STATE,
    OutputFunction,
)


class DigitalOutputs:
    """The output pins of one drive. Masks are those of 0x2078: bit n is function n."""

    def __init__(self, store: ObjectStore, axis: ServoAxis) -> None:
        self._store = store
        self._axis = axis
        self.active = 0
        """Functions that are active."""
        self._stale = True
        for address in (*OUTPUT_PINS, OUTPUT_POLARITY):
            store.on_write(address, self._note)
        store.on_write(OUTPUT_STATE, self._take)
        store.on_read(OUTPUT_STATE, lambda: self.active)

    def _note(self, _value: int) -> None:
        self._stale = True

    def _take(self, value: int) -> None:
        writable = GENERAL_OUTPUTS & self._store.get(OUTPUT_MASK)
        self._become(self.active & ~writable | value & writable)

    def show(self, function: OutputFunction, *, active: bool) -> None:
        """Let a function of the drive be active or not."""
        self._become(self.active | function.bit if active else self.active & ~function.bit)

    def has(self, function: OutputFunction) -> bool:
        """Return whether a pin has this function."""
        return any(self._store.get(address) == function for address in OUTPUT_PINS)

    def _become(self, active: int) -> None:
        if active != self.active:
            self.active = active
            self._stale = True

    def reset(self) -> None:
        """Begin as after power-on: nothing is active."""
        self.active = 0
        self._stale = True
        self.refresh()

    def refresh(self) -> None:
        """Give the pins their levels."""
        if not self._stale:
            return
        self._stale = False
        levels = self.active ^ self._store.get(OUTPUT_POLARITY)
        outputs = 0
        for pin, address in enumerate(OUTPUT_PINS):
            outputs |= (levels >> self._store.get(address) & 1) << pin
        # The plant's brake follows the function, not the level: the polarity describes the wiring to it.
        released = self.active & OutputFunction.HOLDING_BRAKE.bit
        if self.has(OutputFunction.HOLDING_BRAKE) and not released:
            outputs |= BRAKE_CLOSED
        self._axis.outputs = outputs
