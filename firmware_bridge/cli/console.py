"""How the program says what is wrong: one message, with an exit status."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import typer

FAILED: Final = 1
WRONG_INPUT: Final = 2
INTERRUPTED: Final = 130


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
