"""Cost of `monitor` on a full bus: 9,000 frames a second, received and shown, and frames put into words.

Frames of a mission are sent by another process through a socket pair, each a struct can_frame as SocketCAN
gives it; the monitor's own port, runner, picture and table take them. The decoding is compared with splitting
the same lines of a candump log into instant, bus, identifier and bytes, in the same run.
"""

import io
import socket
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final
from unittest.mock import patch

from rich.console import Console

from benchmarks.figure import Figure
from benchmarks.measure import interleaved
from emulators.bench import mission
from emulators.bench.bench_setup import bench_setup_of
from emulators.run import RunOrder, drive
from firmware_bridge.cli.monitor import Listening
from firmware_bridge.cli.monitor_clock import GatheringClock
from firmware_bridge.cli.monitor_table import drawn
from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.recording import parse_candump
from firmware_bridge.robot_types import find
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import socketcan
from firmware_bridge.runtime.runner import run
from firmware_bridge.units import SECOND

FRAMES_A_SECOND: Final = 9000
SECONDS: Final = 10
BURSTS_A_SECOND: Final = 1000
FRAME: Final = struct.Struct("=IB3x8s")
BIT_RATE: Final = 1_000_000
GOAL_PERCENT: Final = 15.0
GOAL_RATIO: Final = 8.0
SENDER: Final = "--send"


def recorded(folder: Path) -> list[str]:
    """Return the lines of a mission's recording of its bus."""
    robot = find("rars")
    setup = bench_setup_of(robot)
    drive(RunOrder(robot, setup, "line", mission.find("line", robot, setup), 0, folder), lambda _: None)
    return (folder / "can.log").read_text(encoding="ascii").splitlines()


def send(fileno: int, path: str) -> None:
    """Send the frames of a file at a steady rate, so many a burst; from the other process."""
    content = Path(path).read_bytes()
    frames = [content[begin : begin + FRAME.size] for begin in range(0, len(content), FRAME.size)]
    with socket.socket(fileno=fileno) as out:
        clock, count = Clock(), len(frames)
        for burst in range(SECONDS * BURSTS_A_SECOND):
            first = burst * FRAMES_A_SECOND // BURSTS_A_SECOND
            for number in range(first, (burst + 1) * FRAMES_A_SECOND // BURSTS_A_SECOND):
                out.send(frames[number % count])
            clock.wait((), (burst + 1) * SECOND // BURSTS_A_SECOND)


def live(lines: list[str], folder: Path) -> tuple[float, int]:
    """Return the processor's share of a monitor in percent of a core, and how many frames it has shown."""
    packets = [parse_candump(line)[2] for line in lines]
    path = folder / "frames"
    path.write_bytes(b"".join(FRAME.pack(it.address, len(it.payload), it.payload) for it in packets))
    mine, yours = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    mine.settimeout(0)
    picture, console = BusPicture(BIT_RATE, device="epos2"), Console(file=io.StringIO(), force_terminal=True)
    node = Listening(picture, lambda _: None, lambda: console.print(drawn(picture)))
    words = [sys.executable, "-m", "benchmarks.monitor_live", SENDER, str(yours.fileno()), str(path)]
    with patch.object(socketcan, "_opened", lambda *_: mine):
        port = socketcan.SocketCanPort("socketpair", BIT_RATE)
    with subprocess.Popen(words, pass_fds=[yours.fileno()]) as sender:  # noqa: S603 - it is this file
        yours.close()
        spent = time.process_time()
        run(node, {CAN: port}, GatheringClock(), until=SECONDS * SECOND)
        # The other process needs a while to begin; only the time of frames counts.
        percent = 100.0 * (time.process_time() - spent) * FRAMES_A_SECOND / max(1, picture.frames)
        sender.kill()
    return percent, picture.frames


def words_and_splits(lines: list[str]) -> tuple[float, float]:
    """Return the seconds of putting each frame into words, and of splitting the lines."""
    packets = [
        (at, Packet(CAN, packet.address, packet.payload)) for at, _, packet in map(parse_candump, lines)
    ]

    def decode() -> None:
        picture = BusPicture(BIT_RATE, device="epos2")
        for at, packet in packets:
            picture.note(at, packet)
            picture.text_of(packet)

    def split() -> None:
        for line in lines:
            parse_candump(line)

    decoded, splits = interleaved([decode, split])
    return decoded, splits


def figures() -> Iterator[Figure]:
    """Measure a monitor in another process's stream, and words against splits."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        lines = recorded(folder)
        percent, _ = live(lines, folder)
    decoded, splits = words_and_splits(lines)
    yield Figure(
        name=f"monitor, {FRAMES_A_SECOND} frames/s",
        value=percent,
        unit="%",
        against="a core",
        reference=100.0,
        goal=GOAL_PERCENT / 100.0,
    )
    yield Figure(
        name="a frame in words",
        value=1e6 * decoded / len(lines),
        unit="us",
        against="a line of candump's split",
        reference=1e6 * splits / len(lines),
        goal=GOAL_RATIO,
    )


if __name__ == "__main__":
    # The other process, which sends.
    with suppress(ConnectionError):  # the monitor has seen enough
        send(int(sys.argv[2]), sys.argv[3])
