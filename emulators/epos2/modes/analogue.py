"""Analog set-points of current, velocity and position mode: which input, and what its volts mean.

Source: maxon EDS (0x207B, 0x207D, 0x2301 to 0x2303). Where it is silent:
* a set-point is the input in V, times the scaling, times ten to the notation index, plus the offset;
* it takes the place of the set value 0x2030, 0x206B or 0x2062 while its bit of 0x207D is set;
* functions of the inputs in 0x207B are the bits of 0x207D, as digital inputs have them: 0 current,
  1 velocity, 2 position; of two inputs with one function the first counts, and without one the set value;
* notation indexes beyond -9 and 9 count as these.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.servo.axis import ServoAxis
from emulators.servo.setpoint import scaled
from firmware_bridge.canopen.address import Address

EXECUTION_MASK: Final = Address(0x207D)
FUNCTIONS: Final = (Address(0x207B, 1), Address(0x207B, 2))
MILLIVOLTS: Final = 1000
_WIDEST_NOTATION: Final = 9


@dataclass(frozen=True, slots=True)
class AnalogueSetpoint:
    """One of the three: its bit in 0x207D, which is its function in 0x207B, and its index."""

    function: int
    index: int

    @property
    def scaling(self) -> Address:
        """mA, rpm or qc for 1 V, before the notation."""
        return Address(self.index, 1)

    @property
    def offset(self) -> Address:
        """mA, rpm or qc at 0 V."""
        return Address(self.index, 2)

    @property
    def notation(self) -> Address:
        """Power of ten of the scaling."""
        return Address(self.index, 3)

    @property
    def value(self) -> Address:
        """Object with the present value."""
        return Address(self.index, 4)

    @property
    def shaped_by(self) -> tuple[Address, ...]:
        """Objects that a change of the set-point may come from."""
        return (self.scaling, self.offset, self.notation, EXECUTION_MASK, *FUNCTIONS)

    def load(self, axis: ServoAxis, get: Callable[[Address], int]) -> bool:
        """Give the axis the scaling, and the input where the set-point is switched on; say whether it is."""
        axis.analogue_numerator, axis.analogue_denominator = self._scale(get)
        axis.analogue_offset = get(self.offset)
        switched_on = get(EXECUTION_MASK) >> self.function & 1
        axis.analogue_input = self._input(get) if switched_on else 0
        return axis.analogue_input != 0

    def measured(self, axis: ServoAxis, store: ObjectStore) -> int:
        """Return what the set-point is now, at work or not; the offset where no input has its function."""
        millivolts = (0, axis.analogue_1_mv, axis.analogue_2_mv)[self._input(store.get)]
        value = scaled(millivolts, *self._scale(store.get), store.get(self.offset))
        wide = store.objects[self.value].type
        return max(wide.lowest, min(wide.highest, value))

    def _input(self, get: Callable[[Address], int]) -> int:
        return next((pin for pin, address in enumerate(FUNCTIONS, 1) if get(address) == self.function), 0)

    def _scale(self, get: Callable[[Address], int]) -> tuple[int, int]:
        # A fraction of two integers: a negative notation loses no digit, and no float is involved.
        places = max(-_WIDEST_NOTATION, min(_WIDEST_NOTATION, get(self.notation)))
        return get(self.scaling) * 10 ** max(0, places), MILLIVOLTS * 10 ** max(0, -places)


CURRENT_SETPOINT: Final = AnalogueSetpoint(0, 0x2301)
VELOCITY_SETPOINT: Final = AnalogueSetpoint(1, 0x2302)
POSITION_SETPOINT: Final = AnalogueSetpoint(2, 0x2303)
