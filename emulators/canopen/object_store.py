"""The object store of one device: every object's value behind the checks that a bus client meets.

Two doors: `read` and `write` for clients, with the table's access, size and range; `get` and `set` for the
device itself. It does not interpret values; the code that does installs a hook.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.object_dictionary import ObjectDictionary
from firmware_bridge.canopen.object_row import ObjectRow

LARGEST_DOMAIN: Final = 4096
"""Capacity of a domain in bytes (assumed: no limit is documented)."""


@dataclass(frozen=True, slots=True)
class Cell:
    """One object that holds a number, for those who come back often."""

    row: ObjectRow
    live: Callable[[], int]
    """The value as a client sees it now."""
    accept: Callable[[int], None]
    """Check and store a client's value: range, hooks, then the store."""


class ObjectStore:
    """All objects of one device."""

    def __init__(
        self,
        objects: ObjectDictionary,
        node_id: int = 1,
        differing: Mapping[Address, int | bytes] = MappingProxyType({}),
        bounds: Mapping[Address, tuple[int, int]] = MappingProxyType({}),
        hidden: Iterable[ObjectRow] = (),
    ) -> None:
        """Fill the store with the defaults of the device `node_id`; `differing` replaces some of them.

        `bounds` replaces the dictionary's range of some objects. `hidden` are numbers that the device works
        with, and that no client has; an object of the dictionary takes the place of one.
        """
        self.node_id = node_id
        self.objects: Final = objects
        self._differing = dict(differing)
        unknown = [str(address) for address in self._differing if address not in objects]
        if unknown:
            raise ValueError(f"no such object: {', '.join(unknown)}")
        own = {row.address: row.bounds for row in objects.values() if row.type.size}
        self._bounds = MappingProxyType({**own, **bounds})
        self.changes = 0
        """Number of times that the device itself has changed a number."""
        self.requested = False
        """True if the value being taken was written by a request, by SDO or serial, not in a PDO."""
        self._numbers: dict[Address, int] = {}
        self._texts: dict[Address, bytes] = {}
        self._sources: dict[Address, Callable[[], int]] = {}
        self._sinks: dict[Address, tuple[Callable[[int], None], ...]] = {}
        self._domains: dict[Address, Callable[[], bytes | None]] = {}
        self._hidden: Final = {row.address: row for row in hidden if row.address not in objects}
        for address in self._hidden:
            default = self.default(address)
            if isinstance(default, int):
                self._numbers[address] = default
        for row in objects.values():
            default = self.default(row.address)
            if isinstance(default, bytes):
                self._texts[row.address] = default
            else:
                self._numbers[row.address] = default

    # As a bus client

    def read(self, address: Address) -> bytes:
        """Return an object's bytes, low byte first; SdoAbort when it does not exist or is write-only."""
        row = self.row(address)
        if not row.access.readable:
            raise SdoAbort(AbortCode.WRITE_ONLY, address)
        kind = row.type
        if kind.size:
            return kind.encode(self.live(address))
        given = self._domains[address]() if address in self._domains else None
        return self._texts[address] if given is None else given

    def write(self, address: Address, raw: bytes) -> None:
        """Give an object a value; SdoAbort by existence, access, size, range, or a hook's objection."""
        kind = self.check_writable(address, len(raw)).type
        if not kind.size:
            self._texts[address] = bytes(raw)
            return
        # Reset even if a hook refuses: the next PDO must not count as a written controlword.
        self.requested = True
        try:
            self._accept(address, kind.decode(raw))
        finally:
            self.requested = False

    def check_writable(self, address: Address, size: int | None) -> ObjectRow:
        """Refuse a write to come, or return the object's row; `size` in bytes, None while it is not known."""
        row = self.row(address)
        if not row.access.writable:
            raise SdoAbort(AbortCode.READ_ONLY, address)
        wanted = row.type.size
        if size is None or size == wanted:
            return row
        if wanted == 0:
            if size > LARGEST_DOMAIN:
                raise SdoAbort(AbortCode.OUT_OF_MEMORY, address)
            return row
        raise SdoAbort(AbortCode.TOO_LONG if size > wanted else AbortCode.TOO_SHORT, address)

    def row(self, address: Address) -> ObjectRow:
        """Return an object's row; SdoAbort when there is none."""
        row = self.objects.get(address)
        if row is None:
            # CiA 301 distinguishes a missing sub-index (0x06090011) from a missing object (0x06020000).
            missing = AbortCode.NO_SUBINDEX if self.objects.subindexes(address.index) else AbortCode.NO_OBJECT
            raise SdoAbort(missing, address)
        return row

    # Inside the device

    def get(self, address: Address) -> int:
        """Return the stored value of a number, whatever its access."""
        return self._numbers[address]

    def get_or(self, address: Address, default: int) -> int:
        """Return the stored value of a number that a device may have or not; `default` without it."""
        return self._numbers.get(address, default)

    def set(self, address: Address, value: int) -> None:
        """Store a number without checks and hooks."""
        if self._numbers[address] != value:
            self._numbers[address] = value
            self.changes += 1

    def live(self, address: Address) -> int:
        """Return a number as a client would read it now."""
        source = self._sources.get(address)
        return self._numbers[address] if source is None else source()

    def cell(self, address: Address) -> Cell:
        """Return the cell of a number, for those who come back often."""
        return Cell(self.objects[address], partial(self.live, address), partial(self._accept, address))

    def on_read(self, address: Address, source: Callable[[], int]) -> None:
        """Let clients read what `source` gives; a number too large for the type wraps."""
        self._sources[address] = source

    def on_read_bytes(self, address: Address, source: Callable[[], bytes | None]) -> None:
        """Let clients read the bytes that `source` gives; where it gives None, what was written last."""
        self._domains[address] = source

    def on_write(self, address: Address, sink: Callable[[int], None]) -> None:
        """Show clients' values to `sink` after the checks, before they are stored; it may raise SdoAbort."""
        self._sinks[address] = (*self._sinks.get(address, ()), sink)

    def _accept(self, address: Address, value: int) -> None:
        low, high = self._bounds[address]
        if value < low:
            raise SdoAbort(AbortCode.TOO_LOW, address)
        if value > high:
            raise SdoAbort(AbortCode.TOO_HIGH, address)
        # Hooks before the store: one that refuses leaves the former value.
        for sink in self._sinks.get(address, ()):
            sink(value)
        self._numbers[address] = value

    # Defaults

    def default(self, address: Address) -> int | bytes:
        """Return an object's default in this device."""
        given = self._differing.get(address)
        if given is not None:
            return given
        return (self._hidden.get(address) or self.objects[address]).default_for(self.node_id)

    def numbers(self) -> Iterator[tuple[ObjectRow, int]]:
        """Give every object that holds a number, with its stored value, in the order of the addresses."""
        for address, value in self._numbers.items():
            if address in self.objects:
                yield self.objects[address], value

    def load_default(self, address: Address) -> None:
        """Bring a number back to its default without hooks."""
        default = self.default(address)
        if isinstance(default, int):
            self.set(address, default)
