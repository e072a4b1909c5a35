"""Speed of ROME's circle against real time, with cameras at 240 Hz or none, beside RARS's circles.

Usage: python -m benchmarks.rome [SECONDS]    simulated time; 30 by default.

The board speaks ros_arduino_bridge. Times are the processor's, the fastest of some runs; the robots take
turns, so that a ratio compares the same minute. With the core compiled the same is measured once more by an
interpreter, as it stands in this checkout. The shares come from a run with stop-watches, which is slower.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

import numpy as np

from benchmarks import realtime
from benchmarks.measure import interleaved, show
from benchmarks.realtime import COMPILED, SEED, print_rows, rows_of, split
from emulators.arduino_omni.board import Board
from emulators.bench import mission
from emulators.bench.operator import ScriptedOperator
from emulators.motion_capture.system import MotionCapture
from emulators.rig import BRIDGE, OPERATOR_STATION, Rig
from emulators.robots.rome import BENCH_SETUP
from emulators.run import HAND_STREAM
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds

MISSION: Final = "circle"
RATE_HZ: Final = 240
LEAST: Final[Mapping[bool, float]] = {False: 30.0, True: 100.0}
"""Times real time with cameras, the core interpreted and compiled."""
NAMES: Final = ("RARS, circles", "ROME, circle", "ROME, circle, cameras at 240 Hz")


def rig(*, captured: bool) -> Rig:
    """Build the robot with its operator, at the start of the mission."""
    robot = find("rome+cameras" if captured else "rome")
    script = mission.find(MISSION, robot, BENCH_SETUP)
    operator = ScriptedOperator(robot, BENCH_SETUP, script, np.random.default_rng([SEED, HAND_STREAM]))
    return Rig(robot, BENCH_SETUP, operator, seed=SEED, noise=script.noise)


def drive(simulated_s: float, *, captured: bool) -> None:
    """Run the mission; RuntimeError where the base stood, or the cameras saw nothing."""
    one = rig(captured=captured)
    one.run(from_seconds(simulated_s))
    if min(map(abs, one.devices.nodes(Board)["board"].motors.angles)) < 1.0:
        raise RuntimeError("the base stood")
    if any(it.frames < RATE_HZ * (simulated_s - 1.0) for it in one.devices.nodes(MotionCapture).values()):
        raise RuntimeError("the cameras saw nothing")
    one.finish()


def times(simulated_s: float) -> list[float]:
    """Return the processor's seconds of RARS, of ROME, and of ROME with cameras."""
    runs: list[Callable[[], object]] = [
        lambda: realtime.undisturbed(simulated_s, runs=1),
        lambda: drive(simulated_s, captured=False),
        lambda: drive(simulated_s, captured=True),
    ]
    return interleaved(runs)


def interpreted(simulated_s: float) -> list[float]:
    """Return the same times by the same Python, with the core as it stands in this checkout."""
    checkout = Path(__file__).parents[1]
    call = f"import json; from benchmarks.rome import *; print(json.dumps(times({simulated_s})))"
    reported = subprocess.run(  # noqa: S603 - this file, by this interpreter
        [sys.executable, "-c", call],
        env=os.environ | {"PYTHONPATH": str(checkout)},
        capture_output=True,
        text=True,
        check=True,
    )
    found: list[float] = json.loads(reported.stdout)
    return found


def reported(simulated_s: float, taken: list[float], *, compiled: bool) -> bool:
    """Print a table; return whether ROME with cameras is as fast as it shall be."""
    rows = [
        (name, f"{it:.2f} s", f"{simulated_s / it:.1f}", f"{it / taken[0]:.2f}")
        for name, it in zip(NAMES, taken, strict=True)
    ]
    core = "compiled" if compiled else "interpreted"
    head = ("mission", "processor", "times real time", "of RARS's time")
    show(f"{simulated_s:g} s simulated, core {core}", head, rows)
    factor, least = simulated_s / taken[-1], LEAST[compiled]
    if factor < least:
        print(f"{NAMES[-1]}: {factor:.1f} times real time is below {least:g}", file=sys.stderr)
    return factor >= least


def main(simulated_s: float) -> int:
    """Print the factors and where the time goes; fail where ROME is too slow."""
    kept = reported(simulated_s, times(simulated_s), compiled=COMPILED)
    if COMPILED:
        kept = reported(simulated_s, interpreted(simulated_s), compiled=False) and kept
    watched = rig(captured=True)
    parts = {BRIDGE: "bridge", OPERATOR_STATION: "operator", "board": "board as a node"}
    parts |= dict.fromkeys(watched.devices.nodes(MotionCapture), "cameras")
    whole, watches = split(watched, simulated_s, parts)
    watched.finish()
    rows = rows_of(whole, watches, simulated_s)
    rows["board and plant"] = rows.pop(
        "servo"
    )  # who moves the physics on moves the board's sketch and bus, too
    print_rows(whole, rows)
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else 30.0))
