"""Lines of text to the board of an AR2 arm, decoded."""

from collections.abc import Iterator
from typing import Final

from firmware_bridge.dissector.lines import UNREAD, BoardLine, called
from firmware_bridge.families.ar2 import wire as ar2
from firmware_bridge.wire.lines import LineReader

LONGEST: Final = 6_000
"""Of a line to an arm: more than its board has room for."""


class Ar2Line(BoardLine):
    """The arm AR2: lines of letters and numbers; the board's output has no ends, but for an echo's."""

    def __init__(self) -> None:
        self._commands = LineReader(ar2.END, LONGEST)

    def to_board(self, chunk: bytes) -> Iterator[str]:
        """Yield a line's content: steps of joints, ahead above 0, and its other fields."""
        for line in self._commands.receive(chunk):
            command = ar2.decode(line)
            if command is None:
                yield f"{UNREAD}: {line.decode('latin-1')!r}"
                continue
            values = [f"{_axis(letter)} {_steps(steps)}" for letter, steps in command.steps.items() if steps]
            if command.steps and not values:
                values.append("no steps")
            values += [f"{letter} {number}" for letter, number in command.fields.items()]
            yield called(
                f"{command.letters}, {ar2.COMMANDS[command.letters]}", ", ".join(values) or command.text
            )

    def from_board(self, chunk: bytes) -> Iterator[str]:
        """Yield the text as it came."""
        yield f"sent {chunk.decode('latin-1')!r}"


def _axis(letter: str) -> str:
    return "track" if letter == ar2.LETTERS[-1] else f"J{ar2.LETTERS.index(letter) + 1}"


def _steps(steps: int) -> str:
    """Return steps as requested, and as a board with numbers of 16 bits takes them."""
    # int16 in the sketch: a count beyond 32767 is a move the other way.
    kept = (steps + 0x8000 & 0xFFFF) - 0x8000
    return f"{steps:+d}" if kept == steps else f"{steps:+d} (in the board's 16 bits {kept:+d})"
