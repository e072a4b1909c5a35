"""The mission `circles` on the native kernel and FMI pointers, and on Python regulators and FMPy's calls.

Three ways through the same ten thousand steps a second, everything else alike:

* native: the kernel in C calls the plant's FMI functions at their addresses;
* prepared: regulators in Python, the plant's three native calls prepared once;
* FMPy: regulators in Python, each step through the methods of FMPy's own slave object, as its users write it.

All three must leave the same trace; where one does not, the program fails.
"""

import ctypes
import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

import numpy as np

from benchmarks.figure import Figure
from benchmarks.measure import processor_seconds
from emulators.bench import mission
from emulators.bench.operator import ScriptedOperator
from emulators.rig import Rig
from emulators.robots.rars import BENCH_SETUP
from emulators.run import HAND_STREAM
from emulators.servo import kernel
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds
from fmu.build import ensure
from fmu.plant import FmuPlant

MISSION: Final = "circles"
SEED: Final = 0
SECONDS: Final = 6.0
"""Set up, armed and under way by then."""
REPEATS: Final = 2


class FmpyStep:
    """A plant's step by FMPy's own methods, in the place of our prepared calls."""

    def __init__(self, plant: FmuPlant) -> None:
        self._plant = plant
        self._slave: Any = plant._fmu  # noqa: SLF001 - the very object of FMPy that the plant has loaded
        record = plant.record
        self._inputs = _references(record.input_references, record.input_count)
        self._outputs = _references(record.output_references, record.output_count)
        self._step = record.step_ns / 1e9

    def step(self) -> None:
        """Set the inputs, move the plant forward, get the outputs."""
        plant, slave = self._plant, self._slave
        time = plant.record.steps_done * plant.record.step_ns / 1e9
        slave.setReal(self._inputs, list(plant.inputs))
        slave.doStep(currentCommunicationPoint=time, communicationStepSize=self._step)
        plant.outputs[:] = slave.getReal(self._outputs)
        plant.record.steps_done += 1


def _references(address: int, count: int) -> list[int]:
    return list((ctypes.c_uint32 * count).from_address(address))


@dataclass(frozen=True, slots=True)
class Way:
    """One way through the steps."""

    name: str
    servo: str
    by_fmpy: bool = False


WAYS: Final = (
    Way("native kernel, FMI pointers", kernel.NATIVE),
    Way("Python regulators, prepared calls", kernel.REFERENCE),
    Way("Python regulators, FMPy's methods", kernel.REFERENCE, by_fmpy=True),
)


@dataclass(frozen=True, slots=True)
class Result:
    """Cost and result of one way."""

    seconds: float
    """Processor time."""
    trace: str


def driven(way: Way, simulated_s: float) -> Result:
    """Drive the mission's beginning one way, above a plant of FMI 2.0."""
    os.environ[kernel.VARIABLE] = way.servo
    robot = find("rars")
    script = mission.find(MISSION, robot, BENCH_SETUP)
    operator = ScriptedOperator(robot, BENCH_SETUP, script, np.random.default_rng([SEED, HAND_STREAM]))
    plant_path = ensure(robot.plant.fmu, 2)
    rig = Rig(robot, BENCH_SETUP, operator, plant_path=plant_path, seed=SEED, noise=script.noise)
    if way.by_fmpy:
        plant = rig.devices.plant
        plant.step = FmpyStep(plant).step  # type: ignore[method-assign] # here the comparison is made
    spent = processor_seconds(partial(rig.run, from_seconds(simulated_s)))
    rig.finish()
    return Result(spent, rig.world.trace_sha256)


def figures() -> Iterator[Figure]:
    """Measure the three; RuntimeError where a trace differs."""
    runs = [[driven(way, SECONDS) for way in WAYS] for _ in range(REPEATS)]
    if len({result.trace for turn in runs for result in turn}) != 1:
        raise RuntimeError("the ways leave different traces: nothing is compared")
    seconds = [min(result.seconds for result in way) for way in zip(*runs, strict=True)]
    for way, spent in zip(WAYS[1:], seconds[1:], strict=True):
        yield Figure(
            name=f"RARS, circles, by {way.name}",
            value=1e3 * spent / SECONDS,
            unit="ms/s",
            against=WAYS[0].name,
            reference=1e3 * seconds[0] / SECONDS,
        )
