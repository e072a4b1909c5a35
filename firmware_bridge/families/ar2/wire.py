"""The protocol of the arm AR2: lines of letters and decimal numbers, and its board's answers.

Source: Chris-Annin/AR2, AR2_2.0 and AR2_1.5.

Answers have no line end unless it is given here.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

BAUD: Final = 115_200
OLD_BAUD: Final = 9_600
END: Final = b"\n"
LETTERS: Final = "ABCDEFT"
"""Of six joints and the track."""
MOVING: Final = b"command recieved"
"""The answer to a move before it begins; the end of a move is not reported."""
DONE: Final = b"Done"
SERVO_DONE: Final = b"Servo Done"
POINTS: Final = b"num points recieved"
ALL_POINTS: Final = b"waypts done"
ECHO_END: Final = b"\r\n"
"""After the line that TM echoes, its own end among it."""
MOST_STEPS: Final = 32_767
COMMANDS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "SV": "servo",
        "WT": "wait",
        "JF": "input",
        "ON": "output on",
        "OF": "output off",
        "WI": "wait until an input is on",
        "WO": "wait until an input is off",
        "TM": "echo",
        "LL": "to the limit switches",
        "MJ": "joint move",
        "ML": "points follow",
    }
)
"""Meaning of a line's first two letters."""
_AXIS: Final = re.compile(rb"([A-FT])([01])(\d+)")
_FIELD: Final = re.compile(rb"([GHIKNPSTVX])(-?\d+(?:\.\d+)?(?:e[+-]?\d+)?)")


@dataclass(frozen=True, slots=True)
class Ar2Request:
    """A line, read as this module's functions write it; the board looks for letters, and takes anything."""

    letters: str
    """The first two letters."""
    steps: Mapping[str, int]
    """Steps by the letters of joints and track; ahead, which is digit 1, above 0."""
    fields: Mapping[str, str]
    """The other fields, by their letters."""
    text: str
    """Behind the letters, as it is."""


def decode(line: bytes) -> Ar2Request | None:
    """Return the request of a line without its end; None for one that a board ignores."""
    letters, rest = line[:2].decode("ascii", "replace"), bytes(line[2:])
    if letters not in COMMANDS:
        return None
    # Letters are used twice: A to F are joints before the S, and G to K are ramps behind it.
    axes, _, fields = rest.partition(b"S") if letters in {"MJ", "LL"} else (b"", b"", rest)
    found = _FIELD.findall((b"S" if axes else b"") + fields) if letters != "TM" else ()
    return Ar2Request(
        letters,
        {letter.decode(): int(count) * (2 * int(digit) - 1) for letter, digit, count in _AXIS.findall(axes)},
        {letter.decode(): number.decode() for letter, number in found},
        rest.decode("ascii", "replace"),
    )


def move(
    steps: Sequence[int],
    speed: float,
    *,
    up: tuple[int, int] = (0, 100),
    down: tuple[int, int] = (0, 100),
) -> bytes:
    """Return the line of a joint move: steps of six joints and the track, ahead with digit 1.

    `speed`, and of `up` and `down` the part of the way and the speed there, are percentages; those speeds
    divide. ValueError for what the board would take for something else.
    """
    if not 0 < len(steps) <= len(LETTERS):
        raise ValueError(f"a move takes up to {len(LETTERS)} axes, not {len(steps)}")
    # int16 in the sketch: one step more would be a move the other way.
    if max(map(abs, steps)) > MOST_STEPS:
        raise ValueError(f"a move takes up to {MOST_STEPS} steps, not {max(map(abs, steps))}")
    if min(up[1], down[1]) <= 0 or not 0.0 < speed <= 100.0:  # noqa: PLR2004 - a percentage
        raise ValueError(f"speeds of {speed}, {up[1]} and {down[1]} %: the board divides by each of them")
    axes = "".join(
        # A joint at 0 steps is sent, too: each field ends where the next letter is found.
        f"{letter}{int(count > 0)}{abs(count)}"
        for letter, count in zip(LETTERS, (*steps, *(0,) * (len(LETTERS) - len(steps))), strict=True)
    )
    return f"MJ{axes}S{speed:g}G{up[0]}H{up[1]}I{down[0]}K{down[1]}".encode() + END


def switches(steps: Sequence[int], digits: Sequence[int], speed: int) -> bytes:
    """Return the line that drives joints to their limit switches: six counts of steps and directions."""
    axes = "".join(
        f"{letter}{digit}{count}" for letter, digit, count in zip(LETTERS[:6], digits, steps, strict=True)
    )
    return f"LL{axes}S{speed}".encode() + END


def test(text: str) -> bytes:
    """Return the line that is echoed when all before it is done."""
    return f"TM{text}".encode() + END


def echo(text: str) -> bytes:
    """Return what comes back of it."""
    return text.encode() + END + ECHO_END


def place(joint: int, steps: int) -> str:
    """Return the text of the position of a joint, 1 to 6: the board keeps no count, and echoes it."""
    return f"{LETTERS[joint - 1]}{steps}"
