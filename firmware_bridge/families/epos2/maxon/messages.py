"""Requests and answers of the serial protocols' commands, field by field in the order on the wire.

Source: maxon's command library; EPOS Communication Guide, October 2006 (EPOS1).
"""

from dataclasses import dataclass
from typing import Final, Protocol, TypeAlias

from firmware_bridge.canopen.address import Address

DIRECT_SEGMENT: Final = 63
"""Most bytes of a segment on the serial line."""
_LENGTH: Final = 0x3F
_TOGGLE: Final = 0x40
_MORE: Final = 0x80


def control(length: int, *, toggle: bool, more: bool = False) -> int:
    """Return a segment's control byte; the first segment has toggle False."""
    if not 0 <= length <= DIRECT_SEGMENT:
        raise ValueError(f"a segment carries at most {DIRECT_SEGMENT} bytes, not {length}")
    return length | toggle * _TOGGLE | more * _MORE


class _WithControlByte(Protocol):
    @property
    def control(self) -> int: ...


def toggle_of(segment: _WithControlByte) -> bool:
    """Return the toggle bit of a segment's control byte."""
    return bool(segment.control & _TOGGLE)


def more_of(segment: _WithControlByte) -> bool:
    """Return whether more segments follow."""
    return bool(segment.control & _MORE)


def length_of(segment: _WithControlByte) -> int:
    """Return how many bytes a segment carries, by its control byte."""
    return segment.control & _LENGTH


@dataclass(frozen=True, slots=True)
class SendNmtService:
    """Send a network command to a node, 0 for all."""

    node: int
    command: int


@dataclass(frozen=True, slots=True)
class ReadObject:
    """Read an object of up to four bytes. Node 0 is the drive on the line."""

    index: int
    subindex: int
    node: int


@dataclass(frozen=True, slots=True)
class WriteObject:
    """Write an object of up to four bytes; `raw` is always four, low byte first."""

    index: int
    subindex: int
    node: int
    raw: bytes


@dataclass(frozen=True, slots=True)
class InitiateSegmentedRead:
    """Begin to read an object of any length."""

    index: int
    subindex: int
    node: int


@dataclass(frozen=True, slots=True)
class InitiateSegmentedWrite:
    """Begin to write an object of `length` bytes."""

    index: int
    subindex: int
    node: int
    length: int


@dataclass(frozen=True, slots=True)
class SegmentRead:
    """Ask for the next segment; `control` holds the toggle bit."""

    control: int
    pad: int = 0


@dataclass(frozen=True, slots=True)
class SegmentWrite:
    """Send the next segment; `control` holds its length, the toggle bit, and whether more follow."""

    control: int
    raw: bytes
    """With the pad byte, where there is one, when it comes from a line."""


@dataclass(frozen=True, slots=True)
class SendCanFrame:
    """Put a frame on the CAN bus; `raw` is always eight bytes."""

    identifier: int
    length: int
    raw: bytes


@dataclass(frozen=True, slots=True)
class RequestCanFrame:
    """Request a frame from the CAN bus by a remote frame."""

    identifier: int
    length: int


@dataclass(frozen=True, slots=True)
class SendLssFrame:
    """Send eight bytes to the slaves of the layer setting services."""

    raw: bytes


@dataclass(frozen=True, slots=True)
class ReadLssFrame:
    """Wait for a slave's answer, `timeout` in ms."""

    timeout: int


@dataclass(frozen=True, slots=True)
class Done:
    """Nothing but an error code, 0 for success."""

    error: int


@dataclass(frozen=True, slots=True)
class ObjectRead:
    """Four bytes, also on error; those beyond the object's size mean nothing."""

    error: int
    raw: bytes


@dataclass(frozen=True, slots=True)
class SegmentOut:
    """A segment of an object."""

    error: int
    control: int
    raw: bytes
    """With the pad byte, where there is one, when it comes from a line."""


@dataclass(frozen=True, slots=True)
class SegmentTaken:
    """Number of bytes taken, with the toggle bit."""

    error: int
    control: int
    pad: int = 0


@dataclass(frozen=True, slots=True)
class FrameRead:
    """Eight bytes of a frame on the CAN bus, also on error."""

    error: int
    raw: bytes


ObjectRequest: TypeAlias = ReadObject | WriteObject | InitiateSegmentedRead | InitiateSegmentedWrite
Request: TypeAlias = (
    ObjectRequest
    | SendNmtService
    | SegmentRead
    | SegmentWrite
    | SendCanFrame
    | RequestCanFrame
    | SendLssFrame
    | ReadLssFrame
)
Answer: TypeAlias = Done | ObjectRead | SegmentOut | SegmentTaken | FrameRead


def address_of(request: ObjectRequest) -> Address:
    """Return the object that a request is about."""
    return Address(request.index, request.subindex)
