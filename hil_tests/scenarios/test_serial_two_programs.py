"""`emulate` and `drive` as two programs on one pseudo-terminal, in real time; pyserial opens it."""

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any, Final

import pytest

os.environ["MAVLINK20"] = "1"
from pymavlink.dialects.v20 import common as mavlink

from firmware_bridge.runtime.clock import Clock
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.lanes import HUNG_S
from hil_tests.ports import free_port

PROGRAM = Path(sys.executable).with_name("firmware-bridge")
WITHIN: Final = 30 * SECOND
"""A loaded machine takes its time; nothing here is measured."""

pytestmark = pytest.mark.timeout(120)


class Program:
    """One run of the program, and its whole output."""

    def __init__(self, log: Path, *words: str) -> None:
        self._log = log
        self._file: IO[str] = log.open("w", encoding="utf-8")
        environment = os.environ | {"PYTHONUNBUFFERED": "1"}
        self.process = subprocess.Popen(
            [PROGRAM, *words], stdout=self._file, stderr=subprocess.STDOUT, env=environment
        )

    @property
    def reported(self) -> str:
        return self._log.read_text(encoding="utf-8")

    def states(self, text: str) -> bool:
        return text in self.reported

    def ends(self) -> int:
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(timeout=HUNG_S)

    def dies(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self._file.close()


def until(met: Callable[[], bool], what: Callable[[], str], meanwhile: Callable[[], None]) -> None:
    clock = Clock()
    while not met():
        assert clock.now() < WITHIN, what()
        meanwhile()
        clock.wait([], clock.now() + 50 * MILLISECOND)


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[..., Program]]:
    running: list[Program] = []

    def begin(*words: str) -> Program:
        running.append(Program(tmp_path / f"{len(running)}.log", *words))
        return running[-1]

    yield begin
    for program in running:
        program.dies()


class Operator:
    """A ground station that repeats its messages."""

    def __init__(self, port: int) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)  # noqa: FBT003 - a socket's own word
        self._to = ("127.0.0.1", port)
        self._words: Any = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)

    def _states(self, message: Any) -> None:
        self._socket.sendto(message.pack(self._words), self._to)

    @property
    def port(self) -> int:
        return self._to[1]

    def leaves(self) -> None:
        self._socket.close()

    def holds_the_stick(self) -> None:
        self._states(mavlink.MAVLink_manual_control_message(1, 0, 0, 0, 0, 0))

    def stands(self) -> None:
        """Confirm the positions of steering and lift."""
        self.holds_the_stick()
        for axis in (3.0, 4.0):
            self._states(mavlink.MAVLink_command_long_message(1, 1, 31010, 0, axis, 0, 0, 0, 0, 0, 0))

    def arms(self) -> None:
        self.holds_the_stick()
        self.orders(400, 1.0)

    def orders(self, command: int, first: float) -> None:
        self._states(mavlink.MAVLink_command_long_message(1, 1, command, 0, first, 0, 0, 0, 0, 0, 0))


@pytest.fixture
def operator() -> Iterator[Operator]:
    made = Operator(free_port())
    yield made
    made.leaves()


def test_the_robot_is_armed_over_the_line_loses_it_and_is_armed_again(
    start: Callable[..., Program], operator: Operator, tmp_path: Path
) -> None:
    link = tmp_path / "rars.tty"
    emulation = ("emulate", "rars", "--serial", "pty", "--serial-link", str(link), "--protocol", "v2")
    drives = start(*emulation)
    until(link.is_symlink, lambda: drives.reported, lambda: None)
    stands = ("--zero", "lift=0", "--zero", "steer=0", "--state", str(tmp_path / "last.json"))
    mavlink_at = f"udpin:127.0.0.1:{operator.port}"
    bridge = start("drive", "rars", "--serial", str(link), "--mavlink", mavlink_at, *stands)

    def comes(text: str, meanwhile: Callable[[], None] = operator.holds_the_stick) -> None:
        until(lambda: bridge.states(text), lambda: bridge.reported, meanwhile)

    comes("  armed", operator.arms)
    assert bridge.states(f"bridge on {link} (v2, 1000000 Bd), node 1 passes on to the others")
    drives.ends()
    comes("link lost: drives: the serial line to the drives is gone (plug the adapter in again, then arm)")
    comes("  disarmed")
    start(*emulation)
    comes("cleared: link lost: drives")
    until(
        lambda: bridge.reported.count("cleared: reference lost") == 4,
        lambda: bridge.reported,
        operator.stands,
    )
    armed = bridge.reported.count("  armed")
    until(lambda: bridge.reported.count("  armed") > armed, lambda: bridge.reported, operator.arms)
    assert bridge.ends() == 0, bridge.reported
    assert bridge.states("ended: SIGINT")


@pytest.mark.long(beside="test_a_second_station_takes_nothing_from_who_drives")
def test_a_second_station_on_another_port_clears_and_arms_nothing_but_may_stop(
    start: Callable[..., Program], operator: Operator, tmp_path: Path
) -> None:
    """With the same numbers as the first: it is known by where it speaks from."""
    link = tmp_path / "rars.tty"
    drives = start("emulate", "rars", "--serial", "pty", "--serial-link", str(link), "--protocol", "v2")
    until(link.is_symlink, lambda: drives.reported, lambda: None)
    stands = ("--zero", "lift=0", "--zero", "steer=0", "--state", str(tmp_path / "last.json"))
    words = ("--serial", str(link), "--mavlink", f"udpin:127.0.0.1:{operator.port}", *stands)
    bridge = start("drive", "rars", *words)
    other = Operator(operator.port)

    def both() -> None:
        operator.holds_the_stick()
        other.orders(400, 0.0)
        other.orders(5300, 1.0)
        other.orders(400, 1.0)

    def later(seconds: int, meanwhile: Callable[[], None]) -> None:
        clock = Clock()
        until(lambda: clock.now() > seconds * SECOND, lambda: "", meanwhile)

    until(lambda: bridge.states("  armed"), lambda: bridge.reported, operator.arms)
    later(1, both)
    assert not bridge.states("  disarmed")
    other.orders(185, 1.0)
    until(lambda: bridge.states("  disarmed"), lambda: bridge.reported, operator.holds_the_stick)
    later(1, both)
    assert not bridge.states("cleared: emergency stop")
    operator.orders(5300, 1.0)
    until(lambda: bridge.states("cleared: emergency stop"), lambda: bridge.reported, operator.holds_the_stick)
    other.leaves()
    assert bridge.ends() == 0, bridge.reported


@pytest.mark.long(keeps=["words3---zero lift=up: give AXIS=VALUE"])
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("--serial", "/dev/no-such"),
            "cannot open serial port /dev/no-such at 1000000 Bd: there is no such",
        ),
        (
            ("--serial", "/dev/ttyS0", "--protocol", "v1"),
            "link 'drives': a cycle of 50 ms does not hold statusword of node 4",
        ),
        (("--zero", "lift"), "--zero lift: give AXIS=VALUE"),
        (("--zero", "lift=up"), "--zero lift=up: give AXIS=VALUE"),
        (("--zero", "lift=0", "--zero", "lift=1"), "--zero lift=1: lift is given twice"),
        (("--zero", "lift=2"), "zero: lift at 2 m is not within 0 to 1.116"),
        (
            ("--zero", "left=0"),
            "zero: no position to confirm for left; to be confirmed: steer (deg), lift (m)",
        ),
        (("--baud", "9600"), "rars: --baud: is of a serial port; name it with --serial DEVICE"),
    ],
)
def test_mistakes_are_reported_in_one_message(
    start: Callable[..., Program], words: tuple[str, ...], message: str
) -> None:
    program = start("drive", "rars", *words)
    assert program.process.wait(timeout=HUNG_S) == 2
    assert program.reported.startswith(f"firmware-bridge: {message}")
    assert program.reported.count("\n") == 1
