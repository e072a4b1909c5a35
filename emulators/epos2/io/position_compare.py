"""Position compare 0x207A: pulses at an output when the shaft passes positions.

Source: EPOS Firmware Specification (by analogy): bit 0 enables, bits 1 and 2 the mode, 3 and 4 on which side
of the reference the sequence lies, 5 and 6 the direction that counts. Where it is silent: of the sides and of
the directions 0 is the negative one, 1 the positive one, 2 both; the pulse width counts microseconds; in
single mode the reference alone counts, each time it is passed; the reference is part of a sequence.
"""

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.io.digital_outputs import DigitalOutputs
from emulators.servo.axis import ServoAxis
from emulators.servo.compare import DOWNWARDS, UPWARDS
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire.functions import OutputFunction

CONFIGURATION: Final = Address(0x207A, 1)
REFERENCE: Final = Address(0x207A, 2)
WIDTH: Final = Address(0x207A, 3)
REPETITIONS: Final = Address(0x207A, 4)
PULSE_WIDTH: Final = Address(0x207A, 5)
ENABLED: Final = 1 << 0
SEQUENCE: Final = 1
SIDES: Final = ((-1, 0), (0, 1), (-1, 1))
"""First and last interval of a sequence, in repetitions."""
DIRECTIONS: Final = (DOWNWARDS, UPWARDS, DOWNWARDS | UPWARDS)
MICROSECONDS: Final = 1000
"""Microseconds in one ms."""
_OUTPUT: Final = OutputFunction.POSITION_COMPARE.bit


class PositionCompare:
    """The compare function of one drive."""

    def __init__(self, store: ObjectStore, axis: ServoAxis, outputs: DigitalOutputs) -> None:
        self._store = store
        self._axis = axis
        self._outputs = outputs
        self._used = False
        """True once it has been enabled; until then the axis finds nothing."""
        for address in (CONFIGURATION, REFERENCE, WIDTH, REPETITIONS, PULSE_WIDTH):
            store.on_write(address, partial(self._take, address))

    def apply(self, changed: Mapping[Address, int] = MappingProxyType({})) -> None:
        """Describe the positions to the axis again; `changed` wins over what the store still has."""

        def value(address: Address) -> int:
            return changed[address] if address in changed else self._store.get(address)

        axis, word = self._axis, value(CONFIGURATION)
        mode, side, direction = word >> 1 & 3, word >> 3 & 3, word >> 5 & 3
        known = word & ENABLED and side < len(SIDES) and direction < len(DIRECTIONS)
        axis.compare_direction = DIRECTIONS[direction] if known else 0
        axis.compare_reference = value(REFERENCE)
        axis.compare_width = value(WIDTH) if mode == SEQUENCE else 0
        if known:
            self._used = True
            repetitions = value(REPETITIONS)
            axis.compare_first, axis.compare_last = (end * repetitions for end in SIDES[side])
        # Rounded up to whole ms: the plant sees the outputs no more often.
        axis.compare_pulse_ms = max(1, -(-value(PULSE_WIDTH) // MICROSECONDS))

    def refresh(self) -> None:
        """Show the output what the axis has found, where it has not been shown yet."""
        if not self._used:
            return
        active = self._axis.compare_left > 0
        if active != bool(self._outputs.active & _OUTPUT):
            self._outputs.show(OutputFunction.POSITION_COMPARE, active=active)

    def _take(self, address: Address, value: int) -> None:
        self.apply({address: value})
