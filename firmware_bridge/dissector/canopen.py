"""CANopen frames in words: network management, SYNC, emergencies, PDOs, SDOs, error control, LSS.

Identifiers are those of the predefined connection set (CiA 301 v4.02, section 9.3.5), and the PDOs' own as
far as somebody was seen to write them: a reader that has followed a set-up knows what is mapped. Before it a
PDO is read by the defaults of the EPOS2; bytes that do not fit its mapping are left as they are.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

from firmware_bridge.drivers.commissioning.names import called
from firmware_bridge.drivers.commissioning.values import decode, unit_of
from firmware_bridge.drivers.commissioning.words import mode_of, words
from firmware_bridge.packet import Packet
from firmware_bridge.wire import canopen, sdo
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE, identifier
from firmware_bridge.wire.can_error import BUS_OFF, CONTROLLER, RESTARTED
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.epos2.objects import OBJECTS
from firmware_bridge.wire.epos2.objects_pdo import (
    PDOS,
    RECEIVE_MAPPING,
    RECEIVE_PARAMETER,
    TRANSMIT_MAPPING,
    TRANSMIT_PARAMETER,
)
from firmware_bridge.wire.lss import LssCommand
from firmware_bridge.wire.pdo import MAX_ENTRIES, MappingEntry

_REPORTS: Final = {CONTROLLER: "controller state", BUS_OFF: "bus off", RESTARTED: "restarted"}
_SAVE: Final = Address(0x1010, 1)
_IN_BITS: Final = frozenset({at.CONTROLWORD, at.STATUSWORD, at.ERROR_REGISTER}) | {
    Address(index + pdo, subindex)
    for pdo in range(PDOS)
    for index, subindexes in (
        (RECEIVE_PARAMETER, (1,)),
        (TRANSMIT_PARAMETER, (1,)),
        (RECEIVE_MAPPING, range(1, MAX_ENTRIES + 1)),
        (TRANSMIT_MAPPING, range(1, MAX_ENTRIES + 1)),
    )
    for subindex in subindexes
}
"""Objects whose value is written in hexadecimal digits."""
_LSS: Final = {int(command): command for command in LssCommand}
_FIRST_PDO: Final = 0x180
_LAST_PDO: Final = 0x57F


@dataclass(frozen=True, slots=True)
class Service:
    """Identifiers from `base` on, and who reads what comes with them; a node's number is added to `base`."""

    base: int
    added: range
    read: "Callable[[Canopen, int, bytes], str]"


class Canopen:
    """Reads the frames of one bus in their order."""

    def __init__(self) -> None:
        self._written: dict[int, dict[Address, int]] = {}
        """What was written to each node, as far as it matters for reading."""
        self._saved: dict[int, dict[Address, int]] = {}
        self._asked: dict[int, Address] = {}
        """The object of each node's SDO transfer."""

    def read(self, _sender: str, packet: Packet) -> str:
        """Return what a frame says."""
        address = packet.address
        if address & ERROR:
            return f"report of the controller: {_REPORTS.get(address, 'of another kind')}"
        if address & EXTENDED:
            return "a frame with 29 bits, no CANopen"
        number = identifier(address)
        if address & REMOTE:
            return f"remote request of {self._title(number)}"
        for service in SERVICES:
            if number - service.base in service.added:
                return service.read(self, number - service.base, packet.payload)
        return (
            self._pdo(number, packet.payload) if _FIRST_PDO <= number <= _LAST_PDO else "no CANopen service"
        )

    # Services

    def nmt(self, _node: int, payload: bytes) -> str:
        """Read a network management command; a node that is reset forgets what it has not saved."""
        told = canopen.decode_nmt(payload)
        if told is None:
            return "NMT: no command"
        command, node = told
        if command in {canopen.NmtCommand.RESET_NODE, canopen.NmtCommand.RESET_COMMUNICATION}:
            for one in [node] if node else list(self._written):
                self._forget(one)
        return f"NMT {_plain(command.name)}, {f'node {node}' if node else 'all nodes'}"

    def sync_or_emergency(self, node: int, payload: bytes) -> str:
        """Read a SYNC, or the emergency of a node."""
        if not node:
            return "SYNC"
        told = canopen.decode_emergency(payload)
        if told is None:
            return f"EMCY node {node}: too short"
        cause = ", ".join(words(Address(0x1003, 1), told.code))
        register = ", ".join(words(at.ERROR_REGISTER, told.register))
        return f"EMCY node {node}: {cause}; error register 0x{told.register:02X} ({register})"

    def time_stamp(self, _node: int, _payload: bytes) -> str:
        """Read a time stamp."""
        return "TIME"

    def sdo_request(self, node: int, payload: bytes) -> str:
        """Read what a client asks of a node."""
        request = sdo.decode_request(payload)
        head = f"SDO request, node {node}:"
        match request:
            case sdo.UploadRequest(address):
                self._asked[node] = address
                return f"{head} read {called(address)}"
            case sdo.DownloadRequest(address, raw, size):
                self._asked[node] = address
                if raw is None:
                    length = "" if size is None else f" of {size} bytes"
                    return f"{head} write {called(address)}, segments{length} to come"
                self._note(node, address, raw)
                return f"{head} write {called(address)} = {self._value(node, address, raw)}"
            case sdo.UploadSegmentRequest():
                return f"{head} next segment of {self._object(node)}"
            case _:
                return f"{head} {self._either(node, request)}"

    def sdo_response(self, node: int, payload: bytes) -> str:
        """Read what a node answers."""
        response = sdo.decode_response(payload)
        head = f"SDO response, node {node}:"
        match response:
            case sdo.UploadResponse(address, raw, size):
                if raw is None:
                    length = "" if size is None else f" of {size} bytes"
                    return f"{head} {called(address)}, segments{length} to come"
                return f"{head} {called(address)} = {self._value(node, address, raw)}"
            case sdo.DownloadResponse(address):
                return f"{head} {called(address)} written"
            case sdo.SegmentAccepted():
                return f"{head} segment of {self._object(node)} taken"
            case _:
                return f"{head} {self._either(node, response)}"

    def error_control(self, node: int, payload: bytes) -> str:
        """Read a heartbeat, a boot-up message or the answer to node guarding."""
        state = canopen.decode_heartbeat(payload)
        if state is canopen.NmtState.BOOT_UP:
            self._forget(node)
            return f"boot-up, node {node}"
        return f"heartbeat, node {node}: {'no state' if state is None else _plain(state.name)}"

    def lss(self, answer: int, payload: bytes) -> str:
        """Read a layer setting service's frame."""
        command = _LSS.get(payload[0]) if payload else None
        said = "no command" if command is None else f"{_plain(command.name)} {payload[1:].hex(' ').upper()}"
        return f"LSS {'request' if answer else 'response'}: {said}"

    # What is written, and by whom it is read again

    def _either(self, node: int, transfer: sdo.Request | sdo.Response) -> str:
        match transfer:
            case sdo.Abort(address, code):
                return f"abort, {called(address)}: {sdo.meaning_of(code)}"
            case sdo.Segment(_, raw, last):
                end = ", the last" if last else ""
                return f"segment of {self._object(node)}{end}: {raw.hex(' ').upper()}"
            case _:
                return "no SDO transfer"

    def _object(self, node: int) -> str:
        asked = self._asked.get(node)
        return "an unknown object" if asked is None else called(asked)

    def _note(self, node: int, address: Address, raw: bytes) -> None:
        written = self._written.setdefault(node, {})
        if address == _SAVE:
            self._saved[node] = dict(written)
        row = OBJECTS.get(address)
        if row is not None and row.type.size:
            written[address] = row.type.decode(raw[: row.type.size])

    def _forget(self, node: int) -> None:
        self._written[node] = dict(self._saved.get(node, {}))

    def _entry(self, node: int, index: int, subindex: int) -> int:
        address = Address(index, subindex)
        value = self._written.get(node, {}).get(address)
        default = OBJECTS[address].default_for(node) if value is None else value
        return default if isinstance(default, int) else 0

    def _value(self, node: int, address: Address, raw: bytes) -> str:
        row = OBJECTS.get(address)
        if row is not None and 0 < row.type.size < len(raw):
            raw = raw[: row.type.size]  # a client that does not tell the size sends four bytes
        value = decode(address, raw)
        mode = mode_of(self._written.get(node, {}).get(at.MODE, 0))
        said = words(address, value, mode)
        in_bits = isinstance(value, int) and address in _IN_BITS
        number = f"0x{value:0{2 * len(raw)}X}" if in_bits else f"{value}"
        unit = unit_of(address)
        return number + (f" {unit}" if unit else "") + (f" ({', '.join(said)})" if said else "")

    # PDOs

    def _candidates(self, number: int) -> Iterator[tuple[int, str, int]]:
        """Yield node, title and index of the mapping of each PDO that has this identifier now."""
        predefined = number & canopen.NODE_MASK
        for node in dict.fromkeys((*self._written, predefined)):
            if not node:
                continue
            for place in range(PDOS):
                for kind, parameter, mapping in (
                    ("RPDO", RECEIVE_PARAMETER, RECEIVE_MAPPING),
                    ("TPDO", TRANSMIT_PARAMETER, TRANSMIT_MAPPING),
                ):
                    entry = self._entry(node, parameter + place, 1)
                    if entry & canopen.COB_ID_MASK == number:
                        yield node, f"{kind} {place + 1}, node {node}", mapping + place

    def _title(self, number: int) -> str:
        for _, title, _ in self._candidates(number):
            return title
        return f"0x{number:03X}"

    def _pdo(self, number: int, payload: bytes) -> str:
        for node, title, mapping in self._candidates(number):
            fields = self._fields(node, mapping, payload)
            return f"{title}: {', '.join(fields) if fields else 'bytes that do not fit its mapping'}"
        return "a PDO of nobody known"

    def _fields(self, node: int, mapping: int, payload: bytes) -> list[str]:
        """Return name and value of each mapped object; none where the bytes are not those of the mapping."""
        count = min(self._entry(node, mapping, 0), MAX_ENTRIES)
        entries = [MappingEntry.decode(self._entry(node, mapping, place + 1)) for place in range(count)]
        if sum(entry.bits for entry in entries) != 8 * len(payload):
            return []
        found, begin = [], 0
        for entry in entries:
            end = begin + entry.bits // 8
            value = self._value(node, entry.address, payload[begin:end])
            found.append(f"{called(entry.address)} = {value}")
            begin = end
        return found


_NODES: Final = range(canopen.FIRST_NODE, canopen.LAST_NODE + 1)

SERVICES: Final = (
    Service(canopen.NMT, range(1), Canopen.nmt),
    Service(canopen.SYNC, range(canopen.LAST_NODE + 1), Canopen.sync_or_emergency),
    Service(canopen.TIME_STAMP, range(1), Canopen.time_stamp),
    Service(canopen.SDO_RESPONSE, _NODES, Canopen.sdo_response),
    Service(canopen.SDO_REQUEST, _NODES, Canopen.sdo_request),
    Service(canopen.ERROR_CONTROL, _NODES, Canopen.error_control),
    Service(canopen.LSS_RESPONSE, range(2), Canopen.lss),
)
"""Identifiers beside those of PDOs, which may be changed."""


def _plain(name: str) -> str:
    return name.lower().replace("_", " ")
