"""Plants for the tests of this folder: built once, closed after each test."""

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Final

import pytest

from firmware_bridge.units import SECOND
from fmu.build import ensure, export
from fmu.plant import FmuPlant
from fmu.rars.interface import INPUTS, OUTPUTS
from hil_tests.fmu.instance import Instance, Maker
from hil_tests.fmu.pendulum import pendulum

FINE: Final = 50_000
"""A step in ns for closed forms in their limits, where tyres are stiffer or nothing damps.

The plant takes no larger step than the requested one, nor than 0.1 ms.
"""

NOTHING: Mapping[str, float] = MappingProxyType({})


class Bench:
    """A plant with all of its outputs by name."""

    def __init__(self, plant: FmuPlant, step: int) -> None:
        self.plant = plant
        self.step = step

    def runs(self, seconds: float, **voltages: float) -> dict[str, float]:
        """Hold the voltages (others 0) for this time; return the outputs."""
        for i, name in enumerate(INPUTS):
            self.plant.inputs[i] = voltages.get(name.removeprefix("voltage_"), 0.0)
        for _ in range(round(seconds * SECOND / self.step)):
            self.plant.step()
        return self.now()

    def now(self) -> dict[str, float]:
        return dict(zip(OUTPUTS, self.plant.outputs, strict=True))

    def energy(self) -> float:
        return self.plant.read("energy")


PlantMaker = Callable[..., Bench]


@pytest.fixture(scope="session")
def fmu_file() -> dict[int, Path]:
    return {2: ensure("rars", 2), 3: ensure("rars", 3)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("unzipped")


@pytest.fixture(scope="session")
def pendulums(tmp_path_factory: pytest.TempPathFactory) -> Callable[[int], Path]:
    """Return the FMU of a model that is no robot, for FMI 2 or 3, exported at the first request."""
    folder = tmp_path_factory.mktemp("pendulums")

    @cache
    def exported(fmi: int) -> Path:
        path = folder / f"pendulum{fmi}.fmu"
        export(pendulum(), fmi, path, token="{pendulum}")  # noqa: S106 - no password
        return path

    return exported


@pytest.fixture
def made(fmu_file: dict[int, Path], folder: Path) -> Iterator[Maker]:
    instances: list[Instance] = []

    def make(fmi: int, kind: str = "slave") -> Instance:
        instances.append(Instance(fmu_file[fmi], folder / str(fmi), kind, logging=True))
        return instances[-1]

    yield make
    for instance in instances:
        instance.fmu.freeInstance()


@pytest.fixture
def bench(fmu_file: dict[int, Path]) -> Iterator[PlantMaker]:
    opened: list[FmuPlant] = []

    def make(parameters: Mapping[str, float] = NOTHING, *, fmi: int = 3, step: int = 100_000) -> Bench:
        plant = FmuPlant(fmu_file[fmi], list(INPUTS), list(OUTPUTS), parameters, step)
        opened.append(plant)
        return Bench(plant, step)

    yield make
    for plant in opened:
        plant.close()
