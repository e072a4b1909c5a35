"""The emulated half of a robot: the devices of all its links above one plant, on the bench or real ports."""

from collections.abc import Callable, Sequence
from pathlib import Path

from emulators.family import BuildOrder, Devices, EmulatedFamily, Observed, Plan, Station, families_of
from emulators.physics import Physics
from emulators.robot_plant import plant_named, plant_parameters
from emulators.servo.fmu_axes import PlantNeeds, load_plant
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from fmu.build import ensure
from fmu.plant import FmuPlant


def devices(
    robot: AnyRobot,
    plant_path: Path | None = None,
    *,
    outputs: Sequence[str] = (),
    seed: int = 0,
    realistic_latency: bool = False,
    on_bench: bool = False,
    on_lines: bool = True,
    report: Callable[[str], None] | None = None,
    options: Sequence[object] = (),
) -> Devices:
    """Build a robot's devices above its plant; PlantError where the plant cannot be used.

    `outputs` are the plant's that someone wants to look at, whether a device needs them or not; the others
    are as in `emulators.family.BuildOrder`. RobotFileError where the devices cannot be built, StorageError
    where saved parameters cannot be read.

    Geometry that both know is set from the robot file into our own plant, so that they agree; a plant of the
    user's is taken as it is, with the parameters that the robot file lists for it.
    """
    if plant_path is None:
        path, parameters = ensure(plant_named(robot)), plant_parameters(robot)
    else:
        path, parameters = plant_path, robot.plant.parameters
    order = BuildOrder(
        robot=robot,
        seed=seed,
        realistic_latency=realistic_latency,
        on_bench=on_bench,
        on_lines=on_lines,
        report=report,
        options=tuple(options),
    )
    families = families_of(robot)
    plans = _leader_first(robot, [plan for family in families for plan in family.plans(order)])
    needs = [*(plan.needs for plan in plans), *(family.sees for family in families)]
    plant = load_plant(path, needs, parameters, outputs, plans[0].every)
    return _above(plant, plans, families, order)


def needs_of(robot: AnyRobot) -> tuple[PlantNeeds, ...]:
    """Return the needs of a robot's devices, first those of the one that steps the plant; RobotFileError."""
    order, families = BuildOrder(robot=robot), families_of(robot)
    plans = _leader_first(robot, [plan for family in families for plan in family.plans(order)])
    return (*(plan.needs for plan in plans), *(family.sees for family in families))


def _leader_first(robot: AnyRobot, plans: Sequence[Plan]) -> Sequence[Plan]:
    """Return the plans, first that of the devices that step the plant; RobotFileError where none can."""
    if not plans:
        raise RobotFileError(robot.name, Problem("links", "no device on them moves an emulated plant"))
    leader, *others = sorted(plans, key=lambda plan: (plan.follows, plan.every))
    owners = dict.fromkeys(leader.needs.inputs, leader.title)
    for other in others:
        if not other.follows or other.every % leader.every:
            problem = f"{leader.title} and {other.title} cannot move one plant: each steps it in its own time"
            raise RobotFileError(robot.name, Problem("links", problem))
        for name in other.needs.inputs:
            if owners.setdefault(name, other.title) != other.title:
                problem = f"{owners[name]} and {other.title} both set the plant's input '{name}'"
                raise RobotFileError(robot.name, Problem("links", problem))
    return (leader, *others)


def _above(
    plant: FmuPlant, plans: Sequence[Plan], families: Sequence[EmulatedFamily], order: BuildOrder
) -> Devices:
    """Build the devices above their plant."""
    built = [plan.build(plant, plan is plans[0]) for plan in plans]
    turn = min(plan.every for plan in (plans[1:] or plans))
    actuated = Physics(built[0].actuators, [one.actuators for one in built[1:]], turn)
    stations: dict[str, Station] = {}
    for one in built:
        stations |= one.stations
    seen = Observed({}, actuated)
    for family in families:
        if family.observe is not None:
            more = family.observe(order, plant, seen.physics)
            seen = Observed({**seen.stations, **more.stations}, more.physics)
    return Devices({**stations, **seen.stations}, actuated, plant, seen.physics)
