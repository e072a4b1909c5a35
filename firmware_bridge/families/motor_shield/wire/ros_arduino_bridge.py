"""ros_arduino_bridge: commands of a letter and decimal words, one row each; here with three motors.

Source: hbrobotics/ros_arduino_bridge, indigo-devel: its sketch's commands, its Python driver. The third motor
in `e`, `m` and `o` is what several public forks for omni bases do.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Final, TypeAlias

BAUD: Final = 57_600
FRAME_MS: Final = 1_000 // 30
"""Of the loop of speeds: 30 Hz in the sketch's whole milliseconds."""
END: Final = b"\r"
LINE_END: Final = b"\r\n"
OK: Final = "OK"
INVALID: Final = "Invalid Command"
WORD: Final = 16
"""Characters of an argument, the last of them a zero."""


class RosArduinoAnswer(Enum):
    """Form of a command's answer when it is done."""

    OK = "OK"
    NUMBER = "a number"
    NUMBERS = "one number for each motor"


@dataclass(frozen=True, slots=True)
class RosArduinoCommand:
    """One command: its letter, its number of arguments, their separator, its answer."""

    letter: str
    name: str
    arguments: int | None
    """None: one for each motor."""
    answer: RosArduinoAnswer
    separator: str = " "
    assumed: str = ""


ROWS: Final[tuple[RosArduinoCommand, ...]] = (
    RosArduinoCommand("a", "analog read", 1, RosArduinoAnswer.NUMBER),
    RosArduinoCommand("b", "baud rate", 0, RosArduinoAnswer.NUMBER),
    RosArduinoCommand("c", "pin mode", 2, RosArduinoAnswer.OK),
    RosArduinoCommand("d", "digital read", 1, RosArduinoAnswer.NUMBER),
    RosArduinoCommand("e", "read encoders", 0, RosArduinoAnswer.NUMBERS),
    RosArduinoCommand("m", "motor speeds, in ticks a frame", None, RosArduinoAnswer.OK),
    RosArduinoCommand("o", "raw PWM, -255 to 255", None, RosArduinoAnswer.OK, assumed="in later forks only"),
    RosArduinoCommand("p", "ping, in cm", 1, RosArduinoAnswer.NUMBER),
    RosArduinoCommand("r", "reset encoders", 0, RosArduinoAnswer.OK),
    RosArduinoCommand("s", "servo write", 2, RosArduinoAnswer.OK),
    RosArduinoCommand("t", "servo read", 1, RosArduinoAnswer.NUMBER),
    RosArduinoCommand("u", "gains Kp, Kd, Ki, Ko", 4, RosArduinoAnswer.OK, ":"),
    RosArduinoCommand("w", "digital write", 2, RosArduinoAnswer.OK),
    RosArduinoCommand("x", "analog write", 2, RosArduinoAnswer.OK),
)
COMMANDS: Final[Mapping[str, RosArduinoCommand]] = MappingProxyType({row.letter: row for row in ROWS})
Numbers: TypeAlias = tuple[int, ...]


def encode(letter: str, numbers: Sequence[int] = (), motors: int = 3) -> bytes:
    """Return a command's line; ValueError for an unknown letter, or not as many numbers as it takes."""
    row = COMMANDS.get(letter)
    if row is None:
        raise ValueError(f"no command '{letter}'; there are: {', '.join(COMMANDS)}")
    wanted = motors if row.arguments is None else row.arguments
    if len(numbers) != wanted:
        raise ValueError(f"command '{letter}' takes {wanted} numbers, and got {len(numbers)}")
    words = row.separator.join(map(str, numbers))
    # The line ends with CR alone; the sketch takes an LF for a character.
    return f"{letter} {words}".rstrip().encode() + END


def decode(letter: str, line: bytes, motors: int = 3) -> Numbers | None:
    """Return the numbers of an answer, none for OK; None where it is not this command's.

    `INVALID`, noise and half a line are None too: the driver sends its request again.
    """
    row = COMMANDS[letter]
    text = line.decode("ascii", "replace").strip()
    if row.answer is RosArduinoAnswer.OK:
        return () if text == OK else None
    words = text.split(" ")
    wanted = motors if row.answer is RosArduinoAnswer.NUMBERS else 1
    if len(words) != wanted or not all(_is_number(word) for word in words):
        return None
    return tuple(map(int, words))


def _is_number(word: str) -> bool:
    digits = word.removeprefix("-")
    # Noise that happens to be digits must not become a number of any size.
    return digits.isascii() and digits.isdigit() and len(digits) <= WORD
