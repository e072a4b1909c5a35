"""The bus as its frames have set it up: which PDO an identifier is, and the objects that it carries.

Mappings and texts are those of the dissector; this keeps the decoding of PDOs, which are most of the frames.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, TypeAlias

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.drive_words import DriveWords
from firmware_bridge.canopen.pdo import (
    MAX_ENTRIES,
    RECEIVE_MAPPING,
    RECEIVE_PARAMETER,
    TRANSMIT_MAPPING,
    TRANSMIT_PARAMETER,
    MappingEntry,
)
from firmware_bridge.dissector.canopen import Canopen
from firmware_bridge.dissector.expected import Expected
from firmware_bridge.explain.incident import Evidence
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.recording import candump_frame
from firmware_bridge.units import Nanoseconds

Objects: TypeAlias = tuple[tuple[Address, int], ...]
KEPT: Final = 4096
"""So many payloads of a PDO are kept decoded."""


@dataclass(frozen=True, slots=True)
class Field:
    """One object in a PDO."""

    address: Address
    begin: int
    end: int
    signed: bool


@dataclass(slots=True)
class Pdo:
    """One PDO of one node, as it is set up now."""

    node: int
    number: int
    """From 1."""
    transmit: bool
    known: bool
    """Whether its mapping is known; without it the bytes are none of our business."""
    invalid: bool
    """Bit 31 of its COB-ID: it is switched off."""
    transmission: int
    size: int
    """Of its mapping, in bytes."""
    fields: tuple[Field, ...]
    decoded: dict[bytes, Objects] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """The PDO, for people."""
        return f"{'TPDO' if self.transmit else 'RPDO'} {self.number}"

    @property
    def parameter(self) -> Address:
        """The object with its COB-ID."""
        base = TRANSMIT_PARAMETER if self.transmit else RECEIVE_PARAMETER
        return Address(base + self.number - 1, 1)

    def objects(self, payload: bytes) -> Objects:
        """Return the objects in a payload; none where it has another length than the mapping."""
        found = self.decoded.get(payload)
        if found is None:
            found = self._decode(payload)
            if len(self.decoded) < KEPT:
                self.decoded[payload] = found
        return found

    def _decode(self, payload: bytes) -> Objects:
        # CiA 301: of a longer one the bytes beyond the mapping are ignored by the receiver.
        if len(payload) < self.size or not self.known:
            return ()
        return tuple(
            (one.address, int.from_bytes(payload[one.begin : one.end], "little", signed=one.signed))
            for one in self.fields
        )


class FollowedBus(Canopen):
    """A dissector whose picture of the nodes can be used beyond texts."""

    def __init__(
        self,
        device: str = "",
        *,
        sheet: Mapping[Address, int] | None = None,
        expected: tuple[Expected, ...] = (),
    ) -> None:
        """Take the drives of a robot; all others by a data sheet, or as of the family `device`."""
        super().__init__(device, defaults=bool(device), sheet=sheet)
        self._pdos: dict[int, tuple[Pdo, ...]] = {}
        for one in expected:
            self.expect(one.node, one.written, one.dictionary)

    def pdos(self, number: int) -> tuple[Pdo, ...]:
        """Return the PDOs with an identifier: of one sender, or of all receivers."""
        found = self._pdos.get(number)
        if found is None:
            found = self._pdos[number] = self._found(number)
        return found

    def changed(self) -> None:
        """Look the PDOs up again: one was set up, or a node has started."""
        self._pdos.clear()

    def words(self, node: int) -> DriveWords:
        """Return what the bits of a node's values stand for."""
        return self._nodes.of(node).words

    def type_of(self, node: int, address: Address) -> tuple[int, bool]:
        """Return size and sign of an object; size 0 where they are not known."""
        row = self._nodes.of(node).rows.get(address)
        return (0, False) if row is None else (row.type.size, row.type.signed)

    def called(self, node: int, address: Address) -> str:
        """Return an object's index, sub-index and name."""
        return self._nodes.called(node, address)

    def evidence(self, at: Nanoseconds, address: int, payload: bytes) -> Evidence:
        """Return a frame with its text."""
        return Evidence(at, frame_text(address, payload), self.read("", Packet(CAN, address, payload)))

    def _found(self, number: int) -> tuple[Pdo, ...]:
        rows = [self._pdo_of(node, mapping) for node, _, mapping in self._nodes.candidates(number)]
        known = set(self._nodes.known)
        # The predefined set counts for nodes of which nothing was seen, and only where no other has it.
        rows = [row for row in rows if row.node in known] or rows[:1]
        valid = [row for row in rows if not row.invalid] or rows
        sender = [row for row in valid if row.transmit][:1]
        return (*sender, *(row for row in valid if not row.transmit))

    def _pdo_of(self, node: int, mapping: int) -> Pdo:
        transmit = mapping >= TRANSMIT_MAPPING
        place = mapping - (TRANSMIT_MAPPING if transmit else RECEIVE_MAPPING)
        parameter = (TRANSMIT_PARAMETER if transmit else RECEIVE_PARAMETER) + place
        fields, begin = [], 0
        for one in range(min(self._nodes.entry(node, mapping, 0), MAX_ENTRIES)):
            entry = MappingEntry.decode(self._nodes.entry(node, mapping, one + 1))
            end = begin + entry.bits // 8
            fields.append(Field(entry.address, begin, end, self.type_of(node, entry.address)[1]))
            begin = end
        cob_id = self._nodes.entry(node, parameter, 1)
        return Pdo(
            node=node,
            number=place + 1,
            transmit=transmit,
            known=self._known(node, mapping),
            invalid=bool(cob_id & cia301.COB_ID_INVALID),
            transmission=self._nodes.entry(node, parameter, 2),
            size=begin,
            fields=tuple(fields),
        )


def frame_text(address: int, payload: bytes) -> str:
    """Return a frame as candump writes it."""
    return candump_frame(Packet(CAN, address, payload))
