"""The terminal for tables and progress."""

import os
from typing import Final

from rich.console import Console

NO_TERMINAL_WIDTH: Final = 120
"""A table written to a file or a pipe is not cut to the 80 columns of a terminal that is not there."""


def terminal(*, stderr: bool = False) -> Console:
    """Return the console to print tables and progress on."""
    console = Console(stderr=stderr, highlight=False)
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = NO_TERMINAL_WIDTH
    return console
