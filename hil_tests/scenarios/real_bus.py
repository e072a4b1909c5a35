"""The chain in two processes on a real bus, of SocketCAN or of datagrams, and its observer.

A test drives as others would, with pymavlink over UDP, and looks at the bus with a socket of its own: it
reads the drives' positions by SDO, and believes neither the bridge nor the emulator.
"""

import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeVar

import can
import pytest
from pymavlink import mavutil

from hil_tests.lanes import HUNG_S

SOCKETCAN: Final = ("socketcan", "vcan0")
MULTICAST: Final = ("loopback_multicast", "239.74.163.2")
PLAIN: Final = "udp_multicast"
"""python-can's own, which is no true bus."""
SDO_ANSWERS: Final = [can.typechecking.CanFilter(can_id=0x580, can_mask=0x780)]
"""Filter of the test's own socket: to skip all other frames takes longer than the operator's timeout."""
QC_PER_M: Final = 2000 * 26 / (2 * 3.141592653589793 * 0.05)
DISABLED: Final = (0x0140, 0x0121)
STATE_BITS: Final = 0x417F
START_WITHIN_S: Final = 40.0
ARM: Final = 400
ACTUATOR: Final = 187
ACCEPTED: Final = 0
"""Value of MAV_RESULT."""
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
        return self.process.wait(timeout=HUNG_S)


@dataclass
class Eye:
    """The test's own socket on the bus."""

    bus: can.BusABC

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

    def sends(self, address: int, data: bytes) -> None:
        """Put one frame on the bus, as someone who has no business there."""
        self.bus.send(can.Message(arbitration_id=address, data=data, is_extended_id=False))

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

    def states(self, speed: float, seconds: float, full: float = 0.5) -> None:
        """Drive straight at 20 Hz for some time, and listen; `full` is the speed of a full stick, m/s."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.link.mav.manual_control_send(1, round(speed / full * 1000), 0x7FFF, 0, 0, 0)
            self.receives(0.05)

    def states_until(self, speed: float, happens: Callable[[], object], within: float, what: str) -> None:
        """Drive straight until something happens."""

        def happened() -> object:
            self.states(speed, 0.1)
            return happens()

        until(happened, within, what)

    def receives(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.receives_one(left)

    def receives_one(self, within: float) -> Any:
        """Take in the next message, and return it; None where there is none."""
        message = self.link.recv_match(blocking=True, timeout=within)
        if message is not None and message.get_type() == "STATUSTEXT":
            self.texts.append(message.text)
        elif message is not None and message.get_type() == "LOCAL_POSITION_NED":
            self.x = message.x
        return message

    def requests(self, command: int, *params: float) -> int | None:
        """Send a COMMAND_LONG with the stick let go; return MAV_RESULT, or None without an answer."""
        self.link.mav.heartbeat_send(6, 8, 0, 0, 4)
        self.link.mav.manual_control_send(1, 0, 0x7FFF, 0, 0, 0)
        self.link.mav.command_long_send(1, 1, command, 0, *params, *[0] * (7 - len(params)))
        end = time.monotonic() + 0.5
        while (left := end - time.monotonic()) > 0:
            message = self.receives_one(left)
            if message is not None and message.get_type() == "COMMAND_ACK" and message.command == command:
                return int(message.result)
        return None

    def arms(self) -> None:
        """Arm with the stick let go, as who drives must."""
        until(lambda: self.requests(ARM, 1) == ACCEPTED, START_WITHIN_S, "armed")
        self.states(
            0.0, 0.5
        )  # between two requests it was silent: who drives on at once is held as deflected

    def is_reported(self, text: str) -> bool:
        return any(text in each for each in self.texts)


@dataclass
class Bench:
    folder: Path
    programs: dict[str, Program]
    eye: Eye
    port: int
    bus: tuple[str, str] = SOCKETCAN
    """Interface and channel."""
    robot: str = "rars"
    last_node: int = 4
    zeros: tuple[str, ...] = ("lift", "steer")
    """The axes that a person confirms to the bridge to stand at 0."""
    client: Client | None = None

    @property
    def where(self) -> tuple[str, ...]:
        """Return the program's options for its bus."""
        return ("-i", self.bus[0], "-c", self.bus[1])

    def finish(self) -> None:
        """End whatever still runs."""
        if self.client is not None:
            self.client.link.close()
        for program in self.programs.values():
            if program.process.poll() is None:
                program.process.kill()
                program.process.wait()

    def runs(self, name: str, log: Path, command: list[str]) -> Program:
        with log.open("wb") as output:
            process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
        self.programs[name] = Program(process, log)
        return self.programs[name]

    def starts(self, name: str, *arguments: str, before: Sequence[str] = ()) -> Program:
        program = str(Path(sys.executable).parent / "firmware-bridge")
        return self.runs(name, self.folder / f"{name}.txt", [*before, program, *arguments])

    def gets_under_way(self, client: Client, speed: float) -> None:
        """Drive as a person does, who lets the stick go and tries again where a pause was too long.

        On a busy machine a drive may have been kept from following for so long that the bridge disarmed.
        """

        def drives() -> bool:
            client.states(0.0, 0.5)
            client.states(speed, 1.5)
            if 0.6 * speed < self.eye.speed() < 1.2 * speed:
                return True
            client.arms()
            return False

        until(drives, 30.0, f"{speed:g} m/s")

    def joins(self) -> Client:
        self.client = Client(self.port)
        return self.client

    def emulates(self, *more: str) -> Program:
        program = self.starts("emulate", "emulate", self.robot, *self.where, *more)

        def there() -> bool:
            return self.eye.ask(self.last_node, 0x1000) == 0x20192

        until(there, START_WITHIN_S, f"emulator: {program.printed}")
        return program

    def drives(
        self,
        name: str = "drive",
        port: int | None = None,
        before: Sequence[str] = (),
        more: Sequence[str] = (),
    ) -> Program:
        where = f"udpin:127.0.0.1:{self.port if port is None else port}"
        stands = [each for axis in self.zeros for each in ("--zero", f"{axis}=0")]
        stands += ["--state", str(self.folder / f"{name}.json")]
        return self.starts(
            name, "drive", self.robot, *self.where, "--mavlink", where, *stands, *more, before=before
        )
