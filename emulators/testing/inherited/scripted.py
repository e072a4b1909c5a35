"""A rig whose operator drives a mission: a name of the robot's missions, or a mission file's text."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.operator import ScriptedOperator
from emulators.bench.rehearsal import rehearsal_of
from emulators.rig import Rig
from firmware_bridge.robot import AnyRobot


def mission_of(robot: AnyRobot, text: str) -> missions.Mission:
    """Return a mission of the robot's by its name, or read a file's text."""
    rehearsal = rehearsal_of(robot)
    if "\n" in text:
        return missions.parse(text, "story.toml", robot, rehearsal)
    return missions.find(text, robot, rehearsal)


@contextmanager
def scripted(
    robot: AnyRobot, mission: str | missions.Mission, *, stream: int | tuple[int, int] = 0, **options: Any
) -> Iterator[Rig]:
    """Give a rig on which the operator drives a mission, with its faults; `stream` seeds the operator's hand.

    `options` are the rig's own, and take the place of the mission's.
    """
    script = mission_of(robot, mission) if isinstance(mission, str) else mission
    rehearsal = rehearsal_of(robot)
    operator = ScriptedOperator(robot, rehearsal, script, np.random.default_rng(stream))
    rig = Rig(script.on(robot), rehearsal, operator, **{"faults": script.fault, **options})
    try:
        yield rig
    finally:
        rig.finish()
