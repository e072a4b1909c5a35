"""Search for false alarms on a robot that is well: ordinary missions, seed after seed, on two floors.

Usage: python -m benchmarks.false_alarms [MINUTES]    simulated time; 5 by default, `make hour` drives 60.

Exit status 1 where an axis is stopped that follows its commands. The missions bring an operator's tremor and
late datagrams; the second floor has half the grip.
"""

import sys
from itertools import count, cycle
from typing import Final

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.operator import ScriptedOperator
from emulators.rig import Rig
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds

MINUTES: Final = 5
DRIVEN: Final = (
    ("rars", "interlocks"),
    ("rars", "circles"),
    ("rars", "line"),
    ("diff_drive", "figure_eight"),
    ("diff_drive", "interlocks"),
)
FLOORS: Final = (None, 0.15)
"""The plant's own, and one so slippery."""
ALARMS: Final = (
    "axis timeout",
    "axis fault",
    "late answer",
    "axis restarted",
    "no feedback",
    "tracking error",
    "uncommanded motion",
    "position not changing",
    "link lost",
    "second controller",
    "battery low",
)
"""Interlocks of failures; those that follow an emergency stop or a lost reference are not among them."""


def alarms(robot: AnyRobot, mission: str, seed: int) -> tuple[float, list[str]]:
    """Drive a mission; return its seconds, and what was held although nothing has failed."""
    bench_setup = bench_setup_of(robot)
    script = missions.find(mission, robot, bench_setup)
    operator = ScriptedOperator(robot, bench_setup, script, np.random.default_rng(seed))
    rig = Rig(robot, bench_setup, operator, seed=seed, noise=script.noise, faults=script.fault)
    rig.run(from_seconds(script.duration_s))
    events = [
        f"{event.name}: {event.reason}" for event in rig.interlock_events if event.name.startswith(ALARMS)
    ]
    rig.finish()
    return script.duration_s, events


def main() -> int:
    """Drive for the requested time."""
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else MINUTES
    driven, found = 0.0, 0
    for seed, ((name, mission), floor) in zip(
        count(), cycle((one, floor) for floor in FLOORS for one in DRIVEN)
    ):
        if driven >= 60.0 * minutes:
            break
        robot = find(name)
        if floor is not None:
            plant = robot.plant.model_copy(update={"parameters": {"floor_friction": floor}})
            robot = robot.model_copy(update={"plant": plant})
        seconds, events = alarms(robot, mission, seed)
        driven += seconds
        found += len(events)
        for text in events:
            print(f"{name}, {mission}, seed {seed}, floor {floor or 'its own'}: {text}")
    print(f"{driven / 60.0:.0f} minutes of missions: {found} false alarms")
    return int(found > 0)


if __name__ == "__main__":
    sys.exit(main())
