"""CANopen frames, decoded: network management, SYNC, emergencies, PDOs, SDOs, error control, LSS.

Identifiers are those of the predefined connection set (CiA 301 v4.02), and the PDOs' own as far as they were
seen to be written: a reader that has followed a set-up knows what is mapped. Before it a PDO is read by the
defaults of the node's family; bytes that do not fit its mapping are left as they are.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from firmware_bridge.canopen import cia301, sdo
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.lss import LssCommand
from firmware_bridge.canopen.pdo import TRANSMIT_MAPPING
from firmware_bridge.canopen.time_of_day import decode_time
from firmware_bridge.dissector.dictionary import Dictionary, dictionaries
from firmware_bridge.dissector.nodes import PDO_OBJECTS, Nodes
from firmware_bridge.packet import Packet
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE, identifier
from firmware_bridge.wire.can_error import BUS_OFF, CONTROLLER, RESTARTED

_REPORTS: Final = {CONTROLLER: "controller state", BUS_OFF: "bus off", RESTARTED: "restarted"}
_LSS: Final = {int(command): command for command in LssCommand}
MASTER: Final = 0
"""The network's master, in the place of a sender's number."""
ADDED: Final = -1
MOST_TEXTS: Final = 4096
"""So many texts of PDOs are kept."""
BY_DEFAULT: Final = " (default mapping)"
"""Mark of a PDO that is read by its family's default: its mapping was neither written, read nor given."""
PDO: Final = "pdo"
OTHER: Final = "other"


class Canopen:
    """A reader of the frames of one bus, in their order."""

    def __init__(
        self,
        device: str = "",
        *,
        defaults: bool = True,
        sheet: Mapping[Address, int] | None = None,
    ) -> None:
        """Read nodes of an unknown maker as of the family `device`, of the first maker where it is empty.

        With `defaults` also a PDO whose mapping was not seen to be written; `sheet` has other defaults, of a
        data sheet. A node whose vendor is known from its frames is read by its own dictionary anyway.
        """
        known = dictionaries()
        self._by_vendor = {one.vendor: one for one in known.values()}
        unknown = known[device] if device else next(one for one in known.values() if one.vendor is not None)
        self._nodes = Nodes(unknown, sheet or {})
        self._defaults = defaults or sheet is not None
        self._requested: dict[int, Address] = {}
        """The object of each node's SDO transfer."""
        self._texts: dict[tuple[int, bytes], str] = {}
        """Texts of PDOs, which repeat: those of one version of what is known of the nodes."""
        self._texts_of = 0

    def read(self, _sender: str, packet: Packet) -> str:
        """Return the decoded text of a frame."""
        address = packet.address
        if address & ERROR:
            return f"report of the controller: {_REPORTS.get(address, 'of another kind')}"
        if address & EXTENDED:
            return "a frame with 29 bits, no CANopen"
        number = identifier(address)
        if address & REMOTE:
            return f"remote request of {self._title(number)}"
        service = service_of(packet)
        if service is not None:
            return service.read(self, number - service.base, packet.payload)
        return self._pdo(number, packet.payload) if _is_pdo(number) else "no CANopen service"

    def sender(self, packet: Packet) -> int | None:
        """Return the number of the node that sends such a frame, or `MASTER`; None where it is unknown."""
        number = identifier(packet.address)
        if packet.address & (ERROR | EXTENDED):
            return None
        if packet.address & REMOTE:
            return MASTER
        service = service_of(packet)
        if service is not None:
            return number - service.base if service.sender == ADDED else service.sender
        # An identifier of a PDO may be of any node: its COB-ID object decides, not the predefined set.
        for node, _, mapping in self._nodes.candidates(number):
            return node if mapping >= TRANSMIT_MAPPING else MASTER
        return None

    def node_of(self, packet: Packet) -> int | None:
        """Return the node that sends such a frame, or that it is for; None for all, or for an unknown one."""
        number = identifier(packet.address)
        if packet.address & (ERROR | EXTENDED):
            return None
        service = service_of(packet)
        if service is None:
            return next((node for node, _, _ in self._nodes.candidates(number)), None)
        if service.name == "nmt":
            return (packet.payload[1] if len(packet.payload) > 1 else 0) or None
        return number - service.base if len(service.added) > 1 else None

    def expect(
        self, node: int, written: Iterable[tuple[Address, bytes]], dictionary: Dictionary | None = None
    ) -> None:
        """Take a node for set up like this, without having seen it; `dictionary` is that of its family."""
        if dictionary is not None:
            self._nodes.is_of(node, dictionary)
        self._nodes.expect(node, written)

    def objects(self, packet: Packet) -> tuple[int, list[tuple[Address, bytes]]]:
        """Return the node that sends objects of its own by this frame, and these with their bytes.

        They come in its transmit PDOs, as far as their mapping is known, and in its SDO answers.
        """
        number = identifier(packet.address)
        if packet.address & (ERROR | EXTENDED | REMOTE):
            return MASTER, []
        node = number - cia301.SDO_RESPONSE
        if cia301.FIRST_NODE <= node <= cia301.LAST_NODE:
            response = sdo.decode_response(packet.payload)
            if isinstance(response, sdo.UploadResponse) and response.raw is not None:
                return node, [(response.address, response.raw)]
            return node, []
        for owner, _, mapping in self._nodes.candidates(number) if _is_pdo(number) else ():
            # Only its own frames show a node's objects.
            known = mapping >= TRANSMIT_MAPPING and self._known(owner, mapping)
            return owner, self._nodes.contents(owner, mapping, packet.payload) if known else []
        return MASTER, []

    def numbers(self, packet: Packet, wanted: Collection[Address]) -> Iterator[tuple[int, Address, int]]:
        """Yield node, object and number of the wanted objects in a PDO, by a mapping that is known."""
        for node, _, mapping in self._nodes.candidates(identifier(packet.address)):
            if self._known(node, mapping):
                for address, raw in self._nodes.contents(node, mapping, packet.payload):
                    if address in wanted:
                        yield node, address, int.from_bytes(raw, "little", signed=True)
            return

    @property
    def version(self) -> int:
        """A number that changes with everything that changes how a frame is read."""
        return self._nodes.version

    def place(self, packet: Packet, address: Address) -> tuple[int, int, int] | None:
        """Return where a transmit PDO has an object: its length, the object's begin and end; None if nowhere.

        It holds for all frames with that identifier while `version` stays.
        """
        number = identifier(packet.address)
        if packet.address & REMOTE or service_name(packet) != PDO:
            return None
        for owner, _, mapping in self._nodes.candidates(number):
            if mapping < TRANSMIT_MAPPING or not self._known(owner, mapping):
                return None
            bits, places = self._nodes.places(owner, mapping)
            # Of an object that is mapped twice the last one counts, as in `objects`.
            found = [place for place in places if place.address == address]
            return (bits // 8, found[-1].begin, found[-1].end) if found and not bits % 8 else None
        return None

    def mark(self, packet: Packet) -> str:
        """Return `BY_DEFAULT` of a PDO that is read by its family's default; it holds as `place` does."""
        for owner, _, mapping in self._nodes.candidates(identifier(packet.address)):
            return self._marked(owner, mapping)
        return ""

    def value(self, node: int, address: Address, raw: bytes) -> str:
        """Return an object's value for people, with its unit and what its bits say."""
        return self._nodes.value(node, address, raw)

    # Services

    def nmt(self, _node: int, payload: bytes) -> str:
        """Read a network management command; a node that is reset forgets what it has not saved."""
        decoded = cia301.decode_nmt(payload)
        if decoded is None:
            return "NMT: no command"
        command, node = decoded
        if command in {cia301.NmtCommand.RESET_NODE, cia301.NmtCommand.RESET_COMMUNICATION}:
            # Node 0 is all nodes (CiA 301, NMT).
            for one in [node] if node else self._nodes.known:
                self._nodes.forget(one)
        return f"NMT {_plain(command.name)}, {f'node {node}' if node else 'all nodes'}"

    def sync(self, _node: int, _payload: bytes) -> str:
        """Read a SYNC."""
        return "SYNC"

    def emergency(self, node: int, payload: bytes) -> str:
        """Read the emergency of a node."""
        decoded = cia301.decode_emergency(payload)
        if decoded is None:
            return f"EMCY node {node}: too short"
        cause = ", ".join(self._nodes.of(node).words.words(Address(0x1003, 1), decoded.code))
        register = ", ".join(self._nodes.of(node).words.words(od.ERROR_REGISTER, decoded.register))
        return f"EMCY node {node}: {cause}; error register 0x{decoded.register:02X} ({register})"

    def time_stamp(self, _node: int, payload: bytes) -> str:
        """Read the time of day."""
        time = decode_time(payload)
        return "TIME" if time is None else f"TIME {time.isoformat(' ', 'milliseconds')}"

    def sdo_request(self, node: int, payload: bytes) -> str:
        """Decode a client's request to a node."""
        request = sdo.decode_request(payload)
        head = f"SDO request, node {node}:"
        match request:
            case sdo.UploadRequest(address):
                self._requested[node] = address
                return f"{head} read {self._nodes.called(node, address)}"
            case sdo.DownloadRequest(address, raw, size):
                self._requested[node] = address
                if raw is None:
                    length = "" if size is None else f" of {size} bytes"
                    return f"{head} write {self._nodes.called(node, address)}, segments{length} to come"
                self._nodes.note(node, address, raw)
                written = self._nodes.value(node, address, raw)
                return f"{head} write {self._nodes.called(node, address)} = {written}"
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
                    return f"{head} {self._nodes.called(node, address)}, segments{length} to come"
                if address.index in PDO_OBJECTS:
                    self._nodes.note(node, address, raw)
                if address == od.VENDOR_ID:
                    self._identified(node, int.from_bytes(raw, "little"))
                return f"{head} {self._nodes.called(node, address)} = {self._nodes.value(node, address, raw)}"
            case sdo.DownloadResponse(address):
                return f"{head} {self._nodes.called(node, address)} written"
            case sdo.SegmentAccepted():
                return f"{head} segment of {self._object(node)} taken"
            case _:
                return f"{head} {self._either(node, response)}"

    def error_control(self, node: int, payload: bytes) -> str:
        """Read a heartbeat, a boot-up message or the answer to node guarding."""
        state = cia301.decode_heartbeat(payload)
        if state is cia301.NmtState.BOOT_UP:
            # After a boot-up the mapping is the saved one again.
            self._nodes.forget(node)
            return f"boot-up, node {node}"
        return f"heartbeat, node {node}: {'no state' if state is None else _plain(state.name)}"

    def lss(self, _node: int, payload: bytes) -> str:
        """Read a layer setting service's frame."""
        command = _LSS.get(payload[0]) if payload else None
        text = "no command" if command is None else f"{_plain(command.name)} {payload[1:].hex(' ').upper()}"
        return f"LSS: {text}"

    def _identified(self, node: int, vendor: int) -> None:
        """Read a node by its maker's dictionary from now on, or by that of any maker's drives."""
        found = self._by_vendor.get(vendor, self._by_vendor.get(None))
        if found is not None:
            self._nodes.is_of(node, found)

    # What is written, and by whom it is read again

    def _either(self, node: int, transfer: sdo.Request | sdo.Response) -> str:
        match transfer:
            case sdo.Abort(address, code):
                return f"abort, {self._nodes.called(node, address)}: {sdo.meaning_of(code)}"
            case sdo.SdoSegment(_, raw, last):
                end = ", the last" if last else ""
                return f"segment of {self._object(node)}{end}: {raw.hex(' ').upper()}"
            case _:
                return "no SDO transfer"

    def _object(self, node: int) -> str:
        requested = self._requested.get(node)
        return "an unknown object" if requested is None else self._nodes.called(node, requested)

    # PDOs

    def _title(self, number: int) -> str:
        for _, title, _ in self._nodes.candidates(number):
            return title
        return f"0x{number:03X}"

    def _known(self, node: int, mapping: int) -> bool:
        return self._defaults or self._nodes.identified(node) or self._nodes.mapped(node, mapping)

    def _marked(self, node: int, mapping: int) -> str:
        return "" if self._nodes.stated(node, mapping) else BY_DEFAULT

    def _pdo(self, number: int, payload: bytes) -> str:
        if self._texts_of != self._nodes.version or len(self._texts) >= MOST_TEXTS:
            self._texts.clear()
            self._texts_of = self._nodes.version
        text = self._texts.get((number, payload))
        if text is None:
            text = self._texts[number, payload] = self._pdo_read(number, payload)
        return text

    def _pdo_read(self, number: int, payload: bytes) -> str:
        for node, title, mapping in self._nodes.candidates(number):
            if not self._known(node, mapping):
                return f"{title}: {payload.hex(' ').upper()}, by a mapping that is not known"
            fields = self._nodes.fields(node, mapping, payload)
            by = self._marked(node, mapping)
            return f"{title}{by}: {', '.join(fields) if fields else 'bytes that do not fit its mapping'}"
        return "a PDO of an unknown node"


@dataclass(frozen=True, slots=True)
class Service:
    """Identifiers from `base` on, who sends them, and who reads what comes with them."""

    name: str
    base: int
    added: range
    """A node's number, where there is one, is added to `base`."""
    sender: int | None
    """`MASTER`, `ADDED` for the node whose number is added, None where the identifier does not show it."""
    read: Callable[[Canopen, int, bytes], str]


_NODES: Final = range(cia301.FIRST_NODE, cia301.LAST_NODE + 1)

SERVICES: Final = (
    Service("nmt", cia301.NMT, range(1), MASTER, Canopen.nmt),
    Service("sync", cia301.SYNC, range(1), MASTER, Canopen.sync),
    Service("emergency", cia301.EMERGENCY, _NODES, ADDED, Canopen.emergency),
    Service("time", cia301.TIME_STAMP, range(1), MASTER, Canopen.time_stamp),
    Service("sdo", cia301.SDO_RESPONSE, _NODES, ADDED, Canopen.sdo_response),
    Service("sdo", cia301.SDO_REQUEST, _NODES, MASTER, Canopen.sdo_request),
    Service("heartbeat", cia301.ERROR_CONTROL, _NODES, ADDED, Canopen.error_control),
    Service("lss", cia301.LSS_RESPONSE, range(1), None, Canopen.lss),
    Service("lss", cia301.LSS_REQUEST, range(1), MASTER, Canopen.lss),
)
"""Services beside PDOs, whose identifiers may be changed."""


SERVICE_NAMES: Final = (*dict.fromkeys(service.name for service in SERVICES), PDO, OTHER)
"""The possible kinds of a frame; see `service_name`."""


def service_of(packet: Packet) -> Service | None:
    """Return the service that a data frame with 11 bits belongs to; None for a PDO, and for no CANopen."""
    return _service_of(identifier(packet.address))


@lru_cache(maxsize=4096)
def _service_of(number: int) -> Service | None:
    for service in SERVICES:
        # EMCY and SYNC share 0x080: SYNC is the identifier itself, EMCY has a node's number added.
        if number - service.base in service.added:
            return service
    return None


def service_name(packet: Packet) -> str:
    """Return what a CAN frame is: a service's name, `PDO`, or `OTHER`."""
    if packet.address & (ERROR | EXTENDED):
        return OTHER
    service = service_of(packet)
    if service is not None:
        return service.name
    return PDO if _is_pdo(identifier(packet.address)) else OTHER


def _is_pdo(number: int) -> bool:
    return cia301.TRANSMIT_PDO[0] <= number < cia301.SDO_RESPONSE


def _plain(name: str) -> str:
    return name.lower().replace("_", " ")
