"""How the program speaks: tables on a terminal, and one message for what is wrong, with an exit status."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import typer
from rich.console import Console

from firmware_bridge.robot import Robot, RobotFileError, find

FAILED: Final = 1
WRONG_INPUT: Final = 2
INTERRUPTED: Final = 130
NO_TERMINAL_WIDTH: Final = 120
"""A table written to a file or a pipe is not cut to the 80 columns of a terminal that is not there."""


def terminal(*, stderr: bool = False) -> Console:
    """Return the console to print tables and progress on."""
    console = Console(stderr=stderr, highlight=False)
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = NO_TERMINAL_WIDTH
    return console


@contextmanager
def one_message(*errors: type[Exception], status: int = WRONG_INPUT) -> Iterator[None]:
    """Turn these errors into one message on standard error and an exit status, without a traceback."""
    try:
        yield
    except errors as error:
        raise refusal(str(error), status) from None


@contextmanager
def written_by(option: str) -> Iterator[None]:
    """Turn a place that cannot be written into one message, which names the option for another place."""
    try:
        yield
    except OSError as error:
        place = "" if error.filename is None else f"{error.filename}: "
        raise refusal(f"{place}cannot be written: {error.strerror}; {option} names another place") from None


def refusal(message: str, status: int = WRONG_INPUT) -> typer.Exit:
    """Print one message on standard error, and return what ends the program when it is raised."""
    typer.echo(f"firmware-bridge: {message}", err=True)
    return typer.Exit(status)


def find_robot(name: str) -> Robot:
    """Return the robot of this name or file; where there is none, say so and end the program."""
    with one_message(RobotFileError):
        return find(name)
