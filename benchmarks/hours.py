"""Simulated hours that a core drives in an hour, measured over minutes, with reports and recordings off.

Usage: python -m benchmarks.hours [MINUTES]    of each robot; 10 by default.

Exit status 1 where a robot drives less than the goal of `benchmarks.parts`.
"""

import sys
import time
from itertools import count
from typing import Final

from benchmarks.measure import show
from benchmarks.parts import HOUR_ROBOTS, HOURS_GOAL, SUBJECTS, Driven, rig_of
from emulators.bench import mission
from emulators.bench.bench_setup import bench_setup_of
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds

MINUTES: Final = 10.0


def hours_an_hour(subject: Driven, minutes: float) -> float:
    """Drive a mission again and again, each time with another seed, for so long; setting up counts."""
    robot = find(subject.robot)
    duration_s = mission.find(subject.mission, robot, bench_setup_of(robot)).duration_s
    driven, begun = 0.0, time.process_time()
    for seed in count():
        rig = rig_of(subject, seed)
        rig.run(from_seconds(duration_s))
        rig.finish()
        driven += duration_s
        if time.process_time() - begun >= 60.0 * minutes:
            break
    return driven / (time.process_time() - begun)


def main(minutes: float) -> int:
    """Measure and print."""
    found = {one.title: hours_an_hour(one, minutes) for one in SUBJECTS if one.robot in HOUR_ROBOTS}
    rows = [(title, f"{hours:.1f}", f">= {HOURS_GOAL:g}") for title, hours in found.items()]
    show(f"simulated hours an hour of a core, over {minutes:g} minutes", ("mission", "hours", "goal"), rows)
    return 0 if min(found.values()) >= HOURS_GOAL else 1


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else MINUTES))
