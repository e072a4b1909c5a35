"""The commands of maxon's serial protocols, decoded, as packets of their own or from the bytes of a line.

Which of the two protocols a line speaks shows with its first byte: V2's frames begin with DLE.
"""

from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.maxon import v1
from firmware_bridge.families.epos2.maxon.frame import ANSWER, DLE, Failure, Frame
from firmware_bridge.families.epos2.maxon.messages import Answer, Request
from firmware_bridge.families.epos2.maxon.opcodes import COMMANDS, decode_answer, decode_request
from firmware_bridge.families.epos2.maxon.packets import outcome_of
from firmware_bridge.families.epos2.maxon.v2 import Damaged, FrameReader
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE
from firmware_bridge.packet import Packet

_HANDSHAKE: Final = {v1.OKAY: "okay", v1.FAILED: "failed"}
_OBJECT: Final = ("index", "subindex")


def _fields(message: Request | Answer) -> str:
    """Return a message's fields; an object is called by its name."""
    values = {name: getattr(message, name) for name in type(message).__dataclass_fields__}
    texts = []
    if set(_OBJECT) <= set(values):
        texts.append(ANY_TYPE.called(Address(*(values.pop(name) for name in _OBJECT))))
    for name, value in values.items():
        texts.append(f"{name} {value.hex(' ').upper() if isinstance(value, bytes) else value}")
    return ", ".join(texts)


class _Exchange:
    """The commands of one line: an answer is read by its request."""

    def __init__(self) -> None:
        self._request: Request | None = None

    def requested(self, frame: Frame) -> str:
        """Return the decoded text of a command."""
        row = COMMANDS.get(frame.opcode)
        self._request = decode_request(frame)
        name = f"command 0x{frame.opcode:02X}" if row is None else row.name
        if self._request is None:
            return f"{name}: {frame.body.hex(' ').upper() or 'without data'}"
        return f"{name}: {_fields(self._request)}"

    def answered(self, body: bytes) -> str:
        """Return the decoded text of an answer."""
        answer = None if self._request is None else decode_answer(self._request, body)
        return f"answer: {body.hex(' ').upper() if answer is None else _fields(answer)}"


class MaxonCommands:
    """A reader of commands that are packets: see `families.epos2.maxon.packets`."""

    def __init__(self) -> None:
        self._exchange = _Exchange()
        self._asker = ""

    def read(self, sender: str, packet: Packet) -> str:
        """Return the text of a command or its outcome; the first sender is the end that sends requests."""
        self._asker = self._asker or sender
        if sender == self._asker:
            return self._exchange.requested(
                # An odd byte is cut off: a serial frame has whole words.
                Frame(packet.address & 0xFF, packet.payload[: len(packet.payload) & ~1])
            )
        _, outcome = outcome_of(packet)
        if isinstance(outcome, Failure):
            return f"no answer: {outcome.value}"
        return self._exchange.answered(outcome.body)


class _Stream:
    """The bytes of one end of a line."""

    def __init__(self) -> None:
        self._second = FrameReader()
        self._first: v1.Rest | None = None

    def take_v2(self, byte: int) -> Frame | str | None:
        """Take a byte of V2; return a frame, or what has happened."""
        done = self._second.take(byte)
        return "a frame whose check sum is wrong" if isinstance(done, Damaged) else done

    def take_v1(self, byte: int) -> Frame | str | None:
        """Take a byte of V1, where bytes of the handshake stand between frames."""
        if self._first is None:
            # Between frames O and F are acknowledgements; no opcode has these values.
            if byte in _HANDSHAKE:
                return _HANDSHAKE[byte]
            self._first = v1.Rest(byte)
            return None
        if not self._first.take(byte):
            return None
        frame, self._first = self._first.frame(), None
        return "a frame whose check sum is wrong" if frame is None else frame


class MaxonLine:
    """A reader of one line's bytes, both ways."""

    def __init__(self) -> None:
        self._exchange = _Exchange()
        self._streams: dict[str, _Stream] = {}
        self._v2: bool | None = None

    def read(self, sender: str, packet: Packet) -> str:
        """Return what the bytes complete; those of a frame that goes on say so."""
        stream = self._streams.setdefault(sender, _Stream())
        texts = []
        for byte in packet.payload:
            if self._v2 is None:
                # V1 begins with an opcode, and 0x90 is none.
                self._v2 = byte == DLE
            done = stream.take_v2(byte) if self._v2 else stream.take_v1(byte)
            if done is not None:
                texts.append(done if isinstance(done, str) else self._text_of(done))
        return "; ".join(texts) or "part of a frame"

    def _text_of(self, frame: Frame) -> str:
        return (
            self._exchange.answered(frame.body) if frame.opcode == ANSWER else self._exchange.requested(frame)
        )
