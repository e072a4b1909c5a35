"""MAVLink frames in and out of datagrams, with pymavlink's message classes; knows no robot, no socket.

Each datagram stands alone: pymavlink's own stream parser keeps the tail of a broken datagram and swallows the
next one with it, so datagrams are cut into frames here (framing: mavlink.io, "Packet Serialization").
The dialect is `all`: `common` lacks AVAILABLE_MODES and CURRENT_MODE, and what ArduPilot's stations ask.
It loads in 0.05 s of processor time, 0.02 s more than `common`, and only where MAVLink is spoken.
"""

import re
from collections.abc import Container
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from pymavlink.dialects.v20 import all as everything

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
    name = next((one for one in ("target_system", "target") if one in fields), None)
    system: int = ANYONE if name is None else getattr(message, name)
    return system


def text_of(field: bytes | str) -> str:
    """Return a text field up to its first NUL; what is not ASCII is shown as a question mark."""
    raw = field.encode("latin-1", "replace") if isinstance(field, str) else field
    return raw.split(b"\0", 1)[0].decode("ascii", "replace").replace("\ufffd", "?")
