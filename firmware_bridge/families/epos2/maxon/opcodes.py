"""The commands of the serial protocols, one row each, and the codecs that come from the rows.

An answer always has its command's full layout, also on error: of
ReadObject maxon's library set-points it, for the others it is an assumption.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from struct import Struct
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.canopen.object_row import Provenance
from firmware_bridge.families.epos2.maxon import messages
from firmware_bridge.families.epos2.maxon.frame import Frame, Generation
from firmware_bridge.families.epos2.maxon.messages import Answer, Done, Request
from firmware_bridge.families.epos2.wire.rows import LIBRARY
from firmware_bridge.units import MILLISECOND, Nanoseconds

NMT_SERVICE: Final = 0x0E
COMMUNICATION_GUIDE: Final = "EPOS Communication Guide, October 2006 (EPOS1)"
BOTH: Final = frozenset(Generation)
V2_ONLY: Final = frozenset({Generation.V2})
_Message: TypeAlias = type[Any]


@dataclass(frozen=True, slots=True)
class Shape:
    """Layout of a message on the wire: a dataclass and the layout of its fields, low byte first."""

    message: _Message
    layout: Struct
    open_ended: bool = False
    """The last field takes all bytes behind the layout; it is padded to whole words."""

    def encode(self, message: object) -> bytes:
        """Return a message's bytes; ValueError or struct.error for a field that does not fit."""
        values = [getattr(message, name) for name in self.message.__dataclass_fields__]
        rest = values.pop() if self.open_ended else b""
        body = self.layout.pack(*values) + rest
        # The serial frames carry whole words of 16 bits.
        return body + bytes(len(body) % 2)

    def decode(self, body: bytes) -> Any | None:
        """Return the message in `body`; None where it is too short. Surplus bytes do not count."""
        size = self.layout.size
        if len(body) < size:
            return None
        values = self.layout.unpack_from(body)
        return self.message(*values, body[size:]) if self.open_ended else self.message(*values)

    def refusal(self, error: int) -> bytes:
        """Return an answer of the full layout with an error code, zero otherwise."""
        # maxon's library reports a framing error for an answer of four bytes, and loses the abort code.
        size = self.layout.size
        return error.to_bytes(4, "little") + bytes(size + size % 2 - 4)


@dataclass(frozen=True, slots=True)
class Opcode:
    """One command: its opcode, its request and answer, and the lines on which it is answered."""

    opcode: int
    name: str
    request: Shape | None
    """None where only the name is known; a device does not know such a command (assumed)."""
    answer: Shape
    answered: frozenset[Generation] = BOTH
    source: str = LIBRARY
    provenance: Provenance = Provenance.DOCUMENTED


def _shape(message: _Message, layout: str, *, open_ended: bool = False) -> Shape:
    return Shape(message, Struct("<" + layout), open_ended)


_DONE: Final = _shape(Done, "I")
_FRAME: Final = _shape(messages.FrameRead, "I8s")
_BY_NAME: Final = "a name in maxon's command library, never sent"

ROWS: Final[tuple[Opcode, ...]] = (
    Opcode(NMT_SERVICE, "SendNMTService", _shape(messages.SendNmtService, "HH"), _DONE, V2_ONLY),
    Opcode(0x10, "ReadObject", _shape(messages.ReadObject, "HBB"), _shape(messages.ObjectRead, "I4s")),
    Opcode(0x11, "WriteObject", _shape(messages.WriteObject, "HBB4s"), _DONE),
    Opcode(
        0x12,
        "InitiateSegmentedRead",
        _shape(messages.InitiateSegmentedRead, "HBB"),
        _DONE,
        source=COMMUNICATION_GUIDE,
        provenance=Provenance.BY_ANALOGY,
    ),
    Opcode(0x13, "InitiateSegmentedWrite", _shape(messages.InitiateSegmentedWrite, "HBBI"), _DONE),
    Opcode(
        0x14,
        "SegmentRead",
        _shape(messages.SegmentRead, "BB"),
        _shape(messages.SegmentOut, "IB", open_ended=True),
        source=COMMUNICATION_GUIDE,
        provenance=Provenance.BY_ANALOGY,
    ),
    Opcode(
        0x15,
        "SegmentWrite",
        _shape(messages.SegmentWrite, "B", open_ended=True),
        _shape(messages.SegmentTaken, "IBB"),
    ),
    Opcode(0x16, "AbortSegmentedTransfer", None, _DONE, source=_BY_NAME, provenance=Provenance.ASSUMED),
    Opcode(0x20, "SendCANFrame", _shape(messages.SendCanFrame, "HH8s"), _DONE, V2_ONLY),
    Opcode(0x21, "RequestCANFrame", _shape(messages.RequestCanFrame, "HH"), _FRAME),
    Opcode(0x22, "ReadCANFrame", None, _FRAME, source=_BY_NAME, provenance=Provenance.ASSUMED),
    Opcode(
        0x30,
        "SendLSSFrame",
        _shape(messages.SendLssFrame, "8s"),
        _DONE,
        source=COMMUNICATION_GUIDE,
        provenance=Provenance.BY_ANALOGY,
    ),
    Opcode(
        0x31,
        "ReadLSSFrame",
        _shape(messages.ReadLssFrame, "H"),
        _FRAME,
        source=COMMUNICATION_GUIDE,
        provenance=Provenance.BY_ANALOGY,
    ),
)

_RESETS: Final = frozenset({NmtCommand.RESET_NODE, NmtCommand.RESET_COMMUNICATION})
RESETS_WITHIN: Final[Nanoseconds] = 100 * MILLISECOND
"""Assumed, to be verified: time for a device to acknowledge a reset all the same, or to reject it."""

COMMANDS: Final[Mapping[int, Opcode]] = MappingProxyType({row.opcode: row for row in ROWS if row.request})
"""Commands that a device knows, by opcode."""
_BY_REQUEST: Final = {row.request.message: row for row in ROWS if row.request}


def row_of(request: Request) -> Opcode:
    """Return the row of a request."""
    return _BY_REQUEST[type(request)]


def acknowledged(frame: Frame) -> bool:
    """Return whether a device acknowledges the command: not where it resets a node, or communication.

    Source: comments in maxon's own library for PCs, which takes the silence for success. Assumed: the same
    holds for a node behind the gateway.
    """
    if frame.opcode != NMT_SERVICE:
        return True
    request = decode_request(frame)
    return not isinstance(request, messages.SendNmtService) or request.command not in _RESETS


def encode_request(request: Request) -> Frame:
    """Return a request's frame; struct.error for a field that does not fit."""
    row = row_of(request)
    return Frame(row.opcode, b"" if row.request is None else row.request.encode(request))


def decode_request(frame: Frame) -> Request | None:
    """Return the request in a frame; None for an unknown command, or one that is too short."""
    row = COMMANDS.get(frame.opcode)
    request: Request | None = None if row is None or row.request is None else row.request.decode(frame.body)
    return request


def encode_answer(request: Request, answer: Answer) -> bytes:
    """Return the data of an answer's frame."""
    return row_of(request).answer.encode(answer)


def decode_answer(request: Request, body: bytes) -> Answer | None:
    """Return the answer in a frame's data; None where it is too short to be one.

    Where only an error code came, as to a frame that the line refuses, that is `Done` for every request.
    """
    answer: Answer | None = row_of(request).answer.decode(body)
    # A frame that the line itself refuses is answered by the code alone.
    return _DONE.decode(body) if answer is None else answer


def encode_refusal(opcode: int, error: int) -> bytes:
    """Return the data of an error answer, in the full layout of the command's answer where it is known."""
    row = COMMANDS.get(opcode)
    return (_DONE if row is None else row.answer).refusal(error)
