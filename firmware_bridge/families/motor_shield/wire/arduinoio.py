"""ArduinoIO, MATLAB's older protocol for an Arduino: a letter and single bytes behind it, a row a command.

Source: G. Campa's legacy MATLAB and Simulink package for Arduino (giampy1969): the sketches adio to motor_v2,
v4.4 of 2013, and arduino.m. No frames, no check sum, no timeout; a query is answered with a number and CR LF.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

BAUD: Final = 115_200
FIRST_LETTER: Final = ord("0")
LAST_LETTER: Final = ord("Y")
LINE_END: Final = b"\r\n"
MOTOR_V2: Final = 4
"""Identification answer of the sketch for the motor shield V2."""


@dataclass(frozen=True, slots=True)
class ArgumentKind:
    """Meaning of a byte behind the letter: its value is the byte less `base`."""

    name: str
    base: int
    first: int
    last: int

    def takes(self, byte: int) -> bool:
        """Return whether the sketch goes on with this byte."""
        return self.first <= byte - self.base <= self.last

    def encode(self, value: int) -> int:
        """Return a value's byte; ValueError where the sketch would not take it."""
        if not self.first <= value <= self.last:
            raise ValueError(f"{self.name} must be from {self.first} to {self.last}, and is {value}")
        return value + self.base


PIN: Final = ArgumentKind("pin", 97, 2, 69)
ANALOG: Final = ArgumentKind("analog input", 97, 0, 15)
BIT: Final = ArgumentKind("level", 48, 0, 1)
RAW: Final = ArgumentKind("value", 0, 0, 255)
MOTOR: Final = ArgumentKind("motor", 48, 1, 4)
STEPPER: Final = ArgumentKind("stepper", 48, 1, 2)
ENCODER: Final = ArgumentKind("encoder", 48, 0, 2)
DEBOUNCE: Final = ArgumentKind("debounce", 97, 0, 69)
REFERENCE: Final = ArgumentKind("reference", 48, 0, 2)
NINE: Final = ArgumentKind("second letter", 48, 9, 9)
ENDS_STEPPER: Final = ord("r")
"""A stepper's direction that takes nothing more."""


@dataclass(frozen=True, slots=True)
class ArduinoIoCommand:
    """One command: its letter, the bytes behind it, and whether it is answered with a number."""

    letter: str
    name: str
    follows: tuple[ArgumentKind, ...]
    answers: bool = False
    assumed: str = ""


_NO_STEPPERS: Final = "steppers are not emulated: the bytes are taken, and nothing turns"

ROWS: Final[tuple[ArduinoIoCommand, ...]] = (
    ArduinoIoCommand("0", "pin mode: 0 input, 1 output", (PIN, BIT)),
    ArduinoIoCommand("1", "digital read", (PIN,), answers=True),
    ArduinoIoCommand("2", "digital write", (PIN, BIT)),
    ArduinoIoCommand("3", "analog read", (ANALOG,), answers=True),
    ArduinoIoCommand("4", "analog write", (PIN, RAW)),
    ArduinoIoCommand("5", "is a servo attached", (PIN,), answers=True),
    ArduinoIoCommand("6", "servo: 0 detach, 1 attach", (PIN, BIT)),
    ArduinoIoCommand("7", "servo read", (PIN,), answers=True, assumed="90 before the first write"),
    ArduinoIoCommand("8", "servo write", (PIN, RAW)),
    ArduinoIoCommand("9", "who is it", (NINE,), answers=True),
    ArduinoIoCommand("A", "motor's speed", (MOTOR, RAW)),
    ArduinoIoCommand("B", "motor: f, b or r", (MOTOR, RAW)),
    ArduinoIoCommand("C", "stepper's speed", (STEPPER, RAW), assumed=_NO_STEPPERS),
    ArduinoIoCommand("D", "stepper's steps", (STEPPER, RAW, RAW, RAW), assumed=_NO_STEPPERS),
    ArduinoIoCommand("E", "attach an encoder", (ENCODER, PIN, PIN)),
    ArduinoIoCommand("F", "detach an encoder", (ENCODER,)),
    ArduinoIoCommand("G", "read an encoder", (ENCODER,), answers=True),
    ArduinoIoCommand("H", "set an encoder to 0", (ENCODER,)),
    ArduinoIoCommand("I", "an encoder's debounce", (ENCODER, DEBOUNCE), assumed="it changes nothing"),
    ArduinoIoCommand("R", "analog reference", (REFERENCE,), assumed="it changes nothing"),
    ArduinoIoCommand("X", "print a byte as a number", (RAW,), answers=True),
)
COMMANDS: Final[Mapping[str, ArduinoIoCommand]] = MappingProxyType({row.letter: row for row in ROWS})


def encode(letter: str, *values: int) -> bytes:
    """Return a command's bytes; ValueError for what the sketch would not take."""
    row = COMMANDS.get(letter)
    if row is None:
        raise ValueError(f"no command '{letter}'; there are: {', '.join(COMMANDS)}")
    if len(values) != len(row.follows):
        raise ValueError(f"command '{letter}' takes {len(row.follows)} values, and got {len(values)}")
    return letter.encode() + bytes(kind.encode(it) for kind, it in zip(row.follows, values, strict=True))


@dataclass(frozen=True, slots=True)
class ReceivedCommand:
    """A command as it came: its row, and what followed."""

    row: ArduinoIoCommand
    values: tuple[int, ...]


class CommandReader:
    """The board's end: it takes bytes and finds commands. A byte that does not fit ends its command."""

    def __init__(self) -> None:
        self._row: ArduinoIoCommand | None = None
        self._values: list[int] = []

    def take(self, byte: int) -> ReceivedCommand | None:
        """Take one byte; return the command that it completes."""
        row = self._row
        if row is None:
            self._row = COMMANDS.get(chr(byte))
            return None
        # The number of bytes follows from the letter alone: there is no length and no end.
        kind = row.follows[len(self._values)]
        # 'r' releases a stepper; where it is not, two more bytes belong to the command.
        released = row.letter == "D" and len(self._values) == 1 and byte == ENDS_STEPPER
        # The sketch has no frame: a byte that is out of range ends the command without an answer.
        if not kind.takes(byte) or released:
            self._forget()
            return None
        self._values.append(byte - kind.base)
        if len(self._values) < len(row.follows):
            return None
        values = tuple(self._values)
        self._forget()
        return ReceivedCommand(row, values)

    def _forget(self) -> None:
        self._row = None
        self._values.clear()


def decode(line: bytes) -> int | None:
    """Return the number of an answer without its line end; None where it is no number."""
    # A line in pieces may be a minus alone.
    digits = line.removeprefix(b"-")
    return int(line) if digits.isdigit() else None


def encode_answer(number: int) -> bytes:
    """Return the board's answer for a number."""
    return str(number).encode() + LINE_END
