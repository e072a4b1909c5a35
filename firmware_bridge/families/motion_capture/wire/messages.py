"""Messages beside frames and models: numbers and lengths, server identity, and connection requests.

Source: NatNetTypes.h and the clients of the NatNet SDK, and the recorded output of a Motive 2.1. UDP, little
endian; commands at port 1510, frames from port 1511.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from struct import Struct
from typing import Final

from firmware_bridge.families.motion_capture.wire.layout import (
    V3_0,
    FieldRow,
    NatNetError,
    Number,
    Padded,
    Reader,
    RecordLayout,
    Version,
    known,
)

COMMAND_PORT: Final = 1510
DATA_PORT: Final = 1511
GROUP: Final = (239, 255, 42, 99)
LARGEST: Final = 65_507
"""Largest datagram in bytes."""
OK: Final = 0
"""An answer's number for a command that was done."""


class MessageId(IntEnum):
    """The first number of a packet."""

    CONNECT = 0
    SERVERINFO = 1
    REQUEST = 2
    RESPONSE = 3
    REQUEST_MODELDEF = 4
    MODELDEF = 5
    REQUEST_FRAMEOFDATA = 6
    FRAMEOFDATA = 7
    MESSAGESTRING = 8
    DISCONNECT = 9
    KEEPALIVE = 10
    DISCONNECTBYTIMEOUT = 11
    ECHOREQUEST = 12
    ECHORESPONSE = 13
    DISCOVERY = 14
    UNRECOGNIZED_REQUEST = 100
    """Its payload is whatever was in the buffer."""


_HEAD: Final = Struct("<HH")
_IDS: Final[Mapping[int, MessageId]] = {int(it): it for it in MessageId}


def packet(message: MessageId, payload: bytes = b"") -> bytes:
    """Return a whole packet; NatNetError for a payload that no datagram holds."""
    if len(payload) > LARGEST - _HEAD.size:
        raise NatNetError(f"{message.name}: {len(payload)} bytes are more than a datagram holds")
    return _HEAD.pack(message, len(payload)) + payload


def split(datagram: bytes) -> tuple[MessageId, bytes]:
    """Return a packet's message and payload; NatNetError. What is behind the payload does not count."""
    if len(datagram) < _HEAD.size:
        raise NatNetError(f"{len(datagram)} bytes are no packet: its head alone has {_HEAD.size}")
    number, size = _HEAD.unpack_from(datagram)
    message = _IDS.get(number)
    if message is None:
        raise NatNetError(f"message {number} is not known")
    if size > len(datagram) - _HEAD.size:
        raise NatNetError(f"{message.name} announces {size} bytes, and {len(datagram) - _HEAD.size} came")
    return message, datagram[_HEAD.size : _HEAD.size + size]


Bytes4 = tuple[int, int, int, int]


@dataclass(frozen=True, slots=True)
class ServerInfo:
    """Server identity: application, both versions, and from 3.0 on its clock and the source of frames."""

    name: str
    application: Bytes4
    natnet: Bytes4
    ticks_per_s: int = 0
    data_port: int = DATA_PORT
    multicast: int = 0
    group: Bytes4 = GROUP

    @property
    def version(self) -> Version:
        """The layout of what it sends."""
        return Version(*self.natnet[:2])


_NAME: Final = 256
_BYTES4: Final = Number("4B")
_SENDER: Final = (
    FieldRow("name", Padded(_NAME)),
    FieldRow("application", _BYTES4),
    FieldRow("natnet", _BYTES4),
)
SERVER_INFO: Final = RecordLayout(
    ServerInfo,
    *_SENDER,
    FieldRow("ticks_per_s", Number("Q"), since=V3_0),
    FieldRow("data_port", Number("H"), since=V3_0),
    FieldRow("multicast", Number("B"), since=V3_0),
    FieldRow("group", _BYTES4, since=V3_0),
)
_VERSION_AT: Final = _NAME + 4


def server_info(payload: bytes) -> ServerInfo:
    """Return the server's identity, in the layout of the version that it reports; NatNetError."""
    if len(payload) < _VERSION_AT + 4:
        raise NatNetError(f"server info has {len(payload)} bytes, at least {_VERSION_AT + 4} are needed")
    # The layout depends on the version within the message, which lies at a fixed place in all of them.
    version = known(Version(payload[_VERSION_AT], payload[_VERSION_AT + 1]))
    info: ServerInfo = SERVER_INFO.read(Reader(payload, version), "server info")
    return info


def server_info_payload(info: ServerInfo) -> bytes:
    """Return the payload of server info."""
    return SERVER_INFO.write(info, known(info.version), "server info")


@dataclass(frozen=True, slots=True)
class Connect:
    """A request for frames: the client, and the version of the stream; None where none is given."""

    name: str = ""
    application: Bytes4 = (0, 0, 0, 0)
    natnet: Bytes4 = (0, 0, 0, 0)
    wants: Bytes4 | None = None


CONNECT: Final = RecordLayout(Connect, *_SENDER)
_OPTIONS: Final = Struct("<B4B")


def connect_payload(connect: Connect) -> bytes:
    """Return a client's request to be served; with `wants` in the form that Motive 3 understands."""
    payload = CONNECT.write(connect, V3_0, "connect")
    return payload if connect.wants is None else payload + _OPTIONS.pack(0, *connect.wants)


def connected(payload: bytes) -> Connect:
    """Return the client that requests frames; its payload may be empty, a part, or whole."""
    size = _VERSION_AT + 4
    if len(payload) < size:
        return Connect()
    sender: Connect = CONNECT.read(Reader(payload[:size], V3_0), "connect")
    if len(payload) < size + _OPTIONS.size:
        return sender
    _, *wants = _OPTIONS.unpack_from(payload, size)
    return Connect(sender.name, sender.application, sender.natnet, (wants[0], wants[1], wants[2], wants[3]))


_RESULT: Final = Struct("<i")
_FLOAT: Final = Struct("<f")


def result_payload(result: int) -> bytes:
    """Return the result of a command."""
    return _RESULT.pack(result)


def measure_payload(value: float) -> bytes:
    """Return the answer to a question for a measure."""
    return _FLOAT.pack(value)


def text_payload(text: str) -> bytes:
    """Return a command, or an answer as text."""
    return text.encode("utf-8", "surrogateescape") + b"\0"


def text_of(payload: bytes) -> str:
    """Return the text before the NUL."""
    return payload.partition(b"\0")[0].decode("utf-8", "surrogateescape")


_STAMP: Final = Struct("<Q")
_STAMPS: Final = Struct("<QQ")


def echo_payload(request: bytes, ticks: int) -> bytes:
    """Return the answer to a request for the time: the client's own stamp and the server's; NatNetError."""
    if len(request) < _STAMP.size:
        raise NatNetError(f"an echo request has {len(request)} bytes, {_STAMP.size} are needed")
    return request[: _STAMP.size] + _STAMP.pack(ticks)


def echo_of(payload: bytes) -> tuple[int, int]:
    """Return the client's stamp and the server's ticks; NatNetError."""
    if len(payload) < _STAMPS.size:
        raise NatNetError(f"an echo has {len(payload)} bytes, {_STAMPS.size} are needed")
    client, server = _STAMPS.unpack_from(payload)
    return client, server


def echo_request(stamp: int) -> bytes:
    """Return the payload of a request for the server's time, with a stamp of one's own."""
    return _STAMP.pack(stamp)
