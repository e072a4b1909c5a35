"""MWProtocol: what MATLAB's Arduino package and an Arduino say to each other, one row a command.

Source: MathWorks' MWProtocolBase, MWProtocolSerial, MWArduino, MotorShieldV2Base and RotaryEncoderBase
headers and its MWProtocol.m, in the public copies of about 2016 to 2018. No frame was captured from a device.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from struct import Struct
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from firmware_bridge.families.motor_shield.wire import mw_messages as messages

BAUD: Final = 115_200
"""Of a Mega; the host's build defines it."""
BANNER: Final = b"MWProtocol"
"""The banner that a board sends at its start."""
HOST_START: Final = 0x5A
BOARD_START: Final = 0xA5
ANSWER: Final = 0x00
TRACE: Final = 0x01
LARGEST: Final = 800
"""Size in bytes of one message, on a Mega."""
SEQUENCES: Final = 128
BITS: Final = 10
"""Of a byte on the line."""
MOTOR_TAKES_MS: Final = 5
SHIELD_TAKES_MS: Final = 25
"""Time for the board to obey a command and to answer it: one to a motor, and one that makes a shield."""
_IS_LIBRARY: Final = 0x80

CORE: Final = ""
SHIELD: Final = "Adafruit/MotorShieldV2"
ENCODER: Final = "RotaryEncoder"
LIBRARIES: Final = ("I2C", "Servo", SHIELD, ENCODER)
"""The libraries of a board with motors and encoders; an index here is a library's number on the wire."""


Message: TypeAlias = Any


@dataclass(frozen=True, slots=True)
class Shape:
    """Layout of a message in a frame: a dataclass, and the layout of its fields."""

    message: type[Any]
    layout: Struct
    open_ended: bool = False
    """The one field is all bytes that are there."""

    def encode(self, message: Message) -> bytes:
        """Return a message's data; struct.error for a field that does not fit."""
        values = [getattr(message, it.name) for it in fields(self.message)]
        if self.open_ended:
            return bytes(values[0])
        return self.layout.pack(*values)

    def decode(self, data: bytes) -> Message | None:
        """Return the message in some data; None where it is too short. Surplus bytes do not count."""
        if self.open_ended:
            return self.message(data)
        if len(data) < self.layout.size:
            return None
        return self.message(*self.layout.unpack_from(data))


class _InfoShape(Shape):
    """The one answer that is no layout: fields between semicolons."""

    __slots__ = ()

    def encode(self, message: Message) -> bytes:
        # A library's number is its place in this list.
        libraries: bytes = b";".join(bytes((number,)) + name for number, name in enumerate(message.libraries))
        board: bytes = message.board
        head = bytes((message.major, message.minor)) + b";" + board
        return head + b";" + bytes((message.traces,)) + b";" + libraries

    def decode(self, data: bytes) -> Message | None:
        parts = data[3:].split(b";")
        if (
            len(data) < len(b"Mm;")
            or data[2:3] != b";"
            or len(parts) < len(("board", "traces"))
            or not parts[1]
        ):
            return None
        return messages.ServerInfo(
            data[0], data[1], parts[0], parts[1][0], tuple(it[1:] for it in parts[2:] if it)
        )


@dataclass(frozen=True, slots=True)
class MwCommand:
    """One command: its library, its number there, its request and its answer."""

    library: str
    code: int
    name: str
    request: Shape | None
    """None where only the name is known, or where no emulated board has it."""
    answer: Shape
    assumed: str = ""
    """The assumed part of it."""


def _shape(message: type[Any], layout: str = "") -> Shape:
    return Shape(message, Struct(layout))


_DONE: Final = _shape(messages.Done)
_STEPPER: Final = "steppers are not emulated: a board stays silent"

ROWS: Final[tuple[MwCommand, ...]] = (
    MwCommand(
        CORE,
        0x01,
        "getServerInfo",
        _shape(messages.GetServerInfo),
        _InfoShape(messages.ServerInfo, Struct("")),
    ),
    MwCommand(CORE, 0x02, "resetPins", _shape(messages.ResetPins), _DONE),
    MwCommand(CORE, 0x03, "getFreeRAM", _shape(messages.GetFreeRam), _shape(messages.FreeRam, ">H")),
    MwCommand(CORE, 0x10, "writeDigitalPin", _shape(messages.WriteDigital, "<BBB"), _DONE),
    MwCommand(
        CORE, 0x11, "readDigitalPin", _shape(messages.ReadDigital, "<BB"), _shape(messages.Level, "<B")
    ),
    MwCommand(CORE, 0x12, "configureDigitalPin", _shape(messages.ConfigureDigital, "<BBB"), _DONE),
    MwCommand(CORE, 0x20, "writePWMDutyCycle", _shape(messages.WriteDuty, "<BB"), _DONE),
    MwCommand(CORE, 0x21, "writePWMVoltage", _shape(messages.WriteVoltage, "<BB"), _DONE),
    MwCommand(CORE, 0x22, "playTone", _shape(messages.PlayTone, "<BHH"), _DONE),
    MwCommand(CORE, 0x30, "readVoltage", _shape(messages.ReadVoltage, "<B"), _shape(messages.Voltage, ">H")),
    MwCommand(SHIELD, 0x00, "createMotorShield", _shape(messages.CreateShield, "<BBH"), _DONE),
    MwCommand(SHIELD, 0x01, "deleteMotorShield", _shape(messages.DeleteShield, "<B"), _DONE),
    MwCommand(SHIELD, 0x02, "createDCMotor", _shape(messages.CreateMotor, "<BB"), _DONE),
    MwCommand(SHIELD, 0x03, "startDCMotor", _shape(messages.StartMotor, "<BBBB"), _DONE),
    MwCommand(SHIELD, 0x04, "stopDCMotor", _shape(messages.StopMotor, "<BB"), _DONE),
    MwCommand(SHIELD, 0x05, "setSpeedDCMotor", _shape(messages.SetMotorSpeed, "<BBBB"), _DONE),
    MwCommand(SHIELD, 0x06, "createStepper", None, _DONE, _STEPPER),
    MwCommand(SHIELD, 0x07, "releaseStepper", None, _DONE, _STEPPER),
    MwCommand(SHIELD, 0x08, "moveStepper", None, _DONE, _STEPPER),
    MwCommand(SHIELD, 0x09, "setSpeedStepper", None, _DONE, _STEPPER),
    MwCommand(ENCODER, 0x01, "attachEncoder", _shape(messages.AttachEncoder, "<BBB"), _DONE),
    MwCommand(ENCODER, 0x02, "detachEncoder", _shape(messages.DetachEncoder, "<B"), _DONE),
    MwCommand(ENCODER, 0x03, "setDelay", _shape(messages.SetDelay, "<BB"), _DONE, "the request's layout"),
    MwCommand(ENCODER, 0x04, "readCount", _shape(messages.ReadCount, "<BB"), _shape(messages.Count, "<iIb")),
    MwCommand(
        ENCODER,
        0x05,
        "readSpeed",
        Shape(messages.ReadSpeed, Struct(""), open_ended=True),
        Shape(messages.Speeds, Struct(""), open_ended=True),
        "the request's layout: a list of encoders, without a count",
    ),
    MwCommand(ENCODER, 0x06, "writeCount", _shape(messages.WriteCount, "<Bi"), _DONE),
)

COMMANDS: Final[Mapping[tuple[str, int], MwCommand]] = MappingProxyType(
    {(it.library, it.code): it for it in ROWS}
)
_BY_REQUEST: Final = {row.request.message: row for row in ROWS if row.request}


def row_of(request: Message) -> MwCommand:
    """Return the row of a request."""
    return _BY_REQUEST[type(request)]


def checksum(data: bytes) -> int:
    """Return the byte that makes a sum of 0 with these."""
    return -sum(data) & 0xFF


@dataclass(frozen=True, slots=True)
class RequestFrame:
    """A request as it was framed: its number in the host's sequence, its library, its code, its data."""

    sequence: int
    library: int | None
    code: int
    data: bytes


def encode_frame(request: RequestFrame) -> bytes:
    """Return a frame of the host; ValueError for what is no byte, struct.error for too much data."""
    is_library = request.library is not None
    # Bit 7 marks a library's command; the sequence has the other seven bits.
    head = bytes((request.sequence % SEQUENCES | (_IS_LIBRARY if is_library else 0),))
    body = (
        head + (bytes((request.library or 0,)) if is_library else b"") + bytes((request.code,)) + request.data
    )
    # The length counts everything behind itself, the check sum included, low byte first.
    counted = Struct("<H").pack(len(body) + 1) + body
    return bytes((HOST_START,)) + counted + bytes((checksum(counted),))


def decode_frame(size: bytes, body: bytes) -> RequestFrame | None:
    """Return what is in the two bytes of size and the bytes that they count; None for damage."""
    # Size, body and check sum add up to 0 modulo 256.
    if not body or checksum(size + body[:-1]) != body[-1]:
        return None
    is_library = bool(body[0] & _IS_LIBRARY)
    head = 3 if is_library else 2
    if len(body) <= head:
        return None
    library = body[1] if is_library else None
    return RequestFrame(body[0] % SEQUENCES, library, body[head - 1], body[head:-1])


def apart(frame: bytes, *, line_rate: int, milliseconds: int) -> bytes:
    """Return a frame with noughts behind it for so long, in which it is obeyed and answered.

    What has come when an answer goes is thrown away: the next frame must come later.
    """
    # A zero is no start byte, so the board drops it, and the line keeps the time by its bytes: ten bits each.
    return frame + bytes(line_rate * milliseconds // BITS // 1000)


class RequestReader:
    """The board's end: it takes bytes and finds requests. Time is not known here: see `forget`."""

    def __init__(self) -> None:
        self._frame = bytearray()

    @property
    def waits(self) -> bool:
        """True while a frame has begun that is not whole."""
        return bool(self._frame)

    def take(self, byte: int) -> RequestFrame | None:
        """Take one byte; return the request that it completes. Damage, and what is too large, is dropped."""
        if not self._frame and byte != HOST_START:
            return None
        self._frame.append(byte)
        if len(self._frame) < len("Zss"):
            return None
        size = bytes(self._frame[1:3])
        count = int.from_bytes(size, "little")
        # A size beyond the buffer ends the frame here; to wait for its bytes would block the line.
        if count <= LARGEST and len(self._frame) < len("Zss") + count:
            return None
        body = bytes(self._frame[3:])
        self.forget()
        return None if count > LARGEST else decode_frame(size, body)

    def forget(self) -> None:
        """Drop half a frame: its next byte has not come in time."""
        self._frame.clear()


def row_of_frame(request: RequestFrame, libraries: Sequence[str] = LIBRARIES) -> MwCommand | None:
    """Return the row that a request names, on a board with these libraries; None for one that has none."""
    if request.library is None:
        return COMMANDS.get((CORE, request.code))
    if request.library >= len(libraries):
        return None
    return COMMANDS.get((libraries[request.library], request.code))


def encode_request(request: Message, sequence: int, libraries: Sequence[str] = LIBRARIES) -> bytes:
    """Return the frame of a request; ValueError for a library not there, struct.error for a bad field."""
    row = row_of(request)
    if row.library and row.library not in libraries:
        raise ValueError(
            f"the board has no library '{row.library}'; it has: {', '.join(libraries) or 'none'}"
        )
    library = list(libraries).index(row.library) if row.library else None
    assert row.request is not None  # noqa: S101 - it was found by its request
    return encode_frame(RequestFrame(sequence, library, row.code, row.request.encode(request)))


def encode_answer(code: int, data: bytes) -> bytes:
    """Return a frame of the board."""
    # High byte first, unlike the host's frames; the length counts code, data and check sum.
    counted = Struct(">H").pack(len(data) + 2) + bytes((code,)) + data
    return bytes((BOARD_START, ANSWER)) + counted + bytes((checksum(counted),))


@dataclass(frozen=True, slots=True)
class MwAnswer:
    """An answer as it was framed: the command's code, and data that its row's shape reads."""

    code: int
    data: bytes


@dataclass(frozen=True, slots=True)
class Traced:
    """A text line of the board for people."""

    text: bytes


class AnswerReader:
    """The host's end: it takes bytes and finds answers, whatever is between them."""

    def __init__(self) -> None:
        self.damaged = 0
        """Frames with a wrong check sum."""
        self._waiting = bytearray()

    def receive(self, chunk: bytes) -> Iterator[MwAnswer | Traced]:
        """Take bytes; yield what they complete."""
        self._waiting += chunk
        while True:
            start = self._waiting.find(BOARD_START)
            del self._waiting[: start if start >= 0 else len(self._waiting)]
            if len(self._waiting) < len("SK"):
                return
            if self._waiting[1] == TRACE:
                found: tuple[MwAnswer | Traced, ...] | None = self._trace()
            elif self._waiting[1] == ANSWER:
                found = self._answer()
            else:
                del self._waiting[0]
                continue
            if found is None:
                return
            if found:
                yield found[0]

    def _trace(self) -> tuple[Traced, ...] | None:
        """Return the line that is there, in a tuple; None while it is not whole."""
        if len(self._waiting) < len("SKn") or len(self._waiting) < len("SKn") + self._waiting[2]:
            return None
        return (Traced(self._cut(len("SKn"), len("SKn") + self._waiting[2])),)

    def _answer(self) -> tuple[MwAnswer, ...] | None:
        """Return the answer that is there, in a tuple; an empty one for damage, None for half an answer."""
        if len(self._waiting) < len("SKss"):
            return None
        size = int.from_bytes(self._waiting[2:4], "big")
        # A size that no frame has is noise that looks like a start.
        if not len("cC") <= size <= LARGEST:
            del self._waiting[0]
            return ()
        end = len("SKss") + size
        if len(self._waiting) < end:
            return None
        if checksum(bytes(self._waiting[2 : end - 1])) != self._waiting[end - 1]:
            self.damaged += 1
            # Only the start byte goes: a good answer may begin within the damaged one.
            del self._waiting[0]
            return ()
        body = self._cut(len("SKss"), end)
        return (MwAnswer(body[0], body[1:-1]),)

    def _cut(self, begin: int, end: int) -> bytes:
        body = bytes(self._waiting[begin:end])
        del self._waiting[:end]
        return body


def decode_answer(request: Message, answered: MwAnswer) -> Message | None:
    """Return the answer to a request; None where it answers another one, or is too short."""
    row = row_of(request)
    return row.answer.decode(answered.data) if answered.code == row.code else None
