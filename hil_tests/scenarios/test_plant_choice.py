"""Choice of the plant below the drives: a named set of parameters, or single values of the robot file."""

import pytest

from emulators.robot_plant import plant_parameters
from firmware_bridge.robot import PlantFile, RobotFileError
from firmware_bridge.robot_types import find


def rars(**plant: object) -> dict[str, float]:
    robot = find("rars")
    return plant_parameters(
        robot.model_copy(update={"plant": PlantFile.model_validate({"fmu": "rars", **plant})})
    )


def test_a_parameter_set_is_chosen_by_name() -> None:
    assert rars(parameter_set="A") == rars(), "the thesis's table is what the plant begins with"
    assert rars(parameter_set="B")["yaw_inertia"] == 3.2


def test_the_robots_geometry_wins_over_the_set_and_single_values_over_both() -> None:
    assert rars(parameter_set="B")["rear_track"] == find("rars").geometry.base.rear_track_m
    assert rars(parameter_set="B", parameters={"rear_track": 0.21})["rear_track"] == 0.21


def test_a_set_that_does_not_exist_is_refused_by_key() -> None:
    with pytest.raises(RobotFileError, match=r"plant\.parameter_set.*'C'.*A, B"):
        rars(parameter_set="C")
