"""The robot's drives on a pseudo-terminal, as a program with pyserial meets them, in real time."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path
from typing import NamedTuple

import pytest
import serial

from firmware_bridge.families.epos2.maxon.frame import Generation, MaxonAnswer
from firmware_bridge.families.epos2.maxon.lines import host_end
from firmware_bridge.families.epos2.maxon.messages import (
    Answer,
    ObjectRead,
    ReadObject,
    Request,
    WriteObject,
)
from firmware_bridge.families.epos2.maxon.opcodes import decode_answer, encode_request
from firmware_bridge.families.epos2.maxon.v1 import FRAME_TIMEOUT
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.lanes import HUNG_S

PROGRAM = Path(sys.executable).with_name("firmware-bridge")
WITHIN = 20 * SECOND


def emulate(*words: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [PROGRAM, "emulate", "rars", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


class Line(NamedTuple):
    """A serial line: its protocol, its path, and the emulator's process."""

    generation: Generation
    path: Path
    program: subprocess.Popen[str]


@pytest.fixture(params=Generation)
def line(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Line]:
    """Run the drives, and see that they end in good order."""
    generation, link = request.param, tmp_path / "rars.tty"
    words = ("--serial", "pty", "--serial-link", str(link), "--protocol", generation.value)
    with emulate(*words) as program:
        try:
            clock = Clock()
            while not link.is_symlink():
                assert clock.now() < WITHIN, "the link does not come"
                assert program.poll() is None, program.stderr and program.stderr.read()
                clock.wait([], clock.now() + 20 * MILLISECOND)
            yield Line(generation, link, program)
        finally:
            program.send_signal(signal.SIGCONT)
            program.send_signal(signal.SIGINT)
            stated, complained = program.communicate(timeout=HUNG_S)
    assert program.returncode == 0, complained
    assert f"{link} ({generation.value})" in stated
    assert not link.is_symlink()


def ask(
    client: serial.Serial,
    generation: Generation,
    request: Request,
    beside: Callable[[int], None] | None = None,
) -> Answer | None:
    """Ask, and do something beside each step of it."""
    host, clock = host_end(generation, 2 * SECOND), Clock()
    host.ask(encode_request(request), clock.now())
    for step in count():
        client.write(host.taken())
        if beside is not None:
            beside(step)
        clock.wait([client.fileno()], host.due)
        outcome = host.receive(client.read(client.in_waiting), clock.now()) or host.wake(clock.now())
        if outcome is not None:
            client.write(host.taken())
            assert isinstance(outcome, MaxonAnswer), outcome
            return decode_answer(request, outcome.body)
    raise AssertionError("the steps never end")


@pytest.mark.long(keeps=["v2"])
def test_a_program_reaches_all_four_drives_and_may_come_back(line: Line) -> None:
    generation, path, _ = line
    for value in (1234, 2345):
        with serial.Serial(str(path), 115_200, timeout=0) as client:
            for node in (0, 1, 2, 3, 4):
                raw = (value + node).to_bytes(4, "little")
                assert ask(client, generation, WriteObject(0x6081, 0, node, raw)) is not None
                assert ask(client, generation, ReadObject(0x6081, 0, node)) == ObjectRead(0, raw)
            client.write(b"\x10\x01half a command")
        Clock().wait([], FRAME_TIMEOUT + 100 * MILLISECOND)  # until then RS232 takes what comes for the rest


def stands_still(program: subprocess.Popen[str], at: int) -> Callable[[int], None]:
    """Stop the process before a step of a command, when it has answered the one before, for 0.7 s."""

    def beside(step: int) -> None:
        if step == at - 1:
            Clock().wait([], 50 * MILLISECOND)
            program.send_signal(signal.SIGSTOP)
        elif step == at:
            Clock().wait([], 700 * MILLISECOND)
            program.send_signal(signal.SIGCONT)

    return beside


@pytest.mark.parametrize("line", [Generation.V1], indirect=True)
def test_a_process_that_stands_still_for_a_while_invents_no_time_out(line: Line) -> None:
    """For every step of a command that it misses: bytes in the port have arrived in time."""
    generation, path, program = line
    with serial.Serial(str(path), 115_200, timeout=0) as client:
        for node, step in ((0, 1), (0, 2), (2, 1), (2, 2)):
            answer = ask(client, generation, ReadObject(0x1000, 0, node), stands_still(program, step))
            assert answer == ObjectRead(0, bytes.fromhex("92010200"))


@pytest.mark.long(keeps=["words2-cannot make the link /dev/null"])
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--serial", "/dev/no-such"), "cannot open serial port /dev/no-such at 115200 Bd: there is no such"),
        (("--serial", "/dev/no-such", "--serial-link", "x"), "--serial-link x: only a pseudo-terminal wants"),
        (("--serial", "pty", "--serial-link", os.devnull), "cannot make the link /dev/null"),
    ],
)
def test_mistakes_are_reported_in_one_message(words: tuple[str, ...], message: str) -> None:
    with emulate(*words) as program:
        _, complained = program.communicate(timeout=HUNG_S)
    assert program.returncode == 2
    assert complained.startswith(f"firmware-bridge: {message}")
    assert complained.count("\n") == 1


def test_a_recording_that_cannot_be_made_leaves_no_link_behind(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    link = tmp_path / "rars.tty"
    with emulate(
        "--serial", "pty", "--serial-link", str(link), "--record", str(tmp_path / "file")
    ) as program:
        _, complained = program.communicate(timeout=HUNG_S)
    assert program.returncode == 2
    assert complained.startswith("firmware-bridge: cannot record in ")
    assert not link.is_symlink()
