"""Stop-watches around the parts of a bench, and the bench of RARS's circles, by which others are measured."""

import os
import time
from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np

from benchmarks.measure import fastest
from emulators import world
from emulators.bench import mission
from emulators.bench.operator import ScriptedOperator
from emulators.rig import Rig
from emulators.robots.rars import BENCH_SETUP
from emulators.run import HAND_STREAM
from emulators.servo import kernel
from emulators.world import Physics
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds

MISSION: Final = "circles"
SEED: Final = 0
COMPILED: Final = not str(world.__file__).endswith(".py")


class StopWatches:
    """Adds up the time that each part takes; no part calls another."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.calls: dict[str, int] = {}

    def around(self, part: str, call: Callable[..., object]) -> Callable[..., object]:
        """Return the call with the watch of this part around it."""
        seconds, calls = self.seconds, self.calls
        seconds.setdefault(part, 0.0)
        calls.setdefault(part, 0)

        def timed(*arguments: object) -> object:
            begun = time.process_time()
            result = call(*arguments)
            seconds[part] += time.process_time() - begun
            calls[part] += 1
            return result

        return timed


class Watched:
    """The physics with a watch around it."""

    def __init__(self, physics: Physics, watches: StopWatches) -> None:
        self.advance = watches.around("servo", physics.advance)


def split(watched: Rig, simulated_s: float, parts: Mapping[str, str]) -> tuple[float, StopWatches]:
    """Return the seconds of a watched run, and its watches: one for each part, by the nodes' names."""
    watches = StopWatches()
    inner: Any = watched.world
    inner._physics = Watched(inner._physics, watches)  # noqa: SLF001 - a watch must sit where nothing else does
    for name, station in inner._stations.items():  # noqa: SLF001
        for call in ("receive", "wake"):
            setattr(station, call, watches.around(parts.get(name, "drives"), getattr(station, call)))
    return fastest(lambda: watched.run(from_seconds(simulated_s)), 1), watches


def rig_and_operator(servo: str = "") -> tuple[Rig, ScriptedOperator]:
    """Build the robot with its operator, at the start of the mission."""
    os.environ[kernel.VARIABLE] = servo
    robot = find("rars")
    script = mission.find(MISSION, robot, BENCH_SETUP)
    operator = ScriptedOperator(robot, BENCH_SETUP, script, np.random.default_rng([SEED, HAND_STREAM]))
    return Rig(robot, BENCH_SETUP, operator, seed=SEED, noise=script.noise), operator
