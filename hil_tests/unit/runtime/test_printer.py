"""Printer with a blocked reader: the sender is not held up, and later receives the number of lost lines."""

import io
import os
from collections.abc import Iterator
from contextlib import suppress
from typing import TextIO

import pytest

from firmware_bridge.runtime.printer import MOST, Printer


@pytest.fixture
def pipe() -> Iterator[tuple[int, TextIO]]:
    """A pipe of the smallest size, read by the first and written by the second."""
    reader, writer = os.pipe()
    with os.fdopen(writer, "w", encoding="ascii", errors="replace") as stream:
        yield reader, stream
    os.close(reader)


def test_lines_come_in_order(pipe: tuple[int, TextIO]) -> None:
    reader, stream = pipe
    printer = Printer()
    for line in ("one", "two", "µ"):
        printer.print(line, stream)
    printer.end(10.0)
    assert os.read(reader, 100) == b"one\ntwo\n?\n"


def test_what_no_one_takes_is_dropped_and_counted_and_reported_when_someone_does(
    pipe: tuple[int, TextIO],
) -> None:
    reader, stream = pipe
    printer, line = Printer(), "x" * 999
    stated = 2 * MOST
    for _ in range(stated):
        printer.print(line, stream)
    taken = b""
    while taken.count(b"\n") < MOST:
        taken += os.read(reader, 1 << 20)
    printer.print("last", stream)
    printer.end(10.0)
    os.set_blocking(reader, False)
    while True:
        try:
            taken += os.read(reader, 1 << 20)
        except BlockingIOError:
            break
    lines = taken.decode().splitlines()
    reported = [text for text in lines if text.startswith("(")]
    assert reported, "it is printed"
    assert all(text.endswith(" lines before this one could not be printed)") for text in reported)
    lost = sum(int(text[1:].split(" ")[0]) for text in reported)
    assert lines.count(line) == stated - lost < stated
    assert lines[-1] == "last"


def test_its_end_waits_no_longer_than_it_may(pipe: tuple[int, TextIO]) -> None:
    reader, stream = pipe
    printer = Printer()
    for _ in range(MOST + 10):
        printer.print("x" * 999, stream)
    printer.end(0.01)
    # Its thread must be done before others have the files of these numbers.
    os.set_blocking(reader, False)
    while printer.printing:
        with suppress(BlockingIOError):
            os.read(reader, 1 << 20)


def test_a_pipe_that_no_one_reads_any_more_and_a_file_that_is_closed_take_nothing() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    printer = Printer()
    with os.fdopen(writer, "w", encoding="ascii") as stream:
        printer.print("lost", stream)
        printer.end(10.0)
    Printer().print("lost", stream)


def test_in_memory_it_is_there_at_once() -> None:
    stream = io.StringIO()
    Printer().print("here", stream)
    assert stream.getvalue() == "here\n"
