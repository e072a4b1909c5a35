"""A line as the core's String has it: where a letter stands, what is between two of them, and its number.

It does not interpret the line's command.

Sources: ArduinoCore-avr, WString.cpp: indexOf() ends at a zero byte, substring() takes unsigned places of 16
bits and exchanges them where the first is larger; toInt() is atol(), toFloat() is atof().

Where they are silent:
* atof() rounds once, to the nearest float; the one of avr-libc may be off by its last bit.
"""

import re
from typing import Final

from emulators.arduino_omni.mega.arithmetic import atoi, single

WORD: Final = 1 << 16
_REAL: Final = re.compile(
    rb"[ \t\n\v\f\r]*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?(?:inf|nan))", re.IGNORECASE
)


def index_of(text: bytes, letter: str) -> int:
    """Return the first place of a letter; -1 where it is missing."""
    return text.partition(b"\0")[0].find(letter.encode())


def substring(text: bytes, left: int, right: int = -1) -> bytes:
    """Return what is from one place up to another; a place of -1 lies behind every end."""
    first, last = sorted((left % WORD, right % WORD))
    return text[first:last].partition(b"\0")[0]


def number(text: bytes, letter: str, following: str = "") -> int:
    """Return the int behind a letter, up to where the expected next one stands, or to the end."""
    return atoi(substring(text, index_of(text, letter) + 1, _end(text, following)))


def real(text: bytes, letter: str, following: str = "") -> float:
    """Return the float behind a letter, as `number` does."""
    return to_float(substring(text, index_of(text, letter) + 1, _end(text, following)))


def steps(text: bytes, letter: str, following: str) -> tuple[int, int]:
    """Return a joint's direction, one digit behind its letter, and its steps behind that."""
    place = index_of(text, letter)
    return (
        atoi(substring(text, place + 1, place + 2)),
        atoi(substring(text, place + 2, _end(text, following))),
    )


def to_float(text: bytes) -> float:
    """Return the float that a text begins with; 0 for none."""
    found = _REAL.match(text)
    return single(float(found[1])) if found else 0.0


def _end(text: bytes, following: str) -> int:
    return index_of(text, following) if following else -1
