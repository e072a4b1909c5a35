"""The program can-utils against a drive of `emulate epos2` on a SocketCAN bus: cansend sends, candump logs.

And the drive's own configuration file, which the program reads back over the same bus.
"""

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

from hil_tests.lanes import HUNG_S

pytestmark = [pytest.mark.vcan, pytest.mark.timeout(120)]

CHANNEL: Final = "vcan0"
PROGRAM: Final = str(Path(sys.executable).with_name("firmware-bridge"))
START_WITHIN_S: Final = 40.0


class Bus:
    """candump's running log, and cansend."""

    def __init__(self, log: Path) -> None:
        self._log = log

    def sends(self, *frames: str) -> None:
        for frame in frames:
            subprocess.run(["cansend", CHANNEL, frame], check=True)  # noqa: S607 - where the system has it

    def received(self) -> list[str]:
        return [line.split()[-1] for line in self._log.read_text().splitlines()]

    def receives(self, frame: str, within_s: float = 5.0) -> bool:
        until = time.monotonic() + within_s
        while time.monotonic() < until:
            if frame in self.received():
                return True
            time.sleep(0.02)
        return False


@pytest.fixture
def bus(tmp_path: Path) -> Iterator[Bus]:
    log = tmp_path / "candump.log"
    with log.open("w") as file:
        dump = subprocess.Popen(["candump", "-L", CHANNEL], stdout=file)  # noqa: S607 - as above
    time.sleep(0.3)
    yield Bus(log)
    dump.terminate()
    dump.wait(timeout=HUNG_S)


@pytest.fixture
def drives(bus: Bus, tmp_path: Path) -> Iterator[None]:
    with (tmp_path / "emulate.log").open("w") as stated:
        requested = [
            "emulate",
            "epos2",
            "--node",
            "1-2",
            "--profile",
            "50/5",
            "-i",
            "socketcan",
            "-c",
            CHANNEL,
        ]
        emulation = subprocess.Popen([PROGRAM, *requested], stdout=stated, stderr=subprocess.STDOUT)
    assert bus.receives("701#00", START_WITHIN_S), (tmp_path / "emulate.log").read_text()
    yield
    emulation.send_signal(signal.SIGINT)
    assert emulation.wait(timeout=HUNG_S) == 0


@pytest.mark.usefixtures("drives")
def test_cansend_requests_and_candump_receives_the_answers(bus: Bus) -> None:
    bus.sends("601#4000100000000000")
    assert bus.receives("581#4300100092010200")
    bus.sends("602#4018100200000000")
    assert bus.receives("582#4318100200002263")
    bus.sends("601#4055550000000000")
    assert bus.receives("581#8055550000000206")
    bus.sends("000#0101")
    assert bus.receives("181#4007")
    bus.sends("601#2B02640001000000", "201#0600", "201#0F00")
    assert bus.receives("181#3707"), bus.received()
    bus.sends("701#R1")
    assert bus.receives("701#05")


@pytest.mark.usefixtures("drives")
def test_the_configuration_of_a_running_drive_is_read_over_the_bus(bus: Bus, tmp_path: Path) -> None:
    bus.sends("602#2383600009030000")
    assert bus.receives("582#6083600000000000")
    path = tmp_path / "node2.dcf"
    command = [PROGRAM, "epos2", "dcf", "--node", "2", "-i", "socketcan", "-c", CHANNEL, "--out", str(path)]
    subprocess.run(command, check=True, timeout=HUNG_S)
    text = path.read_text()
    assert "ProductName=EPOS2 50/5" in text
    assert "NodeID=2" in text
    assert "ParameterValue=777" in text
