"""Presence checks of devices: the requests, their times, and the valid answers. The test is the device."""

import os
import tty
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple, NoReturn

import pytest

from emulators.arduino_omni.board import FIRMWARES
from emulators.epos2.presence import DeviceTypeRead
from emulators.testing.answering import (
    BOOTS,
    REQUESTED_AGAIN,
    BoardCall,
    LineCall,
    RollCall,
    questions,
)
from emulators.testing.buses import Bus
from emulators.testing.emulated import Drives
from emulators.testing.errors import RigError
from firmware_bridge.families.ar2.settings import Ar2Firmware

REQUESTED: Final = bytes.fromhex("90 02 10 02 00 10 00 02 DF F2")
"""ReadObject 0x1000 of node 2, and its answer: EPOS2 Application Notes Collection, April 2013, p. 11-164."""
ANSWERED: Final = bytes.fromhex("90 02 00 04 00 00 00 00 92 01 02 00 9A ED")
TIMED_OUT: Final = bytes.fromhex("90 02 00 04 00 00 04 05 00 00 00 00 32 67")
"""Computed: the error of a gateway behind which there is no such node."""


class Line(NamedTuple):
    """A pseudo-terminal: the device's end, and the name of the other one."""

    device: int
    port: str

    def received(self) -> bytes:
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


def test_a_board_is_left_alone_in_its_boot_loader_and_then_requested_until_it_has_stated_all(
    line: Line,
) -> None:
    with BoardCall(line.port, "ros-arduino-bridge") as call:
        os.write(line.device, b"57600 from before the question\r\n")
        assert not any(call.complete() for _ in range(BOOTS))
        assert line.received() == b""
        assert not call.complete()
        assert line.received() == b"b\r"
        os.write(line.device, b"57600\r\n")
        assert not call.complete(), "more may follow"
        assert call.complete()
    assert set(questions()) == {*FIRMWARES, *Ar2Firmware}


def test_a_drive_on_a_line_is_requested_again_until_it_answers_without_an_error(line: Line) -> None:
    with LineCall(line.port, "2", partial(DeviceTypeRead, "v2")) as call:
        assert not call.complete()
        assert line.received() == REQUESTED
        os.write(line.device, TIMED_OUT)
        assert not any(call.complete() for _ in range(REQUESTED_AGAIN - 1))
        assert line.received() == b""
        assert not call.complete()
        assert line.received() == REQUESTED
        os.write(line.device, ANSWERED)
        assert call.complete()


class Requested:
    """A port to a bus on which node 2 has answered, and node 3 refuses."""

    name = "a bus"

    def __init__(self) -> None:
        self._readable, self._writable = os.pipe()
        self.written: list[int] = []

    def fileno(self) -> int:
        return self._readable

    def write(self, address: int, _payload: bytes, _now: int) -> None:
        self.written.append(address)
        if address in {0x602, 0x603}:
            os.write(self._writable, bytes((address & 0x7F,)))

    def read(self, _now: int) -> list[tuple[int, bytes]]:
        (node,) = os.read(self._readable, 1)
        answer = "4300100092010200" if node == 2 else "8000100000000206"
        return [(0x580 + node, bytes.fromhex(answer))]

    def close(self) -> None:
        os.close(self._readable)
        os.close(self._writable)


class Busy(Requested):
    """A bus on which another node never stops to speak."""

    def __init__(self) -> None:
        super().__init__()
        os.write(self._writable, b"x")
        self._reads = 0

    def read(self, _now: int) -> list[tuple[int, bytes]]:
        self._reads += 1
        return [(0x080, b"")] if self._reads % 2 else []


@pytest.mark.timeout(20)
def test_on_a_bus_that_is_never_silent_those_who_are_not_there_are_not_waited_for_any_longer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("emulators.testing.answering.open_can", lambda *_: Busy())
    with RollCall(Bus("socketcan", "vcan0"), "5") as call:
        assert call.answering(within=0.02) == []


def test_who_answers_before_anybody_was_started_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("emulators.testing.answering.open_can", lambda *_: Requested())
    with RollCall(Bus("socketcan", "vcan0"), "1-3") as call:
        assert call.answering(within=0.0) == [2]

    def never(_words: object) -> NoReturn:
        raise AssertionError("nothing is started")

    with pytest.raises(RigError, match=r"node 2 on vcan0 answers already, before it was started"):
        Drives(never, tmp_path)("1-3", on=Bus("socketcan", "vcan0"))
