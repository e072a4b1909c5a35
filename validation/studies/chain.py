"""A mission through the whole chain, for studies: operator, link, bridge, devices, plant."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.columns import Samples
from emulators.bench.mission import Mission
from emulators.bench.operator import ScriptedOperator
from emulators.bench.piloted import PilotedMission
from emulators.bench.records import InterlockEvent
from emulators.rig import Rig
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import from_seconds

if TYPE_CHECKING:
    from firmware_bridge.node import Node

HAND_STREAM: Final = 0
"""Stream of random numbers for the hand, beside the seed: that of `emulators.run`."""


@dataclass(frozen=True, slots=True)
class Driven:
    """A mission that was driven, and what became of it."""

    samples: Samples
    interlock_events: tuple[InterlockEvent, ...]


def driven(robot: AnyRobot, mission: Mission, seconds: float | None = None, *, seed: int = 0) -> Driven:
    """Drive it to its end, or for so many seconds, with its pilot or by its steps, as `bench` does."""
    robot, bench_setup = mission.on(robot), bench_setup_of(robot)
    operator: Node = (
        ScriptedOperator(robot, bench_setup, mission, np.random.default_rng([seed, HAND_STREAM]))
        if mission.pilot is None
        else PilotedMission(robot, mission.step, mission.pilot)
    )
    rig = Rig(
        robot,
        bench_setup,
        operator,
        seed=seed,
        noise=mission.noise,
        link=mission.conditions,
        faults=mission.fault,
    )
    try:
        rig.run(from_seconds(mission.duration_s if seconds is None else seconds))
    finally:
        rig.finish()
    return Driven(rig.samples, tuple(rig.interlock_events))
