"""MAVLink frames in and out of datagrams, with pymavlink's message classes, and their sequence numbers.

Each datagram stands alone: pymavlink's own stream parser keeps the tail of a broken datagram and swallows the
next one with it, so datagrams are cut into frames here (framing: mavlink.io, "Packet Serialization").
The dialect is `all`: `common` lacks AVAILABLE_MODES and CURRENT_MODE, and what ArduPilot's stations ask.
It loads in 0.05 s of processor time, 0.02 s more than `common`, and only where MAVLink is spoken.
"""

import re
from collections import deque
from collections.abc import Container
from dataclasses import dataclass
from typing import Any, Final, NamedTuple, TypeAlias

from pymavlink.dialects.v20 import all as everything

from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

dialect: Final[Any] = everything
"""pymavlink's constants and message classes, which carry no types."""

Message: TypeAlias = Any
"""One of pymavlink's message objects."""

ANYONE: Final = 0
"""The broadcast target, for systems and for components."""

# pymavlink reads MAV_IGNORE_CRC from the environment. A robot obeys no frame with a wrong checksum.
dialect.MAVLINK_IGNORE_CRC = 0

_START: Final = re.compile(rb"[\xfd\xfe]")
_MAVLINK_2: Final = 0xFD
_MAVLINK_1: Final = 0xFE
_MAVLINK_2_OVERHEAD: Final = 12
_MAVLINK_1_OVERHEAD: Final = 8
_MAVLINK_1_HEADER: Final = 6
_MAVLINK_1_NUMBERS: Final = 0x100
_CHECKSUM: Final = 2
_SIGNED: Final = 0x01
_SIGNATURE_LENGTH: Final = 13

_NUMBERS: Final = 0x100
_HALF: Final = 0x80
"""Of all sequence numbers; one that is so many or more behind is ahead."""
OUT_OF_ORDER: Final[Nanoseconds] = 250 * MILLISECOND
"""Time for which an older sequence number is taken for an overtaken datagram, not for a new start."""
OVERTAKEN: Final[Nanoseconds] = 3 * SECOND
"""The same for one only a few behind: a "go" that comes 0.26 s after the stop is no new start."""
FEW: Final = 96
"""Frames of a station in three seconds, at 30 frames a second."""
LOSS_OVER: Final[Nanoseconds] = 5 * SECOND
LEAST: Final = 5
"""So often the numbers go back to one that was used before two stations are seen in that ..."""
WITHIN: Final[Nanoseconds] = 3 * SECOND
"""... in this time; a station that begins again does it once."""
FAR: Final = 64
"""A step back by more than this: a frame that so many others have overtaken would be too old to count.

Nearer ones look like a link that delivers late, until a number comes again.
"""
FAR_LEAST: Final = 3
"""So often the numbers go back that far before two stations are seen in that ..."""
FAR_WITHIN: Final[Nanoseconds] = SECOND
"""... in this time."""
GONE: Final[Nanoseconds] = 2 * SECOND
"""Silence after which a station is gone, or has begun again."""
NEAR: Final = 32
"""A number so far ahead at most is of the station whose newest frame that was: others were lost."""
KEPT: Final = 300


WITHOUT_EXTENSIONS: Final = {
    dialect.MAVLINK_MSG_ID_SYS_STATUS: 31,
    dialect.MAVLINK_MSG_ID_GPS_RAW_INT: 30,
    dialect.MAVLINK_MSG_ID_MISSION_COUNT: 4,
    dialect.MAVLINK_MSG_ID_MISSION_ACK: 3,
    dialect.MAVLINK_MSG_ID_COMMAND_ACK: 3,
    dialect.MAVLINK_MSG_ID_TIMESYNC: 16,
    dialect.MAVLINK_MSG_ID_BATTERY_STATUS: 36,
    dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION: 60,
    dialect.MAVLINK_MSG_ID_HOME_POSITION: 52,
    dialect.MAVLINK_MSG_ID_STATUSTEXT: 51,
}
"""Payload size in MAVLink 1, of the sent messages that have extensions (common.xml, `extensions`)."""


@dataclass(slots=True)
class Counters:
    """Count of received frames: good ones, runs of bytes that are no frame, and unknown messages."""

    frames: int = 0
    corrupt: int = 0
    unknown: int = 0


class Codec:
    """One end of a link, under one system and component number, with its own sequence."""

    def __init__(self, system: int, component: int, signs: tuple[bytes, int] | None = None) -> None:
        """Write under these numbers; `signs` is the key and the link's number of what is to be signed."""
        self.system = system
        self.component = component
        self.counters = Counters()
        self._mavlink = dialect.MAVLink(None, srcSystem=system, srcComponent=component)
        if signs is not None:
            signing = self._mavlink.signing
            signing.secret_key, signing.link_id = signs
            signing.sign_outgoing = True

    def encode(self, message: Message, stamp: int = 0) -> bytes:
        """Return the message as one frame, with the next sequence number.

        One that is signed carries `stamp`, or the next one after the frame before, if that is newer.
        """
        signing = self._mavlink.signing
        # A stamp is never used twice; pymavlink adds 1 for each frame.
        signing.timestamp = max(signing.timestamp, stamp)
        frame: bytes = message.pack(self._mavlink)
        self._mavlink.seq = (self._mavlink.seq + 1) & 0xFF
        return frame

    def encode_1(self, message: Message) -> bytes | None:
        """Return the message as one frame of MAVLink 1, unsigned; None where that cannot carry it."""
        if message.get_msgId() >= _MAVLINK_1_NUMBERS:
            return None
        frame: bytes = message.pack(self._mavlink, force_mavlink1=True)
        self._mavlink.seq = (self._mavlink.seq + 1) & 0xFF
        # MAVLink 1 has no extensions: they are cut off, and the check sum is computed again.
        length: int = WITHOUT_EXTENSIONS.get(message.get_msgId(), type(message).unpacker.size)
        if frame[1] == length:
            return frame
        kept = bytes((length,)) + frame[2 : _MAVLINK_1_HEADER + length]
        checksum = dialect.x25crc(kept + bytes((message.crc_extra,))).crc
        return b"".join((frame[:1], kept, int(checksum).to_bytes(_CHECKSUM, "little")))

    def decode(self, datagram: bytes, wanted: Container[int] | None = None) -> list[Message]:
        """Return the messages of a datagram in their order; anything else is counted and skipped.

        With `wanted`, only messages with these numbers are unpacked and returned. Signatures are not checked.
        """
        found: list[Message] = []
        counters = self.counters
        at = 0
        in_step = True
        while at < len(datagram):
            size, number = _frame_at(datagram, at)
            message = self._unpack(datagram[at : at + size], number, wanted) if size else None
            if message is None:
                if in_step:
                    counters.corrupt += 1
                    in_step = False
                # From the next start byte on: the length of a damaged frame cannot be trusted.
                start = _START.search(datagram, at + 1)
                at = start.start() if start else len(datagram)
                continue
            in_step = True
            at += size
            if message is not _SKIPPED:
                found.append(message)
        return found

    def _unpack(self, frame: bytes, number: int, wanted: Container[int] | None) -> Message | None:
        if number not in dialect.mavlink_map:
            self.counters.unknown += 1  # its checksum needs the definition that we lack
            return _SKIPPED
        if wanted is not None and number not in wanted:
            self.counters.frames += 1
            return _SKIPPED
        try:
            message = self._mavlink.decode(bytearray(frame))
        except dialect.MAVError:
            return None
        self.counters.frames += 1
        return message


_SKIPPED: Final = object()


def _frame_at(datagram: bytes, at: int) -> tuple[int, int]:
    """Return a frame's length and message number; (0, 0) where no whole frame can begin."""
    left = len(datagram) - at
    if datagram[at] == _MAVLINK_2 and left >= _MAVLINK_2_OVERHEAD:
        flags = datagram[at + 2]
        size = _MAVLINK_2_OVERHEAD + datagram[at + 1] + (_SIGNATURE_LENGTH if flags & _SIGNED else 0)
        # A frame with an unknown incompatibility flag must be dropped (mavlink.io, Packet Serialization).
        if flags & ~_SIGNED == 0 and size <= left:
            return size, int.from_bytes(datagram[at + 7 : at + 10], "little")
    elif datagram[at] == _MAVLINK_1 and left >= _MAVLINK_1_OVERHEAD:
        size = _MAVLINK_1_OVERHEAD + datagram[at + 1]
        if size <= left:
            return size, datagram[at + 5]
    return 0, 0


def speaks_mavlink_1(message: Message) -> bool:
    """Return whether a message came in a frame of MAVLink 1."""
    return bool(message.get_msgbuf()[0] == _MAVLINK_1)


def concerns(message: Message, system: int, component: int) -> bool:
    """Return whether a message is for this system and component: by name, to all, or without a target."""
    part = message.target_component if "target_component" in message.get_fieldnames() else ANYONE
    return target_of(message) in (ANYONE, system) and part in (ANYONE, component)


def target_of(message: Message) -> int:
    """Return the system that a message is for; `ANYONE` for all of them, or where it names none."""
    fields: list[str] = message.get_fieldnames()
    if "target_system" in fields:
        return int(message.target_system)
    return int(message.target) if "target" in fields else ANYONE


def text_of(field: bytes | str) -> str:
    """Return a text field up to its first NUL; what is not ASCII is shown as a question mark."""
    raw = field.encode("latin-1", "replace") if isinstance(field, str) else field
    return raw.split(b"\0", 1)[0].decode("ascii", "replace").replace("\ufffd", "?")


class Sequenced(NamedTuple):
    """A frame by its sequence number, and when it came."""

    sequence: int
    at: Nanoseconds

    def follows(self, sequence: int) -> bool:
        """Return whether this frame comes after one with another number, as far as eight bits show."""
        return 0 < (self.sequence - sequence) % _NUMBERS < _HALF

    def overtook(self, sequence: int, now: Nanoseconds) -> bool:
        """Return whether a frame that comes now was sent before this one."""
        behind = (self.sequence - sequence) % _NUMBERS
        late = OVERTAKEN if behind <= FEW else OUT_OF_ORDER
        return behind < _HALF and now - self.at < late


class Losses:
    """Missing share of a station's frames, from the gaps in its sequence numbers."""

    __slots__ = ("_came", "_missing", "_newest", "_until", "share")

    def __init__(self) -> None:
        self._newest: int | None = None
        self._came = 0
        self._missing = 0
        self._until: Nanoseconds = 0
        self.share: float | None = None
        """Of the last five seconds that are over; None before."""

    def received(self, sequence: int, now: Nanoseconds) -> None:
        """Take note of a frame; one that comes late is missing no more, one that comes twice counts once."""
        if self._newest is None:
            self._until = now + LOSS_OVER
        elif now >= self._until:
            self.share = self._missing / max(self._missing + self._came, 1)
            self._came = self._missing = 0
            self._until = now + LOSS_OVER
        # Eight bits: more than half of the numbers ahead is behind.
        ahead = 1 if self._newest is None else (sequence - self._newest) % _NUMBERS
        if 0 < ahead < _HALF:
            self._missing += ahead - 1
            self._newest = sequence
            self._came += 1
        # It was counted as missing, and came late.
        elif ahead and self._missing:
            self._missing -= 1
            self._came += 1


class FrameNumbers:
    """Sequence numbers of one system and component at one place, and whether two stations send them.

    Behind a router both come from one place. A station numbers its frames one after the other; of two the
    numbers go back and forth: by further than a frame is overtaken on its way, or, where the two are near, to
    a number that was used, with another content. A frame that is doubled or overtaken does not look so.
    """

    __slots__ = ("_back", "_far", "_first", "_newest", "_next", "_received", "_second", "two")

    def __init__(self) -> None:
        self._newest: tuple[int, int] | None = None
        """The newest frame's number, and the same counted on over its eight bits."""
        self._received: Final[dict[int, int]] = {}
        """The content of the newest frames, by their numbers as they are counted on."""
        self._back: Final[deque[Nanoseconds]] = deque(maxlen=LEAST)
        """Times of the returns to a number that was used."""
        self._far: Final[deque[Nanoseconds]] = deque(maxlen=FAR_LEAST)
        """Times of the steps far back."""
        self._first: tuple[int, Nanoseconds] | None = None
        self._second: tuple[int, Nanoseconds] | None = None
        """The newest frame of who was there first, and of who came later."""
        self._next = -1
        """The first station's next expected number before its newest gap."""
        self.two = False
        """True where two stations send."""

    def receive(self, number: int, content: int, now: Nanoseconds) -> bool:
        """Take a frame, its content as a checksum; return whether it is of the station that came later."""
        if self._newest is None:
            self._newest = number, number
        # To the nearest of the 256 numbers, forwards or backwards.
        step = (number - self._newest[0] + _HALF) % _NUMBERS - _HALF
        place = self._newest[1] + step
        before = self._received.get(place)
        # The same number and the same bytes: the network has sent it twice.
        if before == content:
            return False  # the network has doubled it
        # The same number with other bytes: one station does not count like that.
        if before is not None and step <= 0:
            self._back.append(now)
        if step < -FAR:
            self._far.append(now)
        self._newest = number, place
        self._received[place] = content
        if len(self._received) > KEPT:
            del self._received[next(iter(self._received))]
        back, far = self._back, self._far
        again = len(back) == LEAST and now - back[0] <= WITHIN
        self.two = again or (len(far) == FAR_LEAST and now - far[0] <= FAR_WITHIN)
        return self._is_later(number, now) and self.two

    def _is_later(self, number: int, now: Nanoseconds) -> bool:
        """Return of whom a frame is: of whose newest one it follows next."""
        first = self._first
        if first is None or now - first[1] > GONE:
            first, self._second = self._second or ((number - 1) % _NUMBERS, now), None
        second, newest = self._second, (number, now)
        # How far the number is behind each station's next one; the nearer one has sent it.
        after_first = (number - first[0] - 1) % _NUMBERS
        after_second = _NUMBERS if second is None else (number - second[0] - 1) % _NUMBERS
        later = after_first >= NEAR or after_second < after_first
        if later and second is None and number == self._next:
            # What looked like lost frames of the first was another one that had joined ahead of it.
            self._first, self._second, later = newest, first, False
        else:
            self._next = (first[0] + 1) % _NUMBERS if after_first else self._next
            self._first, self._second = (first, newest) if later else (newest, second)
        return later
