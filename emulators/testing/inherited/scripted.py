"""A rig whose operator drives a mission: a name of the robot's missions, or a mission file's text."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.operator import ScriptedOperator
from emulators.rig import Rig
from firmware_bridge.robot import AnyRobot


def mission_of(robot: AnyRobot, text: str) -> missions.Mission:
    """Return a mission of the robot's by its name, or read a file's text."""
    bench_setup = bench_setup_of(robot)
    if "\n" in text:
        return missions.parse(text, "story.toml", robot, bench_setup)
    return missions.find(text, robot, bench_setup)


@contextmanager
def scripted(
    robot: AnyRobot, mission: str | missions.Mission, *, stream: int | tuple[int, int] = 0, **options: Any
) -> Iterator[Rig]:
    """Give a rig on which the operator drives a mission, with its faults; `stream` seeds the operator's hand.

    `options` are the rig's own, and take the place of the mission's.
    """
    script = mission_of(robot, mission) if isinstance(mission, str) else mission
    bench_setup = bench_setup_of(robot)
    operator = ScriptedOperator(robot, bench_setup, script, np.random.default_rng(stream))
    # The mission's own faults and floor, unless the test gives others.
    rig = Rig(script.on(robot), bench_setup, operator, **{"faults": script.fault, **options})
    try:
        yield rig
    finally:
        rig.finish()
