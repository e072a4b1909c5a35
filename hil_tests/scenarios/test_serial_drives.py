"""Drives without a robot on a pseudo-terminal, and the choice of the one on the line, as programs."""

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from typer.testing import CliRunner

from firmware_bridge.cli import program
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.lanes import HUNG_S

PROGRAM = Path(sys.executable).with_name("firmware-bridge")
WITHIN = 20 * SECOND


@contextmanager
def emulated(link: Path, *words: str) -> Iterator[str]:
    """Run drives until the end of the block, and see that they end in good order; return what leads there."""
    words = ("emulate", *words, "--serial", "pty", "--serial-link", str(link))
    with subprocess.Popen(
        [PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as running:
        clock = Clock()
        try:
            while not link.is_symlink():
                assert clock.now() < WITHIN, "the link does not come"
                assert running.poll() is None, running.stderr and running.stderr.read()
                clock.wait([], clock.now() + 20 * MILLISECOND)
            yield str(link)
        finally:
            running.send_signal(signal.SIGINT)
            stated, complained = running.communicate(timeout=HUNG_S)
    assert running.returncode == 0, complained
    assert str(link) in stated


def requested(*words: str) -> str:
    result = CliRunner().invoke(program, ["epos2", *words])
    assert result.exit_code == 0, result.output
    return " ".join(result.stdout.split())


def refused(*words: str) -> str:
    result = CliRunner().invoke(program, ["emulate", *words])
    assert result.exit_code == 2, result.output
    (line,) = result.stderr.splitlines()
    return line


@pytest.mark.long(keeps=["words0-v1-1"])
@pytest.mark.parametrize(
    ("words", "protocol", "near"),
    [
        ((), "v1", 1),
        (("--serial-node", "3"), "v1", 3),
        (("--protocol", "v2", "--serial-node", "4"), "v2", 4),
        (("--baud", "9600"), "v1", 1),
    ],
)
def test_the_line_reaches_the_drive_on_it_and_the_others(
    tmp_path: Path, words: tuple[str, ...], protocol: str, near: int
) -> None:
    with emulated(tmp_path / "epos2.tty", "epos2", "--node", "1-4", *words) as link:
        line = ("--serial", link, "--protocol", protocol)
        assert requested("read", "0x2009", *line, "--gateway", str(near)).endswith(f" {near}")
        for node in (1, 2, 3, 4):
            assert requested("read", "0x2009", *line, "--node", str(node)).endswith(f" {node}")
        rate = 0 if "--baud" in words else 5
        assert requested("read", "0x2002", *line).endswith(f" {rate}")
        assert "operation enabled" in requested("state", "enable", "--yes", *line, "--node", "2")


def test_a_line_and_a_bus_at_once(tmp_path: Path) -> None:
    words = ("epos2", "--node", "1-2", "-i", "virtual", "-c", "serial-drives")
    with emulated(tmp_path / "epos2.tty", *words) as link:
        assert requested("read", "0x2009", "--serial", link, "--node", "2").endswith(" 2")


def test_a_robot_s_drive_is_chosen_by_its_node(tmp_path: Path) -> None:
    with emulated(tmp_path / "rars.tty", "rars", "--serial-node", "3") as link:
        assert requested("read", "0x2009", "--serial", link, "--gateway", "3").endswith(" 3")
        assert requested("read", "0x2009", "--serial", link, "--node", "1").endswith(" 1")


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (("epos2", "--serial-node", "1"), "--serial-node 1: there is no serial line; use --serial pty"),
        (("epos2", "--node", "1-2", "--serial", "pty", "--serial-node", "3"), "no such node; there are 1, 2"),
        (("rars", "--serial", "pty", "--serial-node", "9"), "no such node; there are 1, 2, 3, 4"),
        (("epos2", "--baud", "9600"), "--baud 9600: only a line of RS232 has a rate"),
        (("epos2", "--serial", "pty", "--protocol", "v2", "--baud", "9600"), "only a line of RS232"),
        (("epos2", "--serial", "pty", "--baud", "4800"), "--baud 4800: an EPOS2 knows 9600, 14400"),
        (("epos2", "--serial", "/dev/no-such"), "cannot open serial port /dev/no-such at 115200 Bd"),
        (("epos2", "--serial", "/dev/no-such", "--baud", "9600"), "/dev/no-such at 9600 Bd"),
        (("epos2", "--serial", "/dev/no-such", "--serial-link", "x"), "only a pseudo-terminal wants a link"),
    ],
)
def test_mistakes_are_reported_in_one_message(words: tuple[str, ...], reported: str) -> None:
    assert reported in refused(*words)
