"""`epos2 read --watch`, questions, and Ctrl-C, as a program of its own with and without a terminal."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import PseudoTerminal
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.lanes import HUNG_S
from hil_tests.unit.cli.bench_drives import Bench, ask, bench

PROGRAM = Path(sys.executable).with_name("firmware-bridge")
WITHIN = 20 * SECOND


@pytest.fixture
def on() -> Iterator[Bench]:
    with bench() as found:
        yield found


@contextmanager
def begun(
    *words: str, screen: int = subprocess.PIPE, keyboard: int = subprocess.DEVNULL
) -> Iterator[subprocess.Popen[bytes]]:
    """Run the program; at the end of the block it must have ended by itself."""
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "120", "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(
        [PROGRAM, "epos2", *words], stdin=keyboard, stdout=screen, stderr=subprocess.PIPE, env=environment
    ) as running:
        try:
            yield running
            running.wait(timeout=HUNG_S)
        finally:
            running.kill()
    complaint = running.stderr.read().decode() if running.stderr and not running.stderr.closed else ""
    assert "Traceback" not in complaint


def shown_until(screen: int, text: str) -> str:
    """Read a terminal until a text is there."""
    clock, seen = Clock(), ""
    while text not in seen:
        assert clock.now() < WITHIN, seen
        if clock.wait([screen], clock.now() + 100 * MILLISECOND):
            seen += os.read(screen, 4096).decode()
    return seen


def test_without_a_terminal_each_change_is_a_line_and_ctrl_c_ends_it_well(on: Bench) -> None:
    watching = begun("read", "profile-velocity", "0x607F", *on.serial, "--watch", "0.02")
    with watching as running:
        assert running.stdout is not None
        assert b"Profile Velocity" in (first := running.stdout.readline())
        assert b"1000 rpm" in first
        assert b"25000 rpm" in running.stdout.readline()
        assert ask("write", "profile-velocity", "700", *on.can).status == 0
        assert b"700 rpm" in running.stdout.readline()
        running.send_signal(signal.SIGINT)
        rest, complaint = running.communicate(timeout=HUNG_S)
    assert (rest, complaint, running.returncode) == (b"", b"", 0)


def test_on_a_terminal_it_is_drawn_again(on: Bench) -> None:
    screen, other = os.openpty()
    with begun("read", "-w", "profile-velocity", *on.serial, screen=other) as running:
        os.close(other)
        shown_until(screen, "1000 rpm")
        assert ask("write", "profile-velocity", "700", *on.can).status == 0
        assert "\x1b[" in shown_until(screen, "700 rpm"), "the cursor goes back"
        running.send_signal(signal.SIGINT)
        assert running.wait(timeout=HUNG_S) == 0
    os.close(screen)


def test_watching_for_programs_and_for_a_time(on: Bench) -> None:
    reported = ask("read", "statusword", "-w", "0.01", "--duration", "0.2", "--json", *on.can)
    assert reported.status == 0, reported.err
    (line,) = reported.out.splitlines()
    assert json.loads(line)["objects"][0]["value"] == 0x0540


def test_watching_ends_where_no_one_answers(on: Bench) -> None:
    reported = ask("read", "statusword", "--watch", *on.can, "--node", "9")
    assert reported.status == 1
    assert "does not answer" in reported.line


@pytest.mark.parametrize("words", [("--watch", "0"), ("--watch=soon",), ("-w=0",)])
def test_a_period_that_is_none_is_refused(on: Bench, words: tuple[str, ...]) -> None:
    assert ask("read", "statusword", *on.can, *words).status == 2


def test_an_interrupted_command_states_so() -> None:
    silent = PseudoTerminal()
    with begun("read", "statusword", "--serial", silent.path) as running:
        clock = Clock()
        while not clock.wait([silent.fileno()], clock.now() + 100 * MILLISECOND):
            assert clock.now() < WITHIN
        running.send_signal(signal.SIGINT)
        _, complaint = running.communicate(timeout=HUNG_S)
    silent.close()
    assert running.returncode == 130
    assert b"interrupted; the drive on" in complaint
    assert complaint.count(b"\n") == 1


@pytest.mark.parametrize(("answer", "status", "state"), [("y", 0, "operation enabled"), ("n", 1, "")])
def test_a_question_comes_before_what_may_move(on: Bench, answer: str, status: int, state: str) -> None:
    keyboard, other = os.openpty()
    os.write(keyboard, f"{answer}\n".encode())
    with begun("state", "enable", *on.serial, keyboard=other) as running:
        stated, complaint = running.communicate(timeout=HUNG_S)
    os.close(keyboard)
    os.close(other)
    assert b"it may start to move. Is everyone clear of the machine? [y/N]" in complaint
    assert (running.returncode, state in stated.decode()) == (status, True)
    assert (b"nothing was done" in complaint) is bool(status)
