"""A robot's plant in a test's hands: its names, its parameters, its time, and what it refuses."""

import csv
from collections.abc import Iterator
from pathlib import Path

import pytest

from emulators.robot_plant import plant_parameters
from emulators.testing.errors import RigError
from emulators.testing.plant import VirtualPlant
from firmware_bridge.robot_types import find

ROBOT = "rome"
REFERENCE = Path(__file__).parents[2] / "validation" / "references" / "rome_base.csv"


@pytest.fixture
def plant() -> Iterator[VirtualPlant]:
    made = VirtualPlant(find(ROBOT, plant_too=True))
    yield made
    made.finish()


def test_it_has_the_names_of_its_reference_and_the_parameters_of_the_robot(plant: VirtualPlant) -> None:
    with REFERENCE.open(encoding="utf-8") as file:
        time, *names = next(csv.reader(file))
    assert time == "time"
    assert set(plant.outputs) == set(names)
    wanted = plant_parameters(find(ROBOT))
    assert wanted
    assert {name: plant.reads(name) for name in wanted} == wanted
    assert plant.unit("speed") == "m/s"


def test_it_moves_where_its_motors_have_volts_and_its_time_is_its_own(plant: VirtualPlant) -> None:
    assert plant.now == 0.0
    plant.sets(voltage_two=-6.0, voltage_three=6.0)
    plant.runs(seconds=0.5)
    assert plant.now == 0.5
    assert plant.reads("speed") > 0.05
    assert plant.reads("x") > 0.01


def test_what_it_has_not_is_refused_with_all_there_is(plant: VirtualPlant) -> None:
    with pytest.raises(RigError, match=r"the plant of rome has no 'wings'; it has .*battery_voltage"):
        plant.reads("wings")
    with pytest.raises(RigError, match=r"has no 'voltage_four'; it has voltage_one, voltage_two"):
        plant.sets(voltage_one=12.0, voltage_four=1.0)
    plant.runs(seconds=0.1)
    assert plant.reads("speed_one") == 0.0, "nothing is set where one name is wrong"
