"""Cost of a recording in MCAP: microseconds for each frame, and the share of a whole run on the bench.

Usage: python -m benchmarks.mcap_cost [SECONDS]    simulated time of the run; 60 by default.

The limit is a tenth of a core with a bus of 1 Mbit/s that is never idle: some 9,000 frames a second. A file
of the same frames as `can.log` is beside it. The run is the mission `circles`; its frames, datagrams, poses
and states are recorded.
"""

import io
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final

from benchmarks.measure import fastest, interleaved, show
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
MOST_US: Final = 0.1 * 1e6 / BUSY
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


def one_frame() -> float:
    """Print the cost of a frame in both forms; return that of MCAP in microseconds."""
    rows, costs = [], []
    for title, run in (("MCAP", as_mcap), ("candump", as_candump)):
        cost = 1e6 * fastest(run) / FRAMES
        costs.append(cost)
        share = f"{cost * BUSY / 1e4:.1f} %"
        rows.append([title, f"{cost:.1f}", share, f"{run() / FRAMES:.0f}"])
    head = ("file", "us a frame", f"of a core at {BUSY} frames/s", "bytes a frame")
    show("One frame to a file in memory", head, rows)
    return costs[0]


def runs(order: RunOrder, folder: Path) -> list[Callable[[], object]]:
    """Return the same run without and with a file in MCAP."""
    recorded = replace(order, record=folder / "run.mcap")
    return [lambda one=one: drive(one, lambda _now: None) for one in (order, recorded)]  # type: ignore[misc] # bound now


def whole_run(seconds: float) -> None:
    """Print what the file adds to a run."""
    rars = find("rars")
    script = mission.find(MISSION, rars, BENCH_SETUP).model_copy(update={"duration_s": seconds})
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        order = RunOrder(rars, BENCH_SETUP, MISSION, script, 0, folder / "results")
        plain, recorded = interleaved(runs(order, folder))
        size = (folder / "run.mcap").stat().st_size
    rows = [
        ["without", f"{plain:.2f}", "", ""],
        ["with", f"{recorded:.2f}", f"{100 * (recorded / plain - 1):.1f} %", f"{size / 1e6:.1f}"],
    ]
    head = ("recording", "processor s", "more", "MB")
    show(f"bench rars --mission {MISSION}, {seconds:g} s, pictures included", head, rows)


def main() -> int:
    """Print both; return 1 where a frame costs more than the limit."""
    cost = one_frame()
    whole_run(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0)
    return int(cost > MOST_US)


if __name__ == "__main__":
    sys.exit(main())
