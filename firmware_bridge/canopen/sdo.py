"""SDO frames, both directions: expedited and segmented transfers.

Source: CiA 301 v4.02, service data object. No object is known here, and no transfer's state is kept:
`emulators.canopen.sdo_server` and the bridge's client keep it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from struct import Struct
from typing import Final, TypeAlias

from firmware_bridge.canopen.abort import AbortCode, SdoAbort, meaning_of
from firmware_bridge.canopen.address import Address

__all__ = [
    "NOWHERE",
    "Abort",
    "AbortCode",
    "DownloadRequest",
    "DownloadResponse",
    "Request",
    "Response",
    "SdoAbort",
    "SdoSegment",
    "SegmentAccepted",
    "Unknown",
    "UploadRequest",
    "UploadResponse",
    "UploadSegmentRequest",
    "decode_request",
    "decode_response",
    "encode_abort",
    "encode_download",
    "encode_download_announcement",
    "encode_download_response",
    "encode_download_segment",
    "encode_download_segment_response",
    "encode_download_unsized",
    "encode_upload",
    "encode_upload_response",
    "encode_upload_segment",
    "encode_upload_segment_response",
    "meaning_of",
]

FRAME: Final = 8
HEAD: Final = 4
"""Command byte, index and sub-index."""
EXPEDITED: Final = 4
"""Most bytes of an expedited transfer."""
SEGMENT: Final = 7
"""Most bytes of a segment."""
NOWHERE: Final = Address(0, 0)
"""The address in an abort that belongs to no transfer."""

_HEAD: Final = Struct("<BHB")
_KEPT: Final = 4096
"""So many requests are kept decoded, for clients ask the same again and again."""
_TOGGLE: Final = 0x10
_EXPEDITED: Final = 0x02
_SIZED: Final = 0x01
_LAST: Final = 0x01
_DOWNLOAD: Final = 0x20
_UPLOAD: Final = 0x40
_UPLOAD_SEGMENT: Final = 0x60
_ABORT: Final = 0x80
_DOWNLOAD_SEGMENT_DONE: Final = 0x20
_DOWNLOAD_DONE: Final = 0x60


@dataclass(frozen=True, slots=True)
class UploadRequest:
    """A request to read an object."""

    address: Address


@dataclass(frozen=True, slots=True)
class DownloadRequest:
    """A request to write an object: at once with `raw`, or with segments to come when `raw` is None.

    `size` in bytes is None where the client does not give it; `raw` then holds every byte of the frame's
    data.
    """

    address: Address
    raw: bytes | None
    size: int | None


@dataclass(frozen=True, slots=True)
class UploadSegmentRequest:
    """A request for the next segment."""

    toggle: bool


@dataclass(frozen=True, slots=True)
class SdoSegment:
    """Up to seven bytes, in either direction."""

    toggle: bool
    raw: bytes
    last: bool


@dataclass(frozen=True, slots=True)
class Abort:
    """Either side gives up; the code is a plain number, since a foreign node may send any."""

    address: Address
    code: int


@dataclass(frozen=True, slots=True)
class Unknown:
    """A frame that is no transfer of this codec, or is cut off before its address ends."""

    address: Address


@dataclass(frozen=True, slots=True)
class UploadResponse:
    """The server's answer to a read: the bytes at once, or None with segments to come; size if given."""

    address: Address
    raw: bytes | None
    size: int | None


@dataclass(frozen=True, slots=True)
class DownloadResponse:
    """The server took the object, or waits for its segments."""

    address: Address


@dataclass(frozen=True, slots=True)
class SegmentAccepted:
    """The server took a segment."""

    toggle: bool


Request: TypeAlias = UploadRequest | DownloadRequest | UploadSegmentRequest | SdoSegment | Abort | Unknown
Response: TypeAlias = UploadResponse | DownloadResponse | SegmentAccepted | SdoSegment | Abort | Unknown


def _frame(command: int, address: Address, rest: bytes = b"") -> bytes:
    return (_HEAD.pack(command, *address) + rest).ljust(FRAME, b"\0")


def _address(payload: bytes) -> Address:
    # A frame that is cut short is answered with the address as far as it came.
    padded = payload if len(payload) >= HEAD else payload.ljust(HEAD, b"\0")
    return Address(padded[1] | padded[2] << 8, padded[3])


def encode_upload(address: Address) -> bytes:
    """Ask to read an object."""
    return _frame(_UPLOAD, address)


def encode_upload_segment(*, toggle: bool) -> bytes:
    """Ask for the next segment; the first has toggle False."""
    return bytes((_UPLOAD_SEGMENT | toggle * _TOGGLE,)).ljust(FRAME, b"\0")


def encode_download(address: Address, raw: bytes) -> bytes:
    """Write an object: up to four bytes at once, more as the announcement of segments."""
    # An expedited transfer cannot carry 0 bytes: its size field counts the bytes without content.
    if 0 < len(raw) <= EXPEDITED:
        # Bits 2 and 3: how many of the four data bytes are without content (CiA 301).
        return _frame(_DOWNLOAD | (EXPEDITED - len(raw)) << 2 | _EXPEDITED | _SIZED, address, raw)
    return encode_download_announcement(address, len(raw))


def encode_download_unsized(address: Address, raw: bytes) -> bytes:
    """Write an object with four bytes of which the server takes as many as it has."""
    return _frame(_DOWNLOAD | _EXPEDITED, address, raw.ljust(EXPEDITED, b"\0"))


def encode_download_announcement(address: Address, size: int) -> bytes:
    """Announce the segments of a download, however short it is."""
    return _frame(_DOWNLOAD | _SIZED, address, size.to_bytes(4, "little"))


def encode_download_segment(raw: bytes, *, toggle: bool, last: bool) -> bytes:
    """Send up to seven bytes of a download; the first segment has toggle False."""
    return _segment(raw, toggle=toggle, last=last)


def encode_abort(address: Address, code: int) -> bytes:
    """Give up a transfer, from either side."""
    return _frame(_ABORT, address, code.to_bytes(4, "little"))


def encode_upload_response(address: Address, raw: bytes) -> bytes:
    """Answer a read: up to four bytes at once, more (or none at all) as the announcement of segments."""
    if 0 < len(raw) <= EXPEDITED:
        return _frame(_UPLOAD | (EXPEDITED - len(raw)) << 2 | _EXPEDITED | _SIZED, address, raw)
    return _frame(_UPLOAD | _SIZED, address, len(raw).to_bytes(4, "little"))


def encode_upload_segment_response(raw: bytes, *, toggle: bool, last: bool) -> bytes:
    """Send up to seven bytes of an upload."""
    return _segment(raw, toggle=toggle, last=last)


def encode_download_response(address: Address) -> bytes:
    """Say that the object is written, or that its segments may come."""
    return _frame(_DOWNLOAD_DONE, address)


def encode_download_segment_response(*, toggle: bool) -> bytes:
    """Say that a segment was taken."""
    return bytes((_DOWNLOAD_SEGMENT_DONE | toggle * _TOGGLE,)).ljust(FRAME, b"\0")


def _segment(raw: bytes, *, toggle: bool, last: bool) -> bytes:
    if len(raw) > SEGMENT:
        raise ValueError(f"a segment carries at most {SEGMENT} bytes, not {len(raw)}")
    # CiA 301: toggle in bit 4, bytes without data in bits 1 to 3, "no more segments" in bit 0.
    command = toggle * _TOGGLE | (SEGMENT - len(raw)) << 1 | last * _LAST
    return (bytes((command,)) + raw).ljust(FRAME, b"\0")


def _decode_segment(payload: bytes) -> SdoSegment:
    command = payload[0]
    size = SEGMENT - (command >> 1 & 7)
    return SdoSegment(bool(command & _TOGGLE), payload[1 : 1 + size], bool(command & _LAST))


def _contents(payload: bytes) -> tuple[bytes | None, int | None]:
    """Return bytes (None: segments follow) and size (None: not given) of a frame that starts a transfer."""
    command = payload[0]
    if command & _EXPEDITED:
        # Without the size bit all four bytes count, and the server takes as many as its object has.
        size = EXPEDITED - (command >> 2 & 3) if command & _SIZED else None
        return payload[HEAD : HEAD + (EXPEDITED if size is None else size)], size
    return None, int.from_bytes(payload[HEAD:FRAME], "little") if command & _SIZED else None


def _decode_abort(payload: bytes) -> Abort:
    return Abort(_address(payload), int.from_bytes(payload[HEAD:FRAME], "little"))


def _decode_toggle(payload: bytes) -> bool:
    return bool(payload[0] & _TOGGLE)


_REQUESTS: Final[Mapping[int, Callable[[bytes], Request]]] = {
    0: _decode_segment,
    1: lambda payload: DownloadRequest(_address(payload), *_contents(payload)),
    2: lambda payload: UploadRequest(_address(payload)),
    3: lambda payload: UploadSegmentRequest(_decode_toggle(payload)),
    4: _decode_abort,
}
_RESPONSES: Final[Mapping[int, Callable[[bytes], Response]]] = {
    0: _decode_segment,
    1: lambda payload: SegmentAccepted(_decode_toggle(payload)),
    2: lambda payload: UploadResponse(_address(payload), *_contents(payload)),
    3: lambda payload: DownloadResponse(_address(payload)),
    4: _decode_abort,
}
"""Command specifier, the first three bits of a frame, to the reading of it."""
_WITHOUT_ADDRESS: Final = (0, 3)
"""Requests that need no more than their first byte."""


@lru_cache(maxsize=_KEPT)
def decode_request(payload: bytes) -> Request:
    """Return a client's request; frames shorter than their address, and unknown ones, are `Unknown`.

    Beyond the address a short frame is read as far as it goes: `raw` may then hold less than `size`.
    """
    # An empty frame gets a specifier that no service has.
    specifier = payload[0] >> 5 if payload else len(_REQUESTS)
    decode = _REQUESTS.get(specifier)
    if decode is None or (len(payload) < HEAD and specifier not in _WITHOUT_ADDRESS):
        return Unknown(_address(payload))
    return decode(payload)


def decode_response(payload: bytes) -> Response:
    """Return what a server answers; anything that is no answer, or is cut short, is `Unknown`."""
    # A server always sends eight bytes; a shorter frame is no answer of a CANopen device.
    decode = _RESPONSES.get(payload[0] >> 5) if len(payload) >= FRAME else None
    return Unknown(_address(payload)) if decode is None else decode(payload)
