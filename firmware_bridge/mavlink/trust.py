"""Trust in frames: those from allowed places, and signed ones where there is a key.

Source: mavlink.io, "Message Signing". A time stamp counts only when its signature is right: pymavlink's own
check takes it before, so that one wrong frame with the largest stamp would lock its station out for ever.
"""

import hashlib
import hmac
import ipaddress
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, TypeAlias

from firmware_bridge.mavlink.frames import Codec, Message
from firmware_bridge.units import SECOND, Nanoseconds
from firmware_bridge.wire.internet import host_and_port

KEY_LENGTH: Final = 32
EPOCH: Final[Nanoseconds] = 1_420_070_400 * SECOND
"""1 January 2015, from which signatures count, in Unix time."""
UNIT: Final[Nanoseconds] = 10_000
OLDEST: Final = 60 * SECOND // UNIT
"""So far a stream that is new here may be behind our clock."""
_SIGNED: Final = 0x01
_FLAGS: Final = 2
_MAVLINK_2: Final = 0xFD
_LINK, _STAMP, _SIGNATURE = -13, -12, -6
"""Offsets from the end; no slices, which compiled code does not take for an index of bytes."""

Stream: TypeAlias = tuple[int, int, int]
"""Of signed frames: system, component and link."""


@dataclass(frozen=True, slots=True)
class Stamps:
    """Stamps that must outlive a restart, so that no message is accepted twice and no stamp is used again."""

    own: int = 0
    """Later than every stamp of ours."""
    clock: int = 0
    """Our own clock's last reading, whatever time stations have sent."""
    streams: Mapping[Stream, int] = field(default_factory=dict)
    """The newest stamp that was accepted, by stream."""


NO_STAMPS: Final = Stamps()

Network: TypeAlias = ipaddress.IPv4Network | ipaddress.IPv6Network


@dataclass(frozen=True, slots=True, kw_only=True)
class Trust:
    """Trust by the command line; without a key signatures are not checked, without a list all may send."""

    key: bytes | None = None
    started_at: Nanoseconds = EPOCH
    """Unix time at the node's instant 0."""
    allowed: tuple[Network, ...] = ()
    kept: Stamps = NO_STAMPS
    """From the run before."""

    def __post_init__(self) -> None:
        if self.key is not None and len(self.key) != KEY_LENGTH:
            raise ValueError(f"a key has {KEY_LENGTH} bytes, not {len(self.key)}")

    def stamp(self, now: Nanoseconds) -> int:
        """Return an instant as signatures carry it."""
        return max(self.started_at + now - EPOCH, 0) // UNIT

    def allows(self, source: int) -> bool:
        """Return whether a place may speak; the other end of a link that has one may."""
        if not self.allowed or source == 0:
            return True
        address = ipaddress.ip_address(host_and_port(source)[0])
        # A socket of IP version 6 shows a host of version 4 as ::ffff:a.b.c.d.
        mapped = getattr(address, "ipv4_mapped", None)
        return any((mapped or address) in network for network in self.allowed)

    def writer(self, system: int, component: int, link: int) -> Codec:
        """Return a codec that signs what it writes, where there is a key."""
        return Codec(system, component, None if self.key is None else (self.key, link))


ANY_STATION: Final = Trust()
"""Without a key, and from everywhere."""


class Signatures:
    """Newest time stamp of each stream: no message is accepted twice, after a restart neither."""

    __slots__ = ("_clock", "_least", "_streams", "_trust")

    def __init__(self, trust: Trust) -> None:
        self._trust: Final = trust
        self._streams: Final[dict[Stream, int]] = dict(trust.kept.streams)
        """The newest stamp by system, component and link; who has no key cannot add one."""
        self._least = trust.kept.own
        """Least start of our stamps at the instant 0, though the machine's clock is behind that."""
        self._clock: Final = trust.kept.clock
        """Least reading of our clock then, though the machine's has been set back since."""

    def stamp(self, now: Nanoseconds) -> int:
        """Return the time as our signatures carry it: never behind one of ours, or one that was accepted."""
        return max(self._trust.stamp(now), self._least + now // UNIT)

    def clock(self, now: Nanoseconds) -> int:
        """Return our own time: a station whose clock is ahead does not change it, and locks no one out."""
        return max(self._trust.stamp(now), self._clock + now // UNIT)

    def kept(self, now: Nanoseconds) -> Stamps:
        """Return what must outlive this run."""
        return Stamps(self.stamp(now), self.clock(now), dict(self._streams))

    def doubt(self, message: Message, source: int, now: Nanoseconds) -> str | None:
        """Return why a frame is untrusted; None where it is trusted, and its stamp counts from then on."""
        if not self._trust.allows(source):
            return "is not on the list of --allow"
        key, frame = self._trust.key, bytes(message.get_msgbuf())
        if key is None:
            return None
        if not is_signed(frame):
            return "is not signed"
        # SHA-256 over key, frame, link and time stamp; its first six bytes are the signature (MAVLink 2).
        digest = hashlib.sha256(key + frame[:_SIGNATURE]).digest()
        # Compared in constant time, so that no answer time reveals how many bytes were right.
        if not hmac.compare_digest(digest[:6], frame[_SIGNATURE:]):
            return "is signed with another key"
        stamp = stamp_of(frame)
        stream = (message.get_srcSystem(), message.get_srcComponent(), frame[_LINK])
        # A stream that is new here may be 60 s behind our clock at most, or a recording would begin one.
        newest = self._streams.get(stream, self.clock(now) - OLDEST - 1)
        if stamp <= newest:
            known = stream in self._streams
            return (
                "was received before, or overtaken"
                if known
                else "is signed more than 60 s ago: see its clock"
            )
        # Only now, behind the signature: a forged stamp must not lock its station out.
        self._streams[stream] = stamp
        # MAVLink's rule: an accepted stamp that is ahead raises our own.
        self._least = max(self._least, stamp - now // UNIT)
        return None


def stamp_of(frame: bytes) -> int:
    """Return the time stamp of a signed frame, in 10 us since 1 January 2015."""
    return int.from_bytes(frame[_STAMP:_SIGNATURE], "little")


def is_signed(frame: bytes) -> bool:
    """Return whether a frame carries a signature."""
    return frame[0] == _MAVLINK_2 and bool(frame[_FLAGS] & _SIGNED)
