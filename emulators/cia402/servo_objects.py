"""The servo's objects: positions in the units of 0x608F, 0x6091 and 0x6092 outside, in counts inside.

Source: CiA 402-2, position = counts * feed constant / (encoder resolution * gear ratio). A position that is
too large for its object wraps (assumed), as a count does.
"""

from collections.abc import Callable, Collection, Iterable, Mapping
from math import gcd
from types import MappingProxyType
from typing import Final

from emulators.canopen.object_store import ObjectStore
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.object_dictionary import ObjectDictionary
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.families.cia402.wire import address as at
from firmware_bridge.families.cia402.wire.objects import OFF

NUMERATOR: Final = (at.FEED, at.GEAR_SHAFT_TURNS, at.ENCODER_TURNS)
DENOMINATOR: Final = (at.FEED_TURNS, at.GEAR_MOTOR_TURNS, at.ENCODER_COUNTS)
POSITIONS: Final[Collection[Address]] = frozenset(
    {
        od.POSITION_DEMAND,
        od.POSITION_ACTUAL,
        od.MAX_FOLLOWING_ERROR,
        od.POSITION_WINDOW,
        od.TARGET_POSITION,
        od.HOME_OFFSET,
        od.MIN_POSITION_LIMIT,
        od.MAX_POSITION_LIMIT,
        at.POSITION_OFFSET,
        at.FOLLOWING_ERROR,
    }
)


class ServoObjects(ObjectStore):
    """An object store whose positions have a unit of their own for clients."""

    def __init__(
        self,
        objects: ObjectDictionary,
        node_id: int = 1,
        differing: Mapping[Address, int | bytes] = MappingProxyType({}),
        hidden: Iterable[ObjectRow] = (),
    ) -> None:
        """Fill the store; without all of the three objects a unit is a count."""
        super().__init__(objects, node_id, differing, hidden=hidden)
        self._scaled: Final = all(address in objects for address in at.FACTORS)

    def get(self, address: Address) -> int:
        """Return a number as the device uses it: a position in counts."""
        value = super().get(address)
        return self._counts(value) if address in POSITIONS else value

    def on_read(self, address: Address, source: Callable[[], int]) -> None:
        """Let clients read what `source` gives: a position from counts."""
        super().on_read(address, (lambda: self._units(source())) if address in POSITIONS else source)

    def on_write(self, address: Address, sink: Callable[[int], None]) -> None:
        """Show clients' values to `sink`: a position in counts."""
        super().on_write(address, (lambda value: sink(self._counts(value))) if address in POSITIONS else sink)

    def _ratio(self) -> tuple[int, int]:
        """Return units and counts of the same way."""
        if not self._scaled:
            return 1, 1
        units = counts = 1
        for address in NUMERATOR:
            units *= super().get(address)
        for address in DENOMINATOR:
            counts *= super().get(address)
        shared = gcd(units, counts)
        return units // shared, counts // shared

    def _counts(self, value: int) -> int:
        units, counts = self._ratio()
        return value if units == counts or value == OFF else (value * counts + units // 2) // units

    def _units(self, value: int) -> int:
        units, counts = self._ratio()
        return value if units == counts else (value * units + counts // 2) // counts
