"""Picture of a CANopen bus from listening: its nodes, their messages and rates, the last error.

Texts come from the dissector; this adds up and remembers. The source of frames is not known here, and none is
sent. Time is an argument and must not step back.
"""

from collections import deque
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from firmware_bridge.canopen import cia301, sdo
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand, NmtState
from firmware_bridge.dissector.canopen import MASTER, PDO, Canopen, service_name
from firmware_bridge.dissector.expected import Expected
from firmware_bridge.dissector.traffic import BURST, RECENT, Traffic
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds, to_seconds
from firmware_bridge.wire.can import ERROR, INTERFRAME_BITS, REMOTE, frame_bits

BEATS: Final = 5
"""Number of last intervals between heartbeats that give the period."""
SHORTEST: Final[Nanoseconds] = MILLISECOND
"""No heartbeat's period is shorter (CiA 301): frames that come closer have waited somewhere together."""
MISSED: Final = 2
"""A heartbeat is missing after so many of its own periods. Assumed: consumers wait about as long; CiA 301
leaves it to who sets them up."""
_NO_STATUS: Final = ""
_DATA: Final = frozenset({PDO, "sync"})
"""Kinds of frames that change nothing by which others are read."""
_COMMANDED: Final[Mapping[NmtCommand | None, NmtState | None]] = {
    NmtCommand.START: NmtState.OPERATIONAL,
    NmtCommand.STOP: NmtState.STOPPED,
    NmtCommand.ENTER_PRE_OPERATIONAL: NmtState.PRE_OPERATIONAL,
    NmtCommand.RESET_NODE: None,
    NmtCommand.RESET_COMMUNICATION: None,
}
"""State of a node after the command; after a reset it is unknown until the boot-up message."""


@dataclass(slots=True)
class NodeSeen:
    """One node, as far as it was received."""

    node: int
    title: str = ""
    """Title in the robot file."""
    network: NmtState | None = None
    """The state as reported last, or commanded since, or reached by itself."""
    reported: NmtState | None = None
    """The state as reported last."""
    beat_at: Nanoseconds | None = None
    periods: deque[Nanoseconds] = field(default_factory=lambda: deque(maxlen=BEATS))
    """Between its last heartbeats, or answers to node guarding."""
    missing: bool = False
    """True where a heartbeat is overdue."""
    late: int = 0
    """Heartbeats in a row that came when they were overdue."""
    status: str = _NO_STATUS
    """Its Statusword, decoded; marked where a default mapping shows it."""
    emergency: str = ""
    emergencies: int = 0
    raw_status: bytes = b""

    @property
    def period(self) -> Nanoseconds | None:
        """The time from one heartbeat to the next, the median of the last; None where they are too few."""
        # The median: one late heartbeat does not change the period.
        return sorted(self.periods)[len(self.periods) // 2] if len(self.periods) > 1 else None


@dataclass(slots=True)
class MessageSeen:
    """The frames of one identifier."""

    packet: Packet
    """The last one."""
    kind: str
    """See `service_name`."""
    read: tuple[str, str] | None = None
    """Its kind, and its decoded text; None where it was not read yet."""
    version: int = -1
    """The reader's `version` when the following was looked up."""
    sender: int | None = None
    status: tuple[int, int, int] | None = None
    """Of a PDO with the sender's Statusword: its length, and where the Statusword is."""
    mark: str = ""
    """Shown behind that Statusword: the mapping is a default only."""
    count: int = 0


@dataclass(frozen=True, slots=True)
class Error:
    """An error, and its time."""

    at: Nanoseconds
    text: str


class BusPicture:
    """One bus. `note` and `pass_time` return the changes as text."""

    def __init__(
        self,
        bit_rate: int,
        expected: tuple[Expected, ...] = (),
        sheet: Mapping[Address, int] | None = None,
        *,
        device: str = "",
    ) -> None:
        """Take the drives of a robot; all others by a data sheet, or as of the family `device`."""
        self.bit_rate: Final = bit_rate
        self.frames = 0
        self.bits = 0
        """Of all frames, stuff bits and the spaces between them included."""
        self.first_at: Nanoseconds | None = None
        self.now: Nanoseconds = 0
        self.error: Error | None = None
        """The last one."""
        self._reader = Canopen(device, defaults=bool(device), sheet=sheet)
        self._nodes: dict[int, NodeSeen] = {}
        self._messages: dict[int, MessageSeen] = {}
        self._titles = {one.node: one.title for one in expected}
        self._look_at: Nanoseconds = -NEVER
        """Before it no heartbeat is overdue."""
        self._traffic: Final = Traffic()
        for one in expected:
            self._reader.expect(one.node, one.written, one.dictionary)

    @property
    def nodes(self) -> tuple[NodeSeen, ...]:
        """The nodes received, by number."""
        return tuple(one for _, one in sorted(self._nodes.items()))

    @property
    def elapsed(self) -> Nanoseconds:
        """The time since the first frame."""
        return 0 if self.first_at is None else self.now - self.first_at

    @property
    def load_percent(self) -> float:
        """The part of the last `RECENT` in which the bus was taken, or of the time since the first frame."""
        return self._percent(self._traffic.bits(self.now), min(RECENT, self.elapsed))

    @property
    def mean_percent(self) -> float:
        """The part of all the time in which the bus was taken."""
        return self._percent(self.bits, self.elapsed)

    @property
    def peak_percent(self) -> float:
        """The load in the busiest `BURST`."""
        return self._percent(self._traffic.peak, min(BURST, self.elapsed))

    def messages(self) -> Iterator[tuple[int, str, str, int, float]]:
        """Yield identifier, kind, last decoded text, count, and frames a second, by identifier."""
        recent = self._traffic.frames(self.now)
        for address, one in sorted(self._messages.items()):
            if one.read is None:
                one.read = self._read(one.packet)
            yield address, *one.read, one.count, recent[address] / to_seconds(RECENT)

    def text_of(self, packet: Packet) -> str:
        """Return the newest frame's decoded text; it was noted before."""
        if packet.address & ERROR:
            return "" if self.error is None else self.error.text
        message = self._messages[packet.address]
        if message.read is None:
            message.read = self._read(message.packet)
        return ": ".join(filter(None, message.read))

    def numbers(self, wanted: Collection[Address]) -> Iterator[tuple[int, Address, int]]:
        """Yield node, object and number of each wanted object in the newest frames, sent by it or to it."""
        for message in self._messages.values():
            if message.kind == PDO:
                yield from self._reader.numbers(message.packet, wanted)

    def node_of(self, packet: Packet) -> int | None:
        """Return the node that sends a frame, or that it is for; None for all of them, or none known."""
        return self._reader.node_of(packet)

    def note(self, now: Nanoseconds, packet: Packet) -> tuple[str, ...]:
        """Take a frame that has arrived."""
        if self.first_at is None:
            self.first_at = self.now = now
        # Before the frame itself: a heartbeat that arrives now was missing until now.
        late = self.pass_time(now) if now >= self._look_at else ()
        self.now = max(self.now, now)
        address = packet.address
        if address & ERROR:
            return (*late, self._wrong(self._reader.read("", packet)))
        self.frames += 1
        bits = frame_bits(address, packet.payload) + INTERFRAME_BITS
        self.bits += bits
        self._traffic.add(now, address, bits)
        message = self._messages.get(address)
        if message is None:
            message = self._messages[address] = MessageSeen(packet, service_name(packet))
        # Decoded when it is shown: most frames of a busy bus are never looked at.
        message.packet, message.read = packet, None
        message.count += 1
        if message.kind in _DATA:
            changes: Sequence[str] = self._process_data(message)
        elif message.kind == "heartbeat":
            changes = self._lives(now, message)
        else:
            changes = self._changes(message)
        return (*late, *changes) if late or changes else ()

    def pass_time(self, now: Nanoseconds) -> tuple[str, ...]:
        """Take note that it is `now`, and of heartbeats that are overdue."""
        return tuple(text for _, text in self.overdue(now))

    def overdue(self, now: Nanoseconds) -> tuple[tuple[int, str], ...]:
        """Take note that it is `now`; return each node whose heartbeat is overdue now, with a text."""
        self.now = max(self.now, now)
        if self.now < self._look_at:
            return ()
        found = tuple((one.node, self._missing(one)) for one in self._nodes.values() if self._overdue(one))
        self._look_at = min(map(self._due, self._nodes.values()), default=NEVER)
        return found

    def _process_data(self, message: MessageSeen) -> tuple[str, ...]:
        """Follow a PDO or a SYNC, and return what it has changed; it is read when it is shown."""
        if message.version != self._reader.version:
            message.sender = self._reader.sender(message.packet)
            message.status = self._reader.place(message.packet, od.STATUSWORD)
            message.mark = self._reader.mark(message.packet) if message.status else ""
            message.version = self._reader.version
        node = message.sender
        if not node:
            return ()
        seen, found = self._nodes.get(node), tuple[str, ...]()
        if seen is None:
            seen, found = self._found(node)
        payload = message.packet.payload
        if message.status is None or len(payload) != message.status[0]:
            return found
        raw = payload[message.status[1] : message.status[2]]
        return found if raw == seen.raw_status else (*found, self._status(seen, raw, message.mark))

    def _lives(self, now: Nanoseconds, message: MessageSeen) -> list[str]:
        """Follow a heartbeat, and return what it has changed; it is read when it is shown."""
        packet, found = message.packet, list[str]()
        # Of heartbeats the boot-up message alone changes what the reader knows.
        if cia301.decode_heartbeat(packet.payload) is cia301.NmtState.BOOT_UP:
            message.read = self._read(packet)
        seen = self._sent_by(packet, found)
        if seen is not None:
            found += self._beats(seen, now, packet.payload)
        return found

    def _sent_by(self, packet: Packet, found: list[str]) -> NodeSeen | None:
        """Return the sender of a frame of a service; a node that was not known is added to `found`."""
        node = None if packet.address & REMOTE else self._reader.sender(packet)
        if node is not None and node != MASTER and node not in self._nodes:
            found += self._found(node)[1]
        return self._nodes.get(MASTER if node is None else node)

    def _changes(self, message: MessageSeen) -> list[str]:
        """Follow a frame of another service, and return what it has changed."""
        packet, kind, found = message.packet, message.kind, list[str]()
        # Services change what the reader knows, so they are read in order; process data does not.
        message.read = self._read(packet)
        seen = self._sent_by(packet, found)
        if kind == "nmt":
            self._commanded(packet.payload)
            found.append(": ".join(filter(None, message.read)))
        elif kind == "sdo":
            found += self._aborted(packet, message)
        if seen is None:
            return found
        if kind == "emergency":
            found += self._emergency(seen, packet, message)
        elif kind == "sdo":
            raw = dict(self._reader.objects(packet)[1]).get(od.STATUSWORD)
            if raw is not None and raw != seen.raw_status:
                found.append(self._status(seen, raw))
        return found

    def _found(self, node: int) -> tuple[NodeSeen, tuple[str, ...]]:
        """Take down a node that was not known."""
        seen = self._nodes[node] = NodeSeen(node, self._titles.get(node, ""))
        return seen, (f"node {node} is there",)

    def _commanded(self, payload: bytes) -> None:
        """Take the nodes that are commanded for obedient, until they say otherwise."""
        command, node = cia301.decode_nmt(payload) or (None, 0)
        for seen in self._nodes.values():
            if command in _COMMANDED and node in {0, seen.node}:
                seen.network = _COMMANDED[command]

    def _beats(self, seen: NodeSeen, now: Nanoseconds, payload: bytes) -> Iterator[str]:
        """Take a heartbeat, a boot-up message or an answer to node guarding."""
        state = cia301.decode_heartbeat(payload)
        restarted = state is NmtState.BOOT_UP
        if state is not seen.reported and state is not None:
            yield f"node {seen.node}: {'restarted' if restarted else state.title}"
        elif seen.missing:
            yield f"node {seen.node}: its heartbeat is back"
        if restarted:
            seen.periods.clear()
            # The statusword of before the reset is none of the drive that has started again.
            seen.status, seen.raw_status = _NO_STATUS, b""
        elif seen.beat_at is not None and now - seen.beat_at >= SHORTEST:
            # Silence is no period; where every beat comes after one, it is the estimate that was wrong.
            seen.late = seen.late + 1 if seen.missing else 0
            if seen.late > 1:
                seen.periods.clear()
            if seen.late != 1:
                seen.periods.append(now - seen.beat_at)
        # A boot-up message is no heartbeat; the period begins with the next one.
        seen.beat_at, seen.missing = None if restarted else now, False
        seen.reported = seen.reported if state is None else state
        # It goes on to pre-operational by itself (CiA 301).
        follows = NmtState.PRE_OPERATIONAL if restarted else state
        seen.network = seen.network if follows is None else follows
        # Those of the other nodes are due as before.
        self._look_at = min(self._look_at, self._due(seen))

    def _emergency(self, seen: NodeSeen, packet: Packet, message: MessageSeen) -> Iterator[str]:
        decoded = cia301.decode_emergency(packet.payload)
        if message.read is None:
            return
        title, reported = message.read
        seen.emergency = reported
        if decoded is not None and decoded.code:
            seen.emergencies += 1
            yield self._wrong(f"{title}: {reported}")
        else:
            yield f"{title}: {reported}"

    def _aborted(self, packet: Packet, message: MessageSeen) -> Iterator[str]:
        decode = sdo.decode_request if packet.address >= cia301.SDO_REQUEST else sdo.decode_response
        if message.read is not None and isinstance(decode(packet.payload), sdo.Abort):
            yield self._wrong(": ".join(message.read))

    def _status(self, seen: NodeSeen, raw: bytes, mark: str = "") -> str:
        """Take another Statusword."""
        seen.raw_status = raw
        seen.status = f"{self._reader.value(seen.node, od.STATUSWORD, raw)}{mark}"
        return f"node {seen.node}: statusword {seen.status}"

    def _overdue(self, seen: NodeSeen) -> bool:
        return self.now >= self._due(seen)

    def _due(self, seen: NodeSeen) -> Nanoseconds:
        """Return when a node's heartbeat is overdue; NEVER where none is expected."""
        period = seen.period
        if seen.missing or period is None or seen.beat_at is None:
            return NEVER
        return seen.beat_at + MISSED * period + 1

    def _missing(self, seen: NodeSeen) -> str:
        seen.missing = True
        period = 0 if seen.period is None else seen.period // MILLISECOND
        return self._wrong(f"node {seen.node}: no heartbeat for more than {MISSED} x {period} ms")

    def _wrong(self, text: str) -> str:
        self.error = Error(self.now, text)
        return text

    def _read(self, packet: Packet) -> tuple[str, str]:
        title, _, reported = self._reader.read("", packet).partition(": ")
        return title, reported

    def _percent(self, bits: int, span: Nanoseconds) -> float:
        return min(100.0, 100.0 * bits * SECOND / self.bit_rate / span) if span else 0.0
