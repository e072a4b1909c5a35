"""The plant of a robot: which one its file names, with which values of its parameters."""

from collections.abc import Iterator, Mapping

from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from fmu.errors import PlantError, UnknownNameError
from fmu.plants import Plant
from fmu.plants import find as find_plant


def plant_parameters(robot: AnyRobot) -> dict[str, float]:
    """Return the plant's parameters that the robot file knows, under the plant's names and in its units.

    The geometry that bridge and plant share wins over the parameter set, single values win over both.
    RobotFileError where plant, set or geometry are unknown.
    """
    plant, chosen = plant_named(robot), robot.plant.parameter_set
    try:
        found = {} if chosen is None else plant.parameter_set(chosen)
    except UnknownNameError as error:
        raise RobotFileError(robot.name, Problem("plant.parameter_set", str(error))) from error
    try:
        found = found | plant.parameters_of(robot) | robot.plant.parameters
    except (UnknownNameError, PlantError) as error:
        raise RobotFileError(robot.name, Problem("plant.fmu", str(error))) from error
    if beyond := tuple(_beyond_stops(robot, plant, found)):
        raise RobotFileError(robot.name, *beyond)
    return found


def _beyond_stops(robot: AnyRobot, plant: Plant, given: Mapping[str, float]) -> Iterator[Problem]:
    """Yield where the bridge lets an axis go to where the plant has its stop."""
    values = {**{row.name: row.start for row in plant.parameters}, **given}
    for index, axis in enumerate(robot.axes):
        if axis.travel is None or axis.name not in plant.stops:
            continue
        for stop, end, sign in zip(plant.stops[axis.name], axis.travel, (-1.0, 1.0), strict=True):
            # The sign makes one test of both ends: further out than the stop.
            if sign * end > sign * values[stop]:
                problem = f"goes to {end:.5g} {axis.unit}, the plant's stop is at {values[stop]:.5g}"
                say = f"narrow it, or use plant.parameters = {{ {stop} = {end:.5g} }}"
                yield Problem(f"axes[{index}].travel", f"{problem}; {say}")


def plant_of(robot: AnyRobot) -> Plant:
    """Return a robot's plant with the values of its file as start values; RobotFileError."""
    return plant_named(robot).starting(plant_parameters(robot))


def plant_named(robot: AnyRobot) -> Plant:
    """Return the plant that a robot file names, as it comes; RobotFileError."""
    try:
        return find_plant(robot.plant.fmu)
    except UnknownNameError as error:
        raise RobotFileError(robot.name, Problem("plant.fmu", str(error))) from error
