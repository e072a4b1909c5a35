"""Recordings at the seam: candump's log for CAN, .tlog for MAVLink, lines of our own for everything else.

It refuses to open files: it turns packets into text or bytes and back. Instants count from the start of the
run; in a file they count from `EPOCH`, or from the real time at which the run started.
"""

import re
from collections.abc import Callable, Iterator
from enum import Enum
from typing import Final, TypeAlias

from firmware_bridge.node import CAN, Node, Stoppable, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MICROSECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, EXTENDED_MASK, MAX_PAYLOAD, REMOTE, STANDARD_MASK
from firmware_bridge.wire.internet import number_of, place_of

EPOCH: Final[Nanoseconds] = 1_577_836_800 * SECOND
"""Virtual runs start on 1 January 2020, 00:00 UTC, in nanoseconds of Unix time."""

MAVLINK_1: Final = 0xFE
MAVLINK_2: Final = 0xFD
_MAVLINK_1_EXTRA: Final = 8
_MAVLINK_2_EXTRA: Final = 12
_MAVLINK_2_SIGNED: Final = 0x01
_MAVLINK_1_SEQUENCE: Final = 2
_MAVLINK_2_SEQUENCE: Final = 4
_SIGNATURE: Final = 13
_STAMP: Final = 8

_CANDUMP: Final = re.compile(
    r"\((?P<seconds>\d+)\.(?P<fraction>\d{6}|\d{9})\) +(?P<channel>\S+) +"
    r"(?P<id>[0-9A-Fa-f]{8}|[0-9A-Fa-f]{3})#(?:(?P<remote>[Rr])(?P<length>[0-8]?)|(?P<bytes>[0-9A-Fa-f]*))"
    r"(?: +[TR])?\s*"
)
_CHUNK: Final = re.compile(
    r"\((?P<seconds>\d+)\.(?P<fraction>\d{6}|\d{9})\) (?P<link>\S+) (?P<way>[RT])"
    r"(?: (?P<host>\S+):(?P<port>\d+))?(?P<bytes>(?: [0-9A-Fa-f]{2})*)\s*"
)

_MEANT: Final = re.compile(r"\S+ \S+ [RT]( |$)")

DEVICE_SIDE: Final = "~"
_SHOWN: Final = 80
"""So many characters of a line that cannot be read are shown."""


class RecordingError(Exception):
    """A line or a record that cannot be read: which, and what was expected."""


class CutOffError(RecordingError):
    """A recording whose last record is not whole, as after a loss of power."""


class Direction(Enum):
    """Direction of a packet through the seam, seen from the node."""

    RECEIVED = "received"
    SENT = "sent"


Listener: TypeAlias = Callable[[Nanoseconds, Direction, Packet], None]


class Recorded:
    """A node around a node that shows a listener every packet in and out; it changes nothing."""

    def __init__(self, node: Node, listener: Listener) -> None:
        self.node = node
        self._listener = listener

    @property
    def holding(self) -> bool:
        """True while the node keeps the robot from moving after a command to end."""
        return holds(self.node)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Note the packet, pass it on, and note what the node sends."""
        self._listener(now, Direction.RECEIVED, packet)
        return self._noted(self.node.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the node and note what it sends."""
        return self._noted(self.node.wake(now), now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Stop the node, where it can be stopped, and note what it sends; otherwise it is done at once."""
        return self._noted(self.node.stop(now), now) if isinstance(self.node, Stoppable) else Reaction()

    def _noted(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        for packet in reaction.sent:
            self._listener(now, Direction.SENT, packet)
        return reaction


def candump_frame(packet: Packet) -> str:
    """Return a frame as candump writes it, identifier and content: 284#3706, 18DAF110#R8."""
    address = packet.address
    # candump writes an error report with its flag in the eight digits.
    if address & ERROR:
        name = f"{address & (ERROR | EXTENDED_MASK):08X}"
    elif address & EXTENDED:
        name = f"{address & EXTENDED_MASK:08X}"
    else:
        name = f"{address & STANDARD_MASK:03X}"
    length = len(packet.payload)
    # A remote frame has a length code and no bytes: R and the code, which candump leaves out for 0.
    content = f"R{length or ''}" if address & REMOTE else packet.payload.hex().upper()
    return f"{name}#{content}"


def candump_line(at: Nanoseconds, packet: Packet, channel: str = "vcan0", epoch: Nanoseconds = EPOCH) -> str:
    """Return a frame as `candump -l` logs it, without the line's end; instants are cut to microseconds."""
    # Whole microseconds, as `candump -l` writes them: other readers take no more digits.
    seconds, rest = divmod(epoch + at, SECOND)
    return f"({seconds:010d}.{rest // MICROSECOND:06d}) {channel} {candump_frame(packet)}"


def chunk_line(
    at: Nanoseconds, link: str, direction: Direction, packet: Packet, epoch: Nanoseconds = EPOCH
) -> str:
    """Return bytes of a serial line, or a datagram, as a log's line, without its end.

    Instant, link, R or T, the other end's place where the link has several, the bytes in hexadecimal digits.
    Instants are whole: what the bridge makes of an answer depends on when it came.
    """
    seconds, rest = divmod(epoch + at, SECOND)
    mark = "R" if direction is Direction.RECEIVED else "T"
    words = (link, mark, place_of(packet.address), packet.payload.hex(" ").upper())
    return f"({seconds:010d}.{rest:09d}) {' '.join(filter(None, words))}"


def device_side(link: str, kind: str) -> str:
    """Return how a log calls a link that a device has recorded, which speaks `kind`; see `side_of`."""
    return f"{link}{DEVICE_SIDE}{kind}"


def side_of(link: str) -> tuple[str, str | None]:
    """Return a link's own name, and what the device speaks that has recorded it; None for the bridge's log.

    In a device's log R and T are its own: what it received and what it sent.
    """
    name, mark, kind = link.partition(DEVICE_SIDE)
    return name, kind if mark else None


def is_chunk(line: str) -> bool:
    """Return whether a line of text is meant as one of `chunk_line`, though it may be damaged."""
    return _MEANT.match(line) is not None


def parse_chunk(line: str, epoch: Nanoseconds = EPOCH) -> tuple[Nanoseconds, Direction, Packet]:
    """Return what `chunk_line` has written: instant, direction, packet; RecordingError for any other line.

    Instants that are cut to microseconds are taken, too.
    """
    match = _CHUNK.fullmatch(line)
    if match is None:
        raise RecordingError(f"no line of bytes, as '(12.345678000) board T 62 0D': {_shown(line)}")
    address = 0
    if match["host"]:
        try:
            address = number_of(match["host"].strip("[]"), int(match["port"]))
        except ValueError as error:
            raise RecordingError(f"no place '{match['host']}:{match['port']}': {error}") from None
    # Digits behind the point: six are microseconds, nine nanoseconds.
    at = int(match["seconds"]) * SECOND + int(match["fraction"].ljust(9, "0")) - epoch
    direction = Direction.RECEIVED if match["way"] == "R" else Direction.SENT
    return at, direction, Packet(match["link"], address, bytes.fromhex(match["bytes"]))


def _shown(line: str) -> str:
    return repr(line if len(line) <= _SHOWN else line[:_SHOWN] + "...")


def parse_candump(line: str, epoch: Nanoseconds = EPOCH) -> tuple[Nanoseconds, str, Packet]:
    """Return instant, channel and frame of a line of candump's log; RecordingError for any other line."""
    match = _CANDUMP.fullmatch(line)
    if match is None or len(match["bytes"] or "") % 2 or len(match["bytes"] or "") > 2 * MAX_PAYLOAD:
        raise RecordingError(f"not a line of a candump log, like '(12.345678) can0 123#DEADBEEF': {line!r}")
    at = int(match["seconds"]) * SECOND + int(match["fraction"].ljust(9, "0")) - epoch
    address = int(match["id"], 16)
    # The number of digits decides between 11 and 29 bits; the value cannot, as 0x123 may be either.
    if len(match["id"]) > 3 and not address & ERROR:  # noqa: PLR2004 - 3 digits are 11 bits, 8 are 29
        address |= EXTENDED
    if match["remote"]:
        return at, match["channel"], Packet(CAN, address | REMOTE, bytes(int(match["length"] or 0)))
    return at, match["channel"], Packet(CAN, address, bytes.fromhex(match["bytes"]))


def tlog_records(at: Nanoseconds, datagram: bytes, epoch: Nanoseconds = EPOCH) -> bytes:
    """Return a datagram as telemetry log records.

    A record is Unix time in microseconds, 8 bytes big-endian, and one message. Each message of a datagram is
    a record of its own, because a reader expects a time before each. Bytes that are no MAVLink message cannot
    stand in such a log and are left out.
    """
    stamp = ((epoch + at) // MICROSECOND).to_bytes(_STAMP, "big")
    return b"".join(stamp + message for message in mavlink_messages(datagram))


def parse_tlog(log: bytes, epoch: Nanoseconds = EPOCH) -> Iterator[tuple[Nanoseconds, bytes]]:
    """Yield instant and message of each record; RecordingError where the log is broken.

    CutOffError where its last record is not whole.
    """
    start = 0
    while start < len(log):
        end = _message_end(log, start + _STAMP)
        if end is None:
            what = f"no whole MAVLink message at byte {start + _STAMP} of a telemetry log"
            raise CutOffError(what) if _may_begin(log, start + _STAMP) else RecordingError(what)
        at = int.from_bytes(log[start : start + _STAMP], "big") * MICROSECOND - epoch
        yield at, log[start + _STAMP : end]
        start = end


def _may_begin(log: bytes, start: int) -> bool:
    """Return whether what is left may be the begin of a message whose end was never written."""
    return log[start : start + 1] in {b"", bytes((MAVLINK_1,)), bytes((MAVLINK_2,))}


def mavlink_messages(datagram: bytes) -> Iterator[bytes]:
    """Yield the MAVLink messages in a datagram by their lengths; checksums are not looked at."""
    start = 0
    while start < len(datagram):
        end = _message_end(datagram, start)
        # Bytes between messages are passed over one by one, as a receiver does that has lost its place.
        if end is None:
            start += 1
        else:
            yield datagram[start:end]
            start = end


def mavlink_origin(message: bytes) -> tuple[int, int, int]:
    """Return system, component and sequence number of a whole message, from its header."""
    # Version 2 has two bytes of flags before the sequence number.
    at = _MAVLINK_2_SEQUENCE if message[0] == MAVLINK_2 else _MAVLINK_1_SEQUENCE
    sequence, system, component = message[at : at + 3]
    return system, component, sequence


def _message_end(log: bytes, start: int) -> int | None:
    """Return where the message that starts here ends; None if none starts or it is cut off."""
    head = log[start : start + 3]
    if len(head) < 3:  # noqa: PLR2004 - magic, length, flags
        return None
    if head[0] == MAVLINK_1:
        # Header and check sum beside the payload; version 2 has a signature of 13 bytes where bit 0 of its
        # flags is set.
        end = start + _MAVLINK_1_EXTRA + head[1]
    elif head[0] == MAVLINK_2:
        end = start + _MAVLINK_2_EXTRA + head[1] + (_SIGNATURE if head[2] & _MAVLINK_2_SIGNED else 0)
    else:
        return None
    return end if end <= len(log) else None
