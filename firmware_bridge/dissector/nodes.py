"""The nodes on a bus, by the writes to them: their PDOs, and the decoding of values."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.drive_words import BY_MODE
from firmware_bridge.canopen.pdo import (
    MAX_ENTRIES,
    RECEIVE_MAPPING,
    RECEIVE_PARAMETER,
    TRANSMIT_MAPPING,
    TRANSMIT_PARAMETER,
    MappingEntry,
)
from firmware_bridge.dissector.dictionary import Dictionary

_SAVE: Final = Address(0x1010, 1)
_IN_BITS: Final = frozenset({od.CONTROLWORD, od.STATUSWORD, od.ERROR_REGISTER})
"""Objects whose value is written in hexadecimal digits, beside COB-IDs and mappings."""
_KEPT: Final = 4096
"""So many values are kept decoded."""
PDO_OBJECTS: Final = range(RECEIVE_PARAMETER, TRANSMIT_MAPPING + 0x200)


def _in_bits(address: Address) -> bool:
    if address.index not in PDO_OBJECTS:
        return address in _IN_BITS
    mapping = address.index & 0x200
    return address.subindex in (range(1, MAX_ENTRIES + 1) if mapping else (1,))


@dataclass(frozen=True, slots=True)
class Place:
    """An object in the bytes of a PDO."""

    address: Address
    begin: int
    end: int


class Nodes:
    """The nodes of one bus."""

    def __init__(self, dictionary: Dictionary, sheet: Mapping[Address, int]) -> None:
        """Take the dictionary of nodes of an unknown maker; defaults of a data sheet win over it."""
        self._unknown = dictionary
        self._dictionaries: dict[int, Dictionary] = {}
        self._sheet = sheet
        self._written: dict[int, dict[Address, int]] = {}
        """The writes to each node, as far as they matter for reading."""
        self._saved: dict[int, dict[Address, int]] = {}
        # Most frames are PDOs, and their settings rarely change: found once, until something is written.
        self.version = 0
        """Changes with everything that changes how a frame is read."""
        self._found: dict[int, tuple[tuple[int, str, int], ...]] = {}
        self._mappings: dict[tuple[int, int], tuple[int, tuple[Place, ...]]] = {}
        # Of the values that a bus carries most are those of the cycle before.
        self._values: dict[tuple[int, Address, bytes], str] = {}

    @property
    def known(self) -> tuple[int, ...]:
        """Return the numbers of the nodes of which something is known."""
        return tuple(self._written)

    def of(self, node: int) -> Dictionary:
        """Return the dictionary by which a node is read."""
        return self._dictionaries.get(node, self._unknown)

    def called(self, node: int, address: Address) -> str:
        """Return an object's index, sub-index and name."""
        return self.of(node).rows.called(address)

    def is_of(self, node: int, dictionary: Dictionary) -> None:
        """Read a node by this dictionary from now on."""
        self._dictionaries[node] = dictionary
        self._look_again()

    def identified(self, node: int) -> bool:
        """Return whether a node's maker is known, and with him its default mapping."""
        return node in self._dictionaries and self._dictionaries[node].vendor is not None

    def note(self, node: int, address: Address, raw: bytes) -> None:
        """Take note of what is written to a node."""
        if node not in self._written:
            self._look_again()
        written = self._written.setdefault(node, {})
        # 0x1010: what was written until now survives a reset (CiA 301).
        if address == _SAVE:
            self._saved[node] = dict(written)
        row = self.of(node).rows.get(address)
        if row is not None and row.type.size:
            written[address] = row.type.decode(raw[: row.type.size])
            # The mode gives the bits of other objects their meaning.
            if address.index in PDO_OBJECTS or address == od.MODE:
                self._look_again()

    def expect(self, node: int, written: Iterable[tuple[Address, bytes]]) -> None:
        """Take a node for set up like this from the start, and after each restart."""
        for address, raw in written:
            self.note(node, address, raw)
        self._saved[node] = dict(self._written.get(node, {}))

    def mapped(self, node: int, mapping: int) -> bool:
        """Return whether a PDO's mapping was written, so that it need not be taken for the default."""
        written = self._written.get(node, {})
        return any(Address(mapping, place) in written for place in range(MAX_ENTRIES + 1))

    def stated(self, node: int, mapping: int) -> bool:
        """Return whether all of a PDO's mapping was written, read, or given by a data sheet."""
        written = self._written.get(node, {})
        entries = range(min(self.entry(node, mapping, 0), MAX_ENTRIES) + 1)
        known = (Address(mapping, place) for place in entries)
        return all(one in written or one in self._sheet for one in known)

    def forget(self, node: int) -> None:
        """Know of a node that restarts only what it has saved."""
        self._written[node] = dict(self._saved.get(node, {}))
        self._look_again()

    def entry(self, node: int, index: int, subindex: int) -> int:
        """Return a number in a node's dictionary: what was written, or its default."""
        address = Address(index, subindex)
        value = self._written.get(node, {}).get(address, self._sheet.get(address))
        if value is not None:
            return value
        row = self.of(node).rows.get(address)
        default = 0 if row is None else row.default_for(node)
        return default if isinstance(default, int) else 0

    def value(self, node: int, address: Address, raw: bytes) -> str:
        """Return an object's value for people, with its unit and what its bits say."""
        key = (node, address, raw)
        text = self._values.get(key)
        if text is None:
            if len(self._values) >= _KEPT:
                self._values.clear()
            text = self._values[key] = self._value(node, address, raw)
        return text

    def _value(self, node: int, address: Address, raw: bytes) -> str:
        read = self.of(node)
        row = read.rows.get(address)
        if row is not None and 0 < row.type.size < len(raw):
            raw = raw[: row.type.size]  # a client that gives no size sends four bytes
        value = read.rows.decoded(address, raw)
        mode = None
        if address in BY_MODE:
            mode = read.words.mode_of(self._written.get(node, {}).get(od.MODE, 0))
        text = read.words.words(address, value, mode)
        in_bits = isinstance(value, int) and _in_bits(address)
        number = f"0x{value:0{2 * len(raw)}X}" if in_bits else f"{value}"
        unit = "" if row is None else row.unit
        return number + (f" {unit}" if unit else "") + (f" ({', '.join(text)})" if text else "")

    def candidates(self, number: int) -> tuple[tuple[int, str, int], ...]:
        """Return node, title and index of the mapping of each PDO that has this identifier now."""
        found = self._found.get(number)
        if found is None:
            found = self._found[number] = tuple(self._candidates(number))
        return found

    def _look_again(self) -> None:
        self.version += 1
        self._found.clear()
        self._mappings.clear()
        self._values.clear()

    def _candidates(self, number: int) -> Iterator[tuple[int, str, int]]:
        predefined = number & cia301.NODE_MASK
        # Nodes that were written to may use any identifier, so they come first.
        for node in dict.fromkeys((*self._written, predefined)):
            if not node:
                continue
            for place in range(self.of(node).pdos):
                for kind, parameter, mapping in (
                    ("RPDO", RECEIVE_PARAMETER, RECEIVE_MAPPING),
                    ("TPDO", TRANSMIT_PARAMETER, TRANSMIT_MAPPING),
                ):
                    entry = self.entry(node, parameter + place, 1)
                    if entry & cia301.COB_ID_MASK == number:
                        yield node, f"{kind} {place + 1}, node {node}", mapping + place

    def contents(self, node: int, mapping: int, payload: bytes) -> list[tuple[Address, bytes]]:
        """Return each mapped object with its bytes; none where the bytes are not those of the mapping."""
        bits, places = self.places(node, mapping)
        # Decoded by a wrong mapping the values would look plausible.
        if bits != 8 * len(payload):
            return []
        return [(place.address, payload[place.begin : place.end]) for place in places]

    def places(self, node: int, mapping: int) -> tuple[int, tuple[Place, ...]]:
        """Return the bits of a mapping, and where its objects are."""
        found = self._mappings.get((node, mapping))
        if found is None:
            found = self._mappings[node, mapping] = self._places(node, mapping)
        return found

    def _places(self, node: int, mapping: int) -> tuple[int, tuple[Place, ...]]:
        count = min(self.entry(node, mapping, 0), MAX_ENTRIES)
        places, bits, begin = list[Place](), 0, 0
        for number in range(count):
            entry = MappingEntry.decode(self.entry(node, mapping, number + 1))
            end = begin + entry.bits // 8
            places.append(Place(entry.address, begin, end))
            bits, begin = bits + entry.bits, end
        return bits, tuple(places)

    def fields(self, node: int, mapping: int, payload: bytes) -> list[str]:
        """Return name and value of each mapped object; none where the bytes are not those of the mapping."""
        found = self.contents(node, mapping, payload)
        return [f"{self.called(node, address)} = {self.value(node, address, raw)}" for address, raw in found]
