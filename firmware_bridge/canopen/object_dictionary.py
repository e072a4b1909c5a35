"""The object dictionary of a device type as a value: every object's row by its address."""

from collections.abc import Iterable, Iterator, KeysView, Mapping
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.object_row import ObjectRow


class ObjectDictionary(Mapping[Address, ObjectRow]):
    """Rows by address, in the order of the addresses; the values are in a device's store."""

    __slots__ = ("_rows", "_subindexes")

    def __init__(self, rows: Iterable[ObjectRow]) -> None:
        """Sort the rows; of two with one address the later counts."""
        found = {row.address: row for row in rows}
        self._rows: Final = {address: found[address] for address in sorted(found)}
        subindexes: dict[int, tuple[int, ...]] = {}
        for address in self._rows:
            subindexes[address.index] = (*subindexes.get(address.index, ()), address.subindex)
        self._subindexes: Final[Mapping[int, tuple[int, ...]]] = subindexes

    def __getitem__(self, address: Address) -> ObjectRow:
        return self._rows[address]

    def __iter__(self) -> Iterator[Address]:
        return iter(self._rows)

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def indexes(self) -> KeysView[int]:
        """Every index that has at least one object, ascending."""
        return self._subindexes.keys()

    def subindexes(self, index: int) -> tuple[int, ...]:
        """Return the sub-indexes of an index, ascending; none where it does not exist."""
        return self._subindexes.get(index, ())

    def entries(self, index: int) -> tuple[Address, ...]:
        """Return the addresses of a record or an array without sub-index 0, which counts them (CiA 301)."""
        return tuple(Address(index, subindex) for subindex in self.subindexes(index) if subindex)

    # For people

    def called(self, address: Address) -> str:
        """Return index, sub-index and name of an object, which need not be in the table."""
        row = self.get(address)
        return f"{address} {'' if row is None else row.name}".rstrip()

    def decoded(self, address: Address, raw: bytes) -> int | str:
        """Return what was read: a number, text, or bytes in hexadecimal where its type is not known."""
        row = self.get(address)
        if row is not None and row.type is DataType.VISIBLE_STRING:
            return raw.decode("ascii", errors="replace").rstrip("\0")
        if row is None or row.type.size != len(raw) or not raw:
            return raw.hex(" ").upper()
        return row.type.decode(raw)

    def unit_of(self, address: Address) -> str:
        """Return an object's unit; empty where it has none."""
        row = self.get(address)
        return "" if row is None else row.unit
