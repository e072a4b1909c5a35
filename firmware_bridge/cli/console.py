"""The program's output: on any terminal, with each error as one message and an exit status."""

import codecs
import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from typing import Final

import typer

from firmware_bridge.runtime.printer import Printer

FAILED: Final = 1
WRONG_INPUT: Final = 2
UNCONFIRMED: Final = 3
"""The run is over, and no one knows whether the robot is without power."""
INTERRUPTED: Final = 130
_PLAIN: Final = {"²": "2", "³": "3", "°": "deg", "µ": "u", "·": "-", "→": "->", "…": "..."}
"""Replacements on a terminal that lacks a sign; any other is a question mark there."""


PRINTED_WITHIN_S: Final = 2.0
"""So long at most a run that is over waits for what it has still to print."""
_printers: Final[list[Printer]] = []
"""The one that prints, while something runs that nothing may hold up."""


def speak_plainly() -> None:
    """Print what a terminal lacks, a power of two or a name in Greek, in signs that it has."""
    codecs.register_error("plain", _plain)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="plain")


def say(text: str, *, err: bool = False) -> None:
    """Print a line; BrokenPipeError where its reader is gone, and silence from then on.

    So the caller can still stop a robot. In `held_up_by_nothing` it never waits and never fails.
    """
    stream = sys.stderr if err else sys.stdout
    if _printers:
        _printers[-1].print(text, stream)
        return
    try:
        stream.write(f"{text}\n")
        stream.flush()
    except BrokenPipeError:
        # Python flushes the stream once more at its exit: into nothing from here on.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
        raise


class _Logged(logging.Handler):
    """A handler that prints a library's log."""

    def emit(self, record: logging.LogRecord) -> None:
        say(f"firmware-bridge: {record.name}: {record.getMessage()}", err=True)


@contextmanager
def held_up_by_nothing() -> Iterator[None]:
    """Print from a thread while this runs, so that neither a terminal nor a disk holds up a cycle."""
    printer, logged = Printer(), _Logged(logging.WARNING)
    _printers.append(printer)
    root = logging.getLogger()  # noqa: TID251 - what libraries log would wait for the terminal, too
    root.addHandler(logged)
    try:
        yield
    finally:
        root.removeHandler(logged)
        printer.end(PRINTED_WITHIN_S)
        _printers.remove(printer)


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


def _plain(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(_PLAIN.get(sign, "?") for sign in error.object[error.start : error.end]), error.end


def refusal(message: str, status: int = WRONG_INPUT) -> typer.Exit:
    """Print one message on standard error, and return what ends the program when it is raised."""
    say(f"firmware-bridge: {message}", err=True)
    return typer.Exit(status)
