"""The position marker 0x2074: keeps where the shaft was when an edge came at the marker's input.

Source: EPOS Firmware Specification (by analogy): edge types, modes. Where it is silent: the pins are seen
once in each ms, and the position is the one of that ms; the marker heeds its bit in the execution mask; the
history holds the positions before the captured one; writing 0 to the counter arms the marker again and keeps
them, any other number is refused.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.io.digital_inputs import DigitalInputs
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire.functions import INPUT_EXECUTION, InputFunction

CAPTURED: Final = Address(0x2074, 1)
EDGE_TYPE: Final = Address(0x2074, 2)
MODE: Final = Address(0x2074, 3)
COUNTER: Final = Address(0x2074, 4)
HISTORY: Final = (Address(0x2074, 5), Address(0x2074, 6))
BOTH_EDGES: Final = 0
RISING: Final = 1
FALLING: Final = 2
MOST: Final[Mapping[int, int]] = MappingProxyType({1: 1, 2: 3})
"""Number of edges that count in the modes single and multiple; in the other one, continuous, all do."""
_INPUT: Final = InputFunction.POSITION_MARKER.bit


class PositionMarker:
    """The marker of one drive."""

    def __init__(self, store: ObjectStore, axis: ServoAxis, inputs: DigitalInputs) -> None:
        self._store = store
        self._axis = axis
        self._inputs = inputs
        self._before = 0
        store.on_write(COUNTER, self._arm)

    def reset(self) -> None:
        """Begin as after power-on."""
        self._before = self._inputs.active & _INPUT
        for address in (CAPTURED, COUNTER, *HISTORY):
            self._store.set(address, 0)

    def refresh(self) -> None:
        """Heed an edge that the inputs have shown since the last refresh."""
        active = self._inputs.active & _INPUT
        if active == self._before:
            return
        self._before = active
        store = self._store
        wanted = store.get(EDGE_TYPE)
        counts = wanted in (BOTH_EDGES, RISING if active else FALLING)
        executed = store.get(INPUT_EXECUTION) & _INPUT
        # Continuous mode has no last edge: a 16-bit counter stays below 2^16.
        if counts and executed and store.get(COUNTER) < MOST.get(store.get(MODE), 1 << 16):
            self._capture()

    def _capture(self) -> None:
        store = self._store
        older = [store.get(address) for address in (CAPTURED, *HISTORY[:-1])]
        for address, value in zip((CAPTURED, *HISTORY), (self._axis.position, *older), strict=True):
            store.set(address, value)
        store.set(COUNTER, store.get(COUNTER) + 1 & 0xFFFF)

    def _arm(self, value: int) -> None:
        if value != 0:
            raise SdoAbort(AbortCode.RANGE, COUNTER)
