"""The plain servo as a family of emulated devices: drives of a robot file above a plant, on their CAN bus."""

from functools import partial
from typing import TYPE_CHECKING, Final

from emulators.cia402.servo import Servo
from emulators.cia402.variations import PLAIN
from emulators.family import (
    BuildOrder,
    Built,
    CanBus,
    EmulatedFamily,
    Plan,
    Station,
    Trait,
    Way,
)
from emulators.parameter_files import Storages
from emulators.servo.axis import TICK, ServoAxis
from emulators.servo.fmu_axes import SUPPLY, axis_needs, fmu_bank, set_motor, winding_of
from emulators.servo.scaling import Settings
from emulators.servo.tuning import tuned
from firmware_bridge.canopen import objects as od
from firmware_bridge.families.cia402.settings import Cia402Axis, Cia402Driver, Cia402Link, Home
from firmware_bridge.families.cia402.wire import address as at
from firmware_bridge.node import CAN
from firmware_bridge.robot import AnyRobot, Axis, Problem, RobotFileError
from firmware_bridge.units import QUADCOUNTS_PER_LINE
from fmu.plant import FmuPlant

if TYPE_CHECKING:
    from collections.abc import Sequence

    from emulators.bench.faults.kind import FaultKind
    from emulators.cli.emulate_robot import RobotOptions
    from emulators.cli.emulation import Emulation
    from emulators.new_drive import AxisDrive, AxisTable

MOST_COUNTS: Final = 400_000
"""Of the emulated encoder in one turn."""
NOMINAL_INERTIA: Final = 1e-5
"""At a shaft for which the robot file names no tuning, kg m2 (assumed)."""
NO_CONSTANT: Final = 0.05
"""Torque constant where the plant has none, N m/A (assumed)."""


def _axes(robot: AnyRobot) -> list[Axis]:
    links = Cia402Link.all_of(robot)
    return [axis for axis in robot.axes if axis.link in links]


def _turned(robot: AnyRobot) -> list[str]:
    """Return the axes whose motor is mounted the other way round: its forwards is the axis's backwards."""
    return [axis.name for axis in _axes(robot) if axis.direction < 0]


def _plans(order: BuildOrder) -> tuple[Plan, ...]:
    axes, turned = _axes(order.robot), _turned(order.robot)
    needs = axis_needs([axis.name for axis in axes], (SUPPLY,), mirrored=turned)
    return (
        Plan(title="CiA 402 drives", needs=needs, build=partial(_built, order), every=TICK, follows=False),
    )


def _built(order: BuildOrder, plant: FmuPlant, _leads: bool) -> Built:  # noqa: FBT001 - it always leads
    robot = order.robot
    axes = _axes(robot)
    _are_possible(robot)
    servos = [ServoAxis(axis.name, _edges(Cia402Axis.of(axis))) for axis in axes]
    for servo in servos:
        set_motor(plant, servo)
    bank = fmu_bank(plant, servos, plant.output_names.index(SUPPLY), None, _turned(robot))
    stations: dict[str, Station] = {}
    kept = order.option(Storages)
    storages = {} if kept is None else kept.by_axis
    for axis, servo in zip(axes, servos, strict=True):
        settings = Cia402Axis.of(axis)
        drive = Servo(
            settings.node,
            servo,
            PLAIN.with_(offset_added=settings.home is Home.ITSELF),
            settings=_tuning(plant, axis),
            commissioned={
                od.VENDOR_ID: settings.vendor_id,
                od.PRODUCT_CODE: settings.product_code,
                at.RATED_CURRENT: settings.continuous_current_ma,
            },
            storage=storages.get(axis.name),
        )
        stations[axis.name] = Station(drive, axis.link, {CAN: Way.BUS})
    return Built(stations, bank)


def _edges(settings: Cia402Axis) -> int:
    """Return the edges of the encoder in one turn of the motor."""
    factors = settings.factors
    return settings.encoder_counts if factors is None else factors.encoder_counts // factors.encoder_turns


def _tuning(plant: FmuPlant, axis: Axis) -> Settings:
    constant, resistance, inductance = winding_of(plant, axis.name)
    return tuned(
        Cia402Axis.of(axis).tuned_for_kg_m2 or NOMINAL_INERTIA,
        torque_constant=constant or NO_CONSTANT,
        resistance=resistance,
        inductance=inductance,
    )


def _are_possible(robot: AnyRobot) -> None:
    """Check that the emulated servo can be what the file has; RobotFileError."""
    problems = []
    for index, axis in enumerate(robot.axes):
        if axis.link not in Cia402Link.all_of(robot):
            continue
        settings, key = Cia402Axis.of(axis), f"axes[{index}].settings"
        counts, units = _edges(settings), settings.speed_units_per_rpm
        if counts % QUADCOUNTS_PER_LINE or counts > MOST_COUNTS:
            problem = f"{counts}: the emulated encoder has a multiple of 4, up to {MOST_COUNTS}"
            of = "" if settings.factors is None else "factors."
            problems.append(Problem(f"{key}.{of}encoder_counts", problem))
        if units != 1.0:
            problem = f"{units:g}: the emulated servo has its speeds in rpm"
            problems.append(Problem(f"{key}.speed_units_per_rpm", problem))
    if problems:
        raise RobotFileError(robot.name, *problems)


def _bus(robot: AnyRobot, link: str) -> CanBus:
    table = Cia402Link.of_link(robot, link)
    return CanBus(table.bit_rate, table.bridge_node)


def _on_ports(robot: AnyRobot, given: "RobotOptions") -> "Emulation":
    from emulators.cia402.commands.robot import emulate_drives  # noqa: PLC0415 - a command's own

    return emulate_drives(robot, given)


def _axis_table(drive: "AxisDrive") -> "AxisTable":
    """Return a drive's lines; vendor and product are those of the emulated servo."""
    from emulators.new_drive import on_can  # noqa: PLC0415 - only `new` needs it

    milliamperes = round(1000.0 * drive.motor.continuous_current_a)
    return on_can(
        Cia402Driver.CAN.value,
        drive,
        f"""\
device = "cia402"
vendor_id = 0                   # 0x1018:01, as the drive has it
product_code = 402              # 0x1018:02
motor = "{drive.motor.title}"
encoder_counts = {QUADCOUNTS_PER_LINE * drive.encoder_lines}
continuous_current_ma = {milliamperes}     # 0x6075, as the drive has it
peak_current_ma = {2 * milliamperes}
tuned_for_kg_m2 = {drive.inertia_kg_m2:.4g}     # for the bench; the real drive is tuned by its maker's tool
""",
    )


def _faults() -> "Sequence[FaultKind]":
    from emulators.cia402.fault_rows import ROWS  # noqa: PLC0415 - only who injects faults needs them

    return ROWS


def _alone() -> AnyRobot:
    from emulators.cia402.commands.on_bus import alone_on_bus  # noqa: PLC0415 - a command's own

    return alone_on_bus("cia402", {"motor1": 1})


FAMILY: Final = EmulatedFamily(
    links=(Cia402Link,),
    plans=_plans,
    bus=_bus,
    traits=frozenset({Trait.DRIVE, Trait.ENCODER}),
    faults=_faults,
    alone=_alone,
    on_ports=_on_ports,
    axis_table=_axis_table,
)
