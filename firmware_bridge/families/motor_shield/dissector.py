"""Traffic on the line to an Arduino board, decoded: one class for each protocol, both ways.

The end named bridge sends requests; any other is the board. However the line is cut into chunks, each command
is shown once, with the chunk that ends it.
"""

from collections.abc import Iterator
from dataclasses import fields
from typing import Any, Final

from firmware_bridge.dissector.lines import UNREAD, BoardLine, called
from firmware_bridge.families.motor_shield.wire import arduinoio, firmata, motor_shield, mw
from firmware_bridge.families.motor_shield.wire import mw_messages as messages
from firmware_bridge.families.motor_shield.wire import ros_arduino_bridge as ros
from firmware_bridge.wire.lines import LineReader

LINE_FEED: Final = b"\n"
NO_RETURN: Final = "part of a line: the sketch waits for a carriage return (CR), a line feed ends none"


class RosLine(BoardLine):
    """ros_arduino_bridge: letters and decimal words, an answer by its command."""

    def __init__(self) -> None:
        self._commands = LineReader(ros.END)
        self._answers = LineReader()
        self._request = ""

    def to_board(self, chunk: bytes) -> Iterator[str]:
        """Yield a command's name, and its numbers as they are."""
        for line in self._commands.receive(chunk):
            # The sketch takes the last character before the first space: a line feed does no harm.
            letter, _, words = line.lstrip(LINE_FEED).decode("ascii", "replace").partition(" ")
            row = ros.COMMANDS.get(letter)
            self._request = "" if row is None else f" to {row.name}"
            yield called(UNREAD if row is None else row.name, words if row else repr(line.decode("latin-1")))
        if self._commands.waiting.lstrip(LINE_FEED).endswith(LINE_FEED):
            yield NO_RETURN

    def from_board(self, chunk: bytes) -> Iterator[str]:
        """Yield answers as they are."""
        for line in self._answers.receive(chunk):
            yield f"answer{self._request}: {line.decode('ascii', 'replace')}"


class ArduinoIoLine(BoardLine):
    """ArduinoIO: a letter and single bytes, a number back."""

    def __init__(self) -> None:
        self._commands = arduinoio.CommandReader()
        self._answers = LineReader()
        self._request = ""

    def to_board(self, chunk: bytes) -> Iterator[str]:
        """Yield a command's name, and what followed; a direction as its letter."""
        for byte in chunk:
            command = self._commands.take(byte)
            if command is None:
                continue
            if command.row.answers:
                self._request = f" to {command.row.name}"
            letters = command.row.letter == "B"
            values = [
                f"{kind.name} {chr(value) if letters and kind is arduinoio.RAW else value}"
                for kind, value in zip(command.row.follows, command.values, strict=True)
            ]
            yield called(f"{command.row.letter}, {command.row.name}", ", ".join(values))

    def from_board(self, chunk: bytes) -> Iterator[str]:
        """Yield numbers."""
        for line in self._answers.receive(chunk):
            number = arduinoio.decode(line)
            yield f"answer{self._request}: {repr(line.decode('latin-1')) if number is None else number}"


class MwLine(BoardLine):
    """MWProtocol: frames, an answer by its command, libraries by the numbers that the board has reported."""

    def __init__(self) -> None:
        self._commands = mw.RequestReader()
        self._answers = mw.AnswerReader()
        self._libraries: tuple[str, ...] = mw.LIBRARIES
        self._received = b""
        """The newest bytes of the board: its banner may come in parts."""
        self._request: Any = None

    def to_board(self, chunk: bytes) -> Iterator[str]:
        """Yield a command's number in the host's sequence, its name and fields."""
        for byte in chunk:
            command = self._commands.take(byte)
            if command is None:
                continue
            row = mw.row_of_frame(command, self._libraries)
            shape = None if row is None else row.request
            self._request = None if shape is None else shape.decode(command.data)
            name = f"command 0x{command.code:02X}" if row is None else row.name
            raw = command.data.hex(" ").upper()
            yield called(
                f"#{command.sequence} {name}", raw if self._request is None else _fields(self._request)
            )
        if self._commands.waits:
            yield "part of a frame"

    def from_board(self, chunk: bytes) -> Iterator[str]:
        """Yield answers and texts for people."""
        # Enough of the last bytes for a banner that began in an earlier chunk.
        self._received = (self._received + chunk)[-len(mw.BANNER) - len(chunk) + 1 :]
        if mw.BANNER in self._received:
            self._received = b""
            yield "the board has begun"
        damaged = self._answers.damaged
        for found in self._answers.receive(chunk):
            yield self._traced(found) if isinstance(found, mw.Traced) else self._answered(found)
        if self._answers.damaged > damaged:
            yield "a frame whose check sum is wrong"

    def _traced(self, found: mw.Traced) -> str:
        return f"trace: {found.text.decode('ascii', 'replace')}"

    def _answered(self, found: mw.MwAnswer) -> str:
        answer = None if self._request is None else mw.decode_answer(self._request, found)
        if answer is None:
            return called(f"answer to command 0x{found.code:02X}", found.data.hex(" ").upper())
        if isinstance(answer, messages.ServerInfo):
            self._libraries = tuple(name.decode("ascii", "replace") for name in answer.libraries)
        return called(f"answer to {mw.row_of(self._request).name}", _fields(answer))


class FirmataLine(BoardLine):
    """Firmata: messages either way, writes to the shield's chip as what they do to a motor."""

    def __init__(self) -> None:
        self._commands = firmata.Parser()
        self._answers = firmata.Parser(from_board=True)

    def to_board(self, chunk: bytes) -> Iterator[str]:
        """Yield the host's messages."""
        for message in self._commands.receive(chunk):
            encoder = message.exclusive and message.code == firmata.ENCODER and message.data
            yield _encoder_requested(message.data) if encoder else _message(message)

    def from_board(self, chunk: bytes) -> Iterator[str]:
        """Yield the board's messages."""
        return map(_message, self._answers.receive(chunk))


def _fields(message: Any) -> str:
    """Return a message's fields, each with its name."""
    return ", ".join(f"{one.name} {_value(getattr(message, one.name))}" for one in fields(message))


def _value(value: object) -> object:
    if isinstance(value, bytes):
        return value.decode("latin-1") if value.isascii() and value else value.hex(" ").upper() or "none"
    if isinstance(value, tuple):
        return ", ".join(str(_value(one)) for one in value)
    return value


def _message(message: firmata.Message) -> str:
    """Return the decoded text of a Firmata message."""
    if not message.exclusive:
        row = firmata.COMMANDS[message.code]
        channel = f" {message.channel}" if message.code < firmata.CHANNELLED else ""
        return called(f"{row.name}{channel}", message.data.hex(" ").upper())
    name = firmata.EXCLUSIVE.get(message.code, f"command 0x{message.code:02X}")
    return called(name, _exclusive(message) or message.data.hex(" ").upper())


def _encoder_requested(data: bytes) -> str:
    requests = firmata.ENCODER_REQUESTS.get(data[0], f"command 0x{data[0]:02X}")
    return called(f"encoder, {requests}", " ".join(map(str, data[1:])))


def _exclusive(message: firmata.Message) -> str:
    """Return what the data of a system-exclusive message say, where that is known."""
    counts = firmata.decode_counts(message)
    if counts:
        return ", ".join(f"count {one.count} of encoder {one.encoder}" for one in counts)
    read = firmata.decode_i2c(message)
    if read is not None:
        return f"0x{read.address:02X} from register 0x{read.register:02X}: {read.data.hex(' ').upper()}"
    data = message.data
    if message.code == firmata.I2C_REQUEST and len(data) > 1 and data[1] == firmata.I2C_WRITE:
        written = bytes(value & 0xFF for value in firmata.unpaired(data[2:]))
        motor = motor_shield.decode_channel(written) if data[0] == motor_shield.ADDRESS else None
        does = "" if motor is None else f", {motor.pin.value} of M{motor.motor} = {motor.level}"
        return f"write 0x{data[0]:02X}: {written.hex(' ').upper()}{does}"
    if message.code == firmata.FIRMWARE and len(data) > 1:
        name = bytes(value & 0xFF for value in firmata.unpaired(data[2:])).decode("latin-1")
        return f"{data[0]}.{data[1]} {name}"
    return ""
