"""The terminal for tables and progress."""

import os
from collections.abc import Iterable, Sequence
from typing import Final

from rich.console import Console
from rich.table import Table
from rich.text import Text

NO_TERMINAL_WIDTH: Final = 120
"""A table written to a file or a pipe is not cut to the 80 columns of a terminal that is not there."""


def terminal(*, stderr: bool = False) -> Console:
    """Return the console to print tables and progress on."""
    console = Console(stderr=stderr, highlight=False)
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = NO_TERMINAL_WIDTH
    return console


LEAST_WIDTH: Final = 20
"""Columns that are left to a cell that is cut, however narrow the terminal is."""
_BETWEEN: Final = "  "


def print_lines(rows: Sequence[Sequence[str]], cut: int = -1, styles: Sequence[str] = ()) -> None:
    """Print rows as aligned lines, the first one as headings; the column `cut` takes what width is left.

    `styles` is a style for each line, empty for none.
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    console = terminal()
    others = sum(widths) - widths[cut] + len(_BETWEEN) * (len(widths) - 1)
    widths[cut] = min(widths[cut], max(console.width - others, LEAST_WIDTH))
    for place, row in enumerate(rows):
        cells = (
            f"{text if len(text) <= width else text[: width - 1] + '…':{width}}"
            for text, width in zip(row, widths, strict=True)
        )
        style = styles[place] if styles else "bold" if place == 0 else ""
        console.print(Text(_BETWEEN.join(cells).rstrip(), style), no_wrap=True, overflow="ellipsis")


def print_grid(rows: Iterable[tuple[str, str]]) -> None:
    """Print headings with their texts, a heading once however many lines its text has."""
    grid = Table.grid(padding=(0, 2))
    grid.add_column(no_wrap=True, style="dim")
    grid.add_column(overflow="fold")
    for heading, text in rows:
        grid.add_row(heading, text)
    terminal().print(grid)
