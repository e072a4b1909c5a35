"""Frames of a capture file, pcap or pcapng, whose link type is SocketCAN (227): Wireshark's, tcpdump's.

Sources: the pcap and pcapng drafts of the IETF's opsawg group; LINKTYPE_CAN_SOCKETCAN of the tcpdump group.
"""

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeAlias

from firmware_bridge.recording import EPOCH
from firmware_bridge.units import SECOND, Nanoseconds
from firmware_bridge.wire.can import MAX_PAYLOAD, REMOTE

SOCKETCAN: Final = 227
_PCAPNG: Final = 0x0A0D0D0A
_PCAPNG_ORDER: Final = 0x1A2B3C4D
_PCAP_TICKS: Final = {0xA1B2C3D4: 1_000_000, 0xA1B23C4D: 1_000_000_000}
"""Ticks in a second, by the file's first number."""
_PCAP_HEAD: Final = 24
_PCAP_RECORD: Final = 16
_BLOCK_HEAD: Final = 8
_SMALLEST_BLOCK: Final = 12
_INTERFACE: Final = 1
_PACKET: Final = 6
_NAME: Final = 2
_RESOLUTION: Final = 9
_BINARY: Final = 0x80
"""Of a resolution: a power of 2, not of 10."""
_CAN_HEAD: Final = 8
"""Identifier with the most significant byte first, length, three bytes of flags and none."""
_CUT: Final = "its end is cut off"

Found: TypeAlias = tuple[Nanoseconds, str, int, bytes]
Note: TypeAlias = Callable[[str], None]


class CaptureError(Exception):
    """A file that is no capture of a CAN bus: the reason."""


@dataclass(frozen=True, slots=True)
class _Interface:
    link_type: int
    name: str
    ticks: int
    """In a second."""


def frames(path: Path, note: Note) -> Iterator[Found]:
    """Yield instant, bus, address and payload of each classic frame; CaptureError for another file."""
    data = path.read_bytes()
    first = struct.unpack_from("<I", data)[0] if len(data) >= _BLOCK_HEAD else 0
    if first == _PCAPNG:
        return _pcapng(data, note)
    for order in "<>":
        if len(data) >= _PCAP_HEAD and struct.unpack_from(f"{order}I", data)[0] in _PCAP_TICKS:
            return _pcap(data, order, note)
    raise CaptureError("it begins like no pcap and no pcapng file; save the capture again")


def _pcap(data: bytes, order: str, note: Note) -> Iterator[Found]:
    magic = struct.unpack_from(f"{order}I", data)[0]
    # The upper bits give the length of a frame check sequence, where there is one.
    link_type = struct.unpack_from(f"{order}I", data, 20)[0] & 0x0FFF_FFFF
    interface = _Interface(_checked(link_type), "can0", _PCAP_TICKS[magic])
    place = _PCAP_HEAD
    while place + _PCAP_RECORD <= len(data):
        seconds, fraction, length = struct.unpack_from(f"{order}III", data, place)
        place += _PCAP_RECORD
        if place + length > len(data):
            break
        yield from _frame(interface, seconds * interface.ticks + fraction, data[place : place + length], note)
        place += length
    if place != len(data):
        note(_CUT)


def _pcapng(data: bytes, note: Note) -> Iterator[Found]:
    interfaces: list[_Interface] = []
    place, order, any_frame = 0, "<", False
    while place + _SMALLEST_BLOCK <= len(data):
        kind, length = struct.unpack_from(f"{order}II", data, place)
        if kind == _PCAPNG:
            order, interfaces = _order(data, place), []
            length = struct.unpack_from(f"{order}I", data, place + 4)[0]
        if length < _SMALLEST_BLOCK or place + length > len(data):
            break
        body = data[place + _BLOCK_HEAD : place + length - 4]
        place += length
        if kind == _INTERFACE:
            interfaces.append(_interface(body, order, len(interfaces)))
        elif kind == _PACKET:
            any_frame = True
            yield from _packet(body, order, interfaces, note)
    if place == len(data):
        return
    if not any_frame:
        raise CaptureError("its end is cut off before the first frame; save the capture again")
    note(_CUT)


def _order(data: bytes, place: int) -> str:
    for order in "<>":
        if struct.unpack_from(f"{order}I", data, place + _BLOCK_HEAD)[0] == _PCAPNG_ORDER:
            return order
    raise CaptureError("a pcapng section without its byte-order number; save the capture again")


def _interface(body: bytes, order: str, number: int) -> _Interface:
    link_type, name, ticks = struct.unpack_from(f"{order}H", body)[0], f"can{number}", 1_000_000
    for code, value in _options(body[_CAN_HEAD:], order):
        if code == _NAME:
            name = value.decode("utf-8", errors="replace").rstrip("\0") or name
        elif code == _RESOLUTION and value:
            ticks = 2 ** (value[0] & ~_BINARY) if value[0] & _BINARY else 10 ** value[0]
    return _Interface(link_type, name, ticks)


def _options(body: bytes, order: str) -> Iterator[tuple[int, bytes]]:
    place = 0
    while place + 4 <= len(body):
        code, length = struct.unpack_from(f"{order}HH", body, place)
        if not code:
            return
        yield code, body[place + 4 : place + 4 + length]
        # Options are padded to whole words.
        place += 4 + (length + 3 & ~3)


def _packet(body: bytes, order: str, interfaces: list[_Interface], note: Note) -> Iterator[Found]:
    if len(body) < 20:  # noqa: PLR2004 - interface, two halves of the instant, two lengths
        raise CaptureError("a packet block without its lengths; save the capture again")
    number, high, low, length = struct.unpack_from(f"{order}IIII", body)
    if number >= len(interfaces):
        raise CaptureError(f"a packet of interface {number}, which is not described; save the capture again")
    interface = interfaces[number]
    _checked(interface.link_type)
    yield from _frame(interface, high << 32 | low, body[20 : 20 + length], note)


def _frame(interface: _Interface, ticks: int, record: bytes, note: Note) -> Iterator[Found]:
    if len(record) < _CAN_HEAD:
        note("a record without a frame is left out")
        return
    address, length = struct.unpack_from(">IB", record)
    if length > MAX_PAYLOAD:
        note("a CAN FD frame is left out")
        return
    at = ticks * SECOND // interface.ticks - EPOCH
    payload = bytes(length) if address & REMOTE else record[_CAN_HEAD : _CAN_HEAD + length]
    yield at, interface.name, address, payload


def _checked(link_type: int) -> int:
    if link_type != SOCKETCAN:
        raise CaptureError(
            f"its link type is {link_type}, not {SOCKETCAN} (SocketCAN); capture on one interface, as can0"
        )
    return link_type
