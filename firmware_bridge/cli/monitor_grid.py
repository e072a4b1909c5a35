"""A table of texts in the look of rich's, for a display that is drawn again and again.

rich measures and wraps every cell by itself, which would be most of the time of a display of a full bus.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from rich import box
from rich.cells import cell_len, set_cell_size
from rich.console import Console, ConsoleOptions
from rich.segment import Segment
from rich.text import Text

KEPT: Final = 1024
"""Texts whose lines are kept: most cells are the same as half a second before."""
PLAIN: Final = Console()
"""For wrapping, which needs one for the width of a tab."""
_PADDING: Final = 2
"""Columns beside a cell's text, one to each side."""


@dataclass(frozen=True, slots=True)
class Grid:
    """A title, headings, and rows of as many texts."""

    title: str
    headings: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Segment]:
        """Yield the lines; a text that is too long for its column goes on below."""
        frame = box.HEAVY_HEAD.substitute(options, safe=console.safe_box)
        borders = len(self.headings) * (_PADDING + 1) + 1
        space = options.max_width - borders
        rows = [self.headings, *(tuple(map(printable, row)) for row in self.rows)]
        widths = _fitted([max(map(cell_len, column)) for column in zip(*rows, strict=True)], space)
        outer = [width + _PADDING for width in widths]
        title = " " * max(0, (sum(widths) + borders - len(self.title)) // 2) + self.title
        head = [frame.head_left, frame.head_vertical, frame.head_right]
        body = [frame.mid_left, frame.mid_vertical, frame.mid_right]
        yield from _line(title, console, "table.title")
        yield from _line(frame.get_top(outer), console)
        for text in _lines(self.headings, widths, head):
            yield from _line(text, console, "table.header")
        yield from _line(frame.get_row(outer, "head"), console)
        for row in rows[1:]:
            for text in _lines(row, widths, body):
                yield from _line(text, console)
        yield from _line(frame.get_bottom(outer), console)


def _fitted(widths: list[int], space: int) -> list[int]:
    """Return widths that fit; the widest columns become narrower, down to one character."""
    while sum(widths) > space and max(widths) > 1:
        widths[widths.index(max(widths))] -= 1
    return widths


def _lines(row: Sequence[str], widths: Sequence[int], borders: list[str]) -> Iterator[str]:
    """Yield the lines of a row between its borders: left, in between, right."""
    left, between, right = borders
    cells = [_wrapped(text, width) for text, width in zip(row, widths, strict=True)]
    for place in range(max(map(len, cells))):
        texts = (cell[place] if place < len(cell) else "" for cell in cells)
        padded = (f" {set_cell_size(text, width)} " for text, width in zip(texts, widths, strict=True))
        yield left + between.join(padded) + right


@lru_cache(maxsize=KEPT)
def _wrapped(text: str, width: int) -> tuple[str, ...]:
    if cell_len(text) <= width:
        return (text,)
    return tuple(line.plain for line in Text(text).wrap(PLAIN, width, overflow="fold"))


def printable(text: str) -> str:
    """Return a text without what would break its line, or command a terminal: it may be a node's."""
    if text.isprintable():
        return text
    return "".join(one if one.isprintable() else repr(one)[1:-1] for one in text)


def _line(text: str, console: Console, style: str = "") -> Iterator[Segment]:
    yield Segment(text, console.get_style(style) if style else None)
    yield Segment.line()
