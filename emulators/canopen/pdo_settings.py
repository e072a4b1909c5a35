"""The objects that shape one PDO, and what may be written to them when.

Source: CiA 301 v4.02: a mapping changes only in Pre-Operational, with the PDO invalid and the number of
entries 0; entries have the mapped object's own length; COB-IDs 0x181 to 0x57F. Where it is silent: COB-ID,
transmission type and times may change in any state that has SDO; a valid PDO or a number of entries
that is not 0 refuses a new entry with 0x06010000.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

from emulators.canopen.object_store import Cell, ObjectStore
from emulators.canopen.product import Product
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import COB_ID_INVALID, COB_ID_MASK, COB_ID_NO_REMOTE, NmtState
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.canopen.pdo import (
    MAX_BITS,
    MOST_PDOS,
    RECEIVE_MAPPING,
    RECEIVE_PARAMETER,
    TRANSMIT_MAPPING,
    TRANSMIT_PARAMETER,
    Layout,
    MappingEntry,
)
from firmware_bridge.units import MICROSECOND, MILLISECOND, Nanoseconds

FIRST_COB_ID: Final = 0x181
LAST_COB_ID: Final = 0x57F
INHIBIT_UNIT: Final[Nanoseconds] = 100 * MICROSECOND


@dataclass(frozen=True, slots=True)
class PdoDirection:
    """Common properties of the PDOs of one direction."""

    parameter: int
    """First index of the communication parameters."""
    mapping: int
    """First index of the mappings."""
    carries: Callable[[ObjectRow], bool]
    types: Callable[[Product], frozenset[int]]

    def numbers(self, store: ObjectStore) -> tuple[int, ...]:
        """Return the PDOs that a device has, counted from 0."""
        first = self.parameter
        return tuple(it - first for it in store.objects.indexes if first <= it < first + MOST_PDOS)


RECEIVE: Final = PdoDirection(
    RECEIVE_PARAMETER, RECEIVE_MAPPING, lambda row: row.receivable, lambda product: product.receive_types
)
TRANSMIT: Final = PdoDirection(
    TRANSMIT_PARAMETER,
    TRANSMIT_MAPPING,
    lambda row: row.transmittable,
    lambda product: product.transmit_types,
)


class PdoSettings:
    """One PDO's communication and mapping objects."""

    def __init__(
        self,
        store: ObjectStore,
        direction: PdoDirection,
        number: int,
        product: Product,
        *,
        state: Callable[[], NmtState],
        touched: Callable[[], None],
    ) -> None:
        """Attach to the store; `number` counts from 0; `touched` is called before each change."""
        self._store = store
        self._direction = direction
        self._state = state
        self._touched = touched
        self._types = direction.types(product)
        self._needs_invalid = product.mapping_needs_invalid_pdo
        self._wrong_nmt_state = product.wrong_nmt_state
        self._cob_id = Address(direction.parameter + number, 1)
        self._type = Address(direction.parameter + number, 2)
        self._count = Address(direction.mapping + number, 0)
        self._entries = store.objects.entries(direction.mapping + number)
        store.on_write(self._cob_id, self._take_cob_id)
        store.on_write(self._type, self._take_type)
        store.on_write(self._count, self._take_count)
        for address in self._entries:
            store.on_write(address, partial(self._take_entry, address))
        self._times = {
            address: unit
            for address, unit in (
                (Address(direction.parameter + number, 3), INHIBIT_UNIT),
                (Address(direction.parameter + number, 5), MILLISECOND),
            )
            if address in store.objects
        }
        for address in self._times:
            store.on_write(address, lambda _: touched())

    # What the PDO is at present

    @property
    def valid(self) -> bool:
        """True if the PDO exists on the bus."""
        return not self._store.get(self._cob_id) & COB_ID_INVALID

    @property
    def cob_id(self) -> int:
        """The 11-bit identifier."""
        return self._store.get(self._cob_id) & COB_ID_MASK

    @property
    def answers_remote(self) -> bool:
        """True if a remote request is answered."""
        return not self._store.get(self._cob_id) & COB_ID_NO_REMOTE

    @property
    def transmission(self) -> int:
        """The transmission type."""
        return self._store.get(self._type)

    @property
    def inhibit(self) -> Nanoseconds:
        """The least time between two messages."""
        return self._time(3)

    @property
    def event_timer(self) -> Nanoseconds:
        """The time after which a transmit PDO is sent again, and a receive PDO is missed; 0 for never."""
        return self._time(5)

    def _time(self, subindex: int) -> Nanoseconds:
        address = Address(self._type.index, subindex)
        return self._store.get(address) * self._times[address] if address in self._times else 0

    def cells(self) -> tuple[Cell, ...]:
        """Return the mapped objects in their order."""
        words = (self._store.get(address) for address in self._entries[: self._store.get(self._count)])
        return tuple(self._store.cell(MappingEntry.decode(word).address) for word in words)

    def layout(self) -> Layout:
        """Return the layout of the mapped objects."""
        return Layout(*((cell.row.address, cell.row.type) for cell in self.cells()))

    # What may be written

    def _take_cob_id(self, word: int) -> None:
        number = word & ~(COB_ID_INVALID | COB_ID_NO_REMOTE)
        # COB-ID 0 is accepted together with bit 31 only.
        absent = number == 0 and word & COB_ID_INVALID
        if not absent and not FIRST_COB_ID <= number <= LAST_COB_ID:
            raise SdoAbort(AbortCode.RANGE, self._cob_id)
        self._touched()

    def _take_type(self, transmission: int) -> None:
        if transmission not in self._types:
            raise SdoAbort(AbortCode.RANGE, self._type)
        self._touched()

    def _check_mappable(self, address: Address) -> None:
        if self._state() is not NmtState.PRE_OPERATIONAL:
            raise SdoAbort(self._wrong_nmt_state, address)
        if self._needs_invalid and self.valid:
            raise SdoAbort(AbortCode.UNSUPPORTED_ACCESS, address)

    def _take_entry(self, address: Address, word: int) -> None:
        self._check_mappable(address)
        if self._store.get(self._count):
            raise SdoAbort(AbortCode.UNSUPPORTED_ACCESS, address)
        # 0 empties a place of the mapping.
        if word and not self._carries(word):
            raise SdoAbort(AbortCode.NOT_MAPPABLE, address)
        self._touched()

    def _take_count(self, count: int) -> None:
        self._check_mappable(self._count)
        # The sum is judged here: entries may be written in any order while the count is 0.
        words = [self._store.get(address) for address in self._entries[:count]]
        if not all(self._carries(word) for word in words):
            raise SdoAbort(AbortCode.NOT_MAPPABLE, self._count)
        if sum(MappingEntry.decode(word).bits for word in words) > MAX_BITS:
            raise SdoAbort(AbortCode.PDO_LENGTH, self._count)
        self._touched()

    def _carries(self, word: int) -> bool:
        entry = MappingEntry.decode(word)
        row = self._store.objects.get(entry.address)
        return row is not None and self._direction.carries(row) and entry.bits == row.type.bits
