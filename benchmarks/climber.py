"""Speed of the climber's square against real time, with cameras or none, beside RARS's circles.

Usage: python -m benchmarks.climber [SECONDS]    simulated time; 60 by default.

Times are the processor's, the fastest of some runs; the robots take turns, so that a ratio compares the same
minute.
"""

import sys
from typing import Final

import numpy as np

from benchmarks.measure import interleaved, show
from benchmarks.realtime import COMPILED, SEED, undisturbed
from emulators.bench import mission
from emulators.bench.operator import ScriptedOperator
from emulators.rig import Rig
from emulators.robots.climber import BENCH_SETUP
from emulators.run import HAND_STREAM
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds

MISSION: Final = "square"
LEAST: Final = 20.0
"""Times real time without cameras; with the core compiled, with cameras, too."""
DRIVEN_M: Final = 0.1
NAMES: Final = ("RARS, circles", "climber, square", "climber, square, cameras at 240 Hz")


def drive(robot_name: str, simulated_s: float) -> None:
    """Run the mission; RuntimeError where the robot stood."""
    robot = find(robot_name)
    script = mission.find(MISSION, robot, BENCH_SETUP)
    operator = ScriptedOperator(robot, BENCH_SETUP, script, np.random.default_rng([SEED, HAND_STREAM]))
    one = Rig(robot, BENCH_SETUP, operator, seed=SEED, noise=script.noise)
    one.run(from_seconds(simulated_s))
    if np.ptp(one.samples.column("y_m")) < DRIVEN_M:
        raise RuntimeError("the climber stood")
    one.finish()


def main(simulated_s: float) -> int:
    """Print the factors; fail where the climber is too slow."""
    taken = interleaved(
        [
            lambda: undisturbed(simulated_s, runs=1),
            lambda: drive("climber", simulated_s),
            lambda: drive("climber+cameras", simulated_s),
        ]
    )
    rows = [
        (name, f"{it:.2f} s", f"{simulated_s / it:.1f}", f"{it / taken[0]:.2f}")
        for name, it in zip(NAMES, taken, strict=True)
    ]
    core = "compiled" if COMPILED else "interpreted"
    head = ("mission", "processor", "times real time", "of RARS's time")
    show(f"{simulated_s:g} s simulated, core {core}", head, rows)
    judged = taken[1:] if COMPILED else taken[1:2]
    slow = [simulated_s / it for it in judged if simulated_s / it < LEAST]
    if slow:
        print(f"climber: {min(slow):.1f} times real time is below {LEAST:g}", file=sys.stderr)
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0))
