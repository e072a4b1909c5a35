"""Whether devices are there: what is asked, when, and what counts as an answer. The test is the device."""

import os
import tty
from collections.abc import Iterator
from typing import Final, NamedTuple

import pytest

from emulators.arduino_omni.board import FIRMWARES
from emulators.testing.answering import ARM, ASKED_AGAIN, BOOTS, QUESTIONS, BoardCall, LineCall
from firmware_bridge.wire.maxon.frame import Generation

ASKED: Final = bytes.fromhex("90 02 10 02 00 10 00 02 DF F2")
"""ReadObject 0x1000 of node 2, and its answer: EPOS2 Application Notes Collection, April 2013, p. 11-164."""
ANSWERED: Final = bytes.fromhex("90 02 00 04 00 00 00 00 92 01 02 00 9A ED")
TIMED_OUT: Final = bytes.fromhex("90 02 00 04 00 00 04 05 00 00 00 00 32 67")
"""Computed: the error of a gateway behind which there is no such node."""


class Line(NamedTuple):
    """A pseudo-terminal: the device's end, and the name of the other one."""

    device: int
    port: str

    def heard(self) -> bytes:
        try:
            return os.read(self.device, 64)
        except BlockingIOError:
            return b""


@pytest.fixture
def line() -> Iterator[Line]:
    device, host = os.openpty()
    tty.setraw(host)
    os.set_blocking(device, False)
    yield Line(device, os.ttyname(host))
    os.close(device)
    os.close(host)


def test_a_board_is_left_alone_in_its_boot_loader_and_then_asked_until_it_has_said_all(line: Line) -> None:
    with BoardCall(line.port, "ros-arduino-bridge") as call:
        os.write(line.device, b"57600 from before the question\r\n")
        assert not any(call.complete() for _ in range(BOOTS))
        assert line.heard() == b""
        assert not call.complete()
        assert line.heard() == b"b\r"
        os.write(line.device, b"57600\r\n")
        assert not call.complete(), "more may follow"
        assert call.complete()
    assert set(QUESTIONS) == {*FIRMWARES, ARM}


def test_a_drive_on_a_line_is_asked_again_until_it_answers_without_an_error(line: Line) -> None:
    with LineCall(line.port, "2", Generation.V2) as call:
        assert not call.complete()
        assert line.heard() == ASKED
        os.write(line.device, TIMED_OUT)
        assert not any(call.complete() for _ in range(ASKED_AGAIN - 1))
        assert line.heard() == b""
        assert not call.complete()
        assert line.heard() == ASKED
        os.write(line.device, ANSWERED)
        assert call.complete()
