"""The same chain in two processes on a real SocketCAN bus, driven by a stranger: pymavlink over UDP.

The test looks at the bus with its own python-can socket and asks the drives by SDO where they are, so that it
believes neither the bridge nor the emulator.
"""

import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, TypeVar

import can
import pytest
from pymavlink import mavutil

pytestmark = [pytest.mark.vcan, pytest.mark.timeout(180)]

CHANNEL: Final = "vcan0"
QC_PER_M: Final = 2000 * 26 / (2 * 3.141592653589793 * 0.05)
DISABLED: Final = (0x0140, 0x0121)
STATE_BITS: Final = 0x417F
TSHARK: Final = shutil.which("tshark") or "tshark: not installed"
START_WITHIN_S: Final = 40.0
T = TypeVar("T")


@dataclass
class Program:
    """One `firmware-bridge` process, and what it prints."""

    process: subprocess.Popen[bytes]
    log: Path

    @property
    def printed(self) -> str:
        return self.log.read_text(encoding="utf-8", errors="replace")

    def ends(self, number: int = signal.SIGINT) -> int:
        if self.process.poll() is None:
            self.process.send_signal(number)
        return self.process.wait(timeout=20)


@dataclass
class Eye:
    """The test's own socket on the bus."""

    bus: can.BusABC
    stack: ExitStack = field(default_factory=ExitStack)

    def ask(self, node: int, index: int) -> int | None:
        """Read a signed object of up to 4 bytes by SDO; None without an answer."""
        while self.bus.recv(0) is not None:
            pass
        request = bytes((0x40, index & 0xFF, index >> 8, 0, 0, 0, 0, 0))
        self.bus.send(can.Message(arbitration_id=0x600 + node, data=request, is_extended_id=False))
        until = time.monotonic() + 1.0
        while time.monotonic() < until:
            message = self.bus.recv(0.1)
            if message is None or message.arbitration_id != 0x580 + node:
                continue
            if message.data[1:3] == request[1:3]:
                size = 4 - (message.data[0] >> 2 & 3)
                return int.from_bytes(message.data[4 : 4 + size], "little", signed=True)
        return None

    def metres(self) -> float:
        """Return how far the rear axle's middle has rolled."""
        left, right = self.ask(1, 0x6064), self.ask(2, 0x6064)
        assert left is not None
        assert right is not None
        return (left + right) / 2 / QC_PER_M

    def speed(self) -> float:
        """Return the mean speed over about a tenth of a second, m/s."""
        before, began = self.metres(), time.monotonic()
        sleep(0.1)
        after = self.metres()
        return (after - before) / (time.monotonic() - began)

    def state(self, node: int) -> int:
        word = self.ask(node, 0x6041)
        assert word is not None
        return word & STATE_BITS


def sleep(seconds: float) -> None:
    """Wait in real time: the only tests that may."""
    time.sleep(seconds)


def until(happens: Callable[[], T | None], within: float, what: str) -> T:
    end = time.monotonic() + within
    while time.monotonic() < end:
        found = happens()
        if found:
            return found
        sleep(0.05)
    pytest.fail(f"{what}: not within {within:g} s")


class Client:
    """A ground station by pymavlink's own means."""

    def __init__(self, port: int) -> None:
        self.link: Any = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=255)
        self.texts: list[str] = []
        self.x = 0.0

    def says(self, speed: float, seconds: float) -> None:
        """Drive straight at 20 Hz for some time, and listen."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.link.mav.manual_control_send(1, round(speed / 0.5 * 1000), 0x7FFF, 0, 0, 0)
            self.hears(0.05)

    def hears(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            message = self.link.recv_match(blocking=True, timeout=left)
            if message is None:
                return
            if message.get_type() == "STATUSTEXT":
                self.texts.append(message.text)
            elif message.get_type() == "LOCAL_POSITION_NED":
                self.x = message.x

    def arms(self) -> None:
        """Arm with the stick let go, as who drives must."""

        def armed() -> bool:
            self.link.mav.heartbeat_send(6, 8, 0, 0, 4)
            self.link.mav.manual_control_send(1, 0, 0x7FFF, 0, 0, 0)
            self.link.mav.command_long_send(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
            answer = self.link.recv_match(type="COMMAND_ACK", blocking=True, timeout=0.5)
            return answer is not None and answer.command == 400 and answer.result == 0

        until(armed, START_WITHIN_S, "armed")


@dataclass
class Bench:
    folder: Path
    programs: dict[str, Program]
    eye: Eye
    port: int
    client: Client | None = None

    def runs(self, name: str, log: Path, command: list[str]) -> Program:
        with log.open("wb") as output:
            process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
        self.programs[name] = Program(process, log)
        return self.programs[name]

    def starts(self, name: str, *arguments: str) -> Program:
        program = str(Path(sys.executable).parent / "firmware-bridge")
        return self.runs(name, self.folder / f"{name}.txt", [program, *arguments])

    def joins(self) -> Client:
        self.client = Client(self.port)
        return self.client

    def emulates(self, *more: str) -> Program:
        program = self.starts("emulate", "emulate", "rars", "-i", "socketcan", "-c", CHANNEL, *more)
        until(lambda: self.eye.ask(4, 0x1000) == 0x20192, START_WITHIN_S, f"emulator: {program.printed}")
        return program

    def drives(self) -> Program:
        where = f"udpin:127.0.0.1:{self.port}"
        stands = ("--zero", "lift=0", "--zero", "steer=0", "--state", str(self.folder / "last.json"))
        bus = ("-i", "socketcan", "-c", CHANNEL)
        return self.starts("drive", "drive", "rars", *bus, "--mavlink", where, *stands)


@pytest.fixture
def bench(tmp_path: Path, unused_port: int) -> Iterator[Bench]:
    with can.Bus(interface="socketcan", channel=CHANNEL) as bus:
        made = Bench(tmp_path, {}, Eye(bus), unused_port)
        yield made
        if made.client is not None:
            made.client.link.close()
        for program in made.programs.values():
            if program.process.poll() is None:
                program.process.kill()
                program.process.wait()


@pytest.fixture
def unused_port() -> int:
    return 14550 + time.monotonic_ns() % 1000


def test_a_client_drives_is_killed_and_the_robot_stops_then_ctrl_c(bench: Bench) -> None:
    log = bench.folder / "can.log"
    candump = bench.runs("candump", log, ["candump", "-L", CHANNEL])
    bench.emulates()
    bridge = bench.drives()
    client = bench.joins()
    client.arms()
    client.says(0.1, 3.0)
    assert bench.eye.speed() == pytest.approx(0.1, abs=0.02)
    client.says(0.1, 0.3)
    assert client.x > 0.15
    client.link.close()
    sleep(0.6)
    at_rest = bench.eye.metres()
    sleep(0.3)
    assert bench.eye.metres() == pytest.approx(at_rest, abs=0.001), "it stands 0.6 s after the last word"
    assert bridge.ends() == 0, bridge.printed
    for node in (1, 2, 3, 4):
        assert bench.eye.state(node) in DISABLED, (node, bridge.printed)
    candump.ends(signal.SIGTERM)
    frames = log.read_text(encoding="ascii")
    assert " vcan0 501#0F00" in frames
    assert " vcan0 281#" in frames
    found = subprocess.run(
        [TSHARK, "-r", str(log), "-d", "can.subdissector,canopen", "-Y", "_ws.malformed"],
        capture_output=True,
        check=True,
        text=True,
    )
    assert found.stdout == ""


def test_the_drives_stop_by_themselves_when_the_bridge_is_killed(bench: Bench) -> None:
    bench.emulates()
    bridge = bench.drives()
    client = bench.joins()
    client.arms()
    client.says(0.3, 2.0)
    assert bench.eye.speed() > 0.2
    bridge.ends(signal.SIGKILL)
    sleep(0.8)
    at_rest = bench.eye.metres()
    sleep(0.3)
    assert bench.eye.metres() == pytest.approx(at_rest, abs=0.001)
    for node in (1, 2):
        assert bench.eye.state(node) != 0x0137, "enabled operation is over"


def test_a_drive_that_falls_silent_stops_the_robot_and_is_named(bench: Bench) -> None:
    emulator = bench.emulates("--silence", "3@25")
    began = time.monotonic()
    bench.drives()
    client = bench.joins()
    client.arms()
    client.says(0.2, 2.0)
    assert time.monotonic() - began < 24, "the bench was too slow to get under way"
    while bench.eye.ask(3, 0x1000) is not None:
        client.says(0.2, 0.2)
    client.says(0.2, 1.0)
    assert any("3" in text and "steering" in text for text in client.texts), (client.texts, emulator.printed)
    at_rest = bench.eye.metres()
    client.says(0.2, 0.3)
    assert bench.eye.metres() == pytest.approx(at_rest, abs=0.001)
