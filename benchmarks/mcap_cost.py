"""Cost of a recording in MCAP: microseconds for each frame, and the share of a whole run on the bench.

The limit is a tenth of a core with a bus of 1 Mbit/s that is never idle: some 9,000 frames a second. A file
of the same frames as `can.log` is beside it. The run is the mission `circles`; its frames, datagrams, poses
and states are recorded.
"""

import io
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final

from benchmarks.figure import Figure
from benchmarks.measure import interleaved
from emulators.bench import mission
from emulators.robots.rars import BENCH_SETUP
from emulators.run import RunOrder, drive
from firmware_bridge.mcap_file.writer import RecordingWriter
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.recording import candump_line
from firmware_bridge.robot_types import find

MISSION: Final = "circles"
FRAMES: Final = 100_000
BUSY: Final = 9_000
"""Frames a second of 8 bytes on a bus of 1 Mbit/s without a pause."""
MOST_SHARE: Final = 0.1
MOST_WITH_FILE: Final = 1.25
SECONDS: Final = 20.0
PACKET: Final = Packet(CAN, 0x281, bytes(range(8)))


def as_mcap() -> int:
    """Write frames as a recording; return its bytes."""
    file = io.BytesIO()
    writer = RecordingWriter(file, {})
    for number in range(FRAMES):
        writer.frame(number * 111_000, CAN, PACKET, sent=False)
    writer.finish()
    return len(file.getvalue())


def as_candump() -> int:
    """Write the same as candump's log."""
    file = io.BytesIO()
    for number in range(FRAMES):
        file.write(f"{candump_line(number * 111_000, PACKET, CAN)}\n".encode())
    return len(file.getvalue())


def runs(order: RunOrder, folder: Path) -> list[Callable[[], object]]:
    """Return the same run without and with a file in MCAP."""
    recorded = replace(order, record=folder / "run.mcap")
    return [lambda one=one: drive(one, lambda _now: None) for one in (order, recorded)]  # type: ignore[misc] # bound now


def figures() -> Iterator[Figure]:
    """Measure a frame in both forms, and what a file adds to a run."""
    mcap, candump = (1e6 * taken / FRAMES for taken in interleaved([as_mcap, as_candump]))
    yield Figure(
        name="a frame to a recording in MCAP",
        value=mcap,
        unit="us",
        against="a line of candump's",
        reference=candump,
    )
    yield Figure(
        name=f"MCAP of {BUSY} frames/s",
        value=mcap * BUSY / 1e4,
        unit="%",
        against="a core",
        reference=100.0,
        goal=MOST_SHARE,
    )
    rars = find("rars")
    script = mission.find(MISSION, rars, BENCH_SETUP).model_copy(update={"duration_s": SECONDS})
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        order = RunOrder(rars, BENCH_SETUP, MISSION, script, 0, folder / "results")
        plain, recorded = interleaved(runs(order, folder), 2)
    yield Figure(
        name="bench rars with --record",
        value=recorded,
        unit="s",
        against="without",
        reference=plain,
        goal=MOST_WITH_FILE,
    )
