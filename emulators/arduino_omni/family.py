"""The motor shield as a family of emulated devices: boards, their motors on a plant, their serial lines."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Final

from emulators.arduino_omni.board import FIRMWARES, Board
from emulators.arduino_omni.board_line import BoardLine, board_line
from emulators.arduino_omni.fmu_load import torque_constant
from emulators.arduino_omni.motors import MotorLoad
from emulators.arduino_omni.presence import QUESTIONS
from emulators.arduino_omni.shield_motors import ShieldMotor, ShieldMotors
from emulators.family import (
    BridgeLink,
    BuildOrder,
    Built,
    Devices,
    EmulatedFamily,
    Line,
    Plan,
    Station,
    Trait,
    Way,
)
from emulators.servo.axis import TICK
from emulators.servo.fmu_axes import HELD, LIFTED, SUPPLY, axis_needs
from emulators.servo.plant_part import PlantPart
from emulators.servo.seam import plant_inputs, plant_outputs
from firmware_bridge.families.motor_shield.settings import ShieldAxis, ShieldLink
from firmware_bridge.node import SERIAL, Node
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from firmware_bridge.units import Nanoseconds
from fmu.plant import FmuPlant

if TYPE_CHECKING:
    from emulators.bench.faults.kind import FaultKind
    from emulators.new_drive import AxisDrive, AxisTable


def _plans(order: BuildOrder) -> tuple[Plan, ...]:
    """Return each board that has motors."""
    return tuple(
        _plan(order.robot, name) for name in ShieldLink.all_of(order.robot) if order.robot.axes_on(name)
    )


def _plan(robot: AnyRobot, link: str) -> Plan:
    axes = robot.axes_on(link)
    turned = [axis.name for axis in axes if axis.direction < 0]
    return Plan(
        title=f"the board on '{link}'",
        needs=axis_needs([axis.name for axis in axes], (SUPPLY,), mirrored=turned),
        build=partial(_built, robot, link),
        every=TICK,
    )


def _built(robot: AnyRobot, name: str, plant: FmuPlant, leads: bool) -> Built:  # noqa: FBT001 - as `Plan`
    """Put the plant's motors at the terminals of a board's shield; RobotFileError where that cannot be."""
    link, axes = ShieldLink.of_link(robot, name), robot.axes_on(name)
    settings = [ShieldAxis.of(axis) for axis in axes]
    # The plant's motors are put at the terminals in the order of the axes, without gaps.
    if [one.port for one in settings] != list(range(1, len(axes) + 1)):
        problem = "the axes' ports must be 1, 2 and so on, in their order, to be emulated"
        raise RobotFileError(robot.name, Problem(f"links.{name}", problem))
    firmware = FIRMWARES[link.protocol.value]
    if link.counted not in firmware.encoders:
        known = " or ".join(map(str, firmware.encoders))
        problem = f"{link.protocol.value} counts {known} encoders, not {link.counted}"
        raise RobotFileError(robot.name, Problem(f"links.{name}.encoders", problem))
    # The shield's encoders share one scale in the C kernel.
    counts, *others = {one.counts_per_turn for one in settings}
    if others:
        problem = "counts_per_turn must be the same for all motors of a board, to be emulated"
        raise RobotFileError(robot.name, Problem("axes", problem))
    names = tuple(axis.name for axis in axes)
    read = (*plant_outputs(names), SUPPLY)
    load = MotorLoad(
        plant if leads else PlantPart(plant, plant_inputs(names), read),
        names,
        tuple(torque_constant(plant, axis) for axis in names),
        (plant.output_names if leads else read).index(SUPPLY),
        counts_per_turn=counts,
        holds=_puts(plant, HELD, names),
        hoists=_puts(plant, LIFTED, names),
    )
    auto_stop = None if firmware.auto_stop is None else link.auto_stop_ms
    wiring = tuple(one.encoder_pins for one in settings)
    board = Board(firmware, load, encoders=link.counted, auto_stop=auto_stop, wiring=wiring)
    motors = [ShieldMotor(axis, board, one.port) for axis, one in zip(names, settings, strict=True)]
    station = Station(board, name, {SERIAL: Way.LINE})
    return Built({name: station}, ShieldMotors(board, tuple(motors)))


def _puts(plant: FmuPlant, kind: str, axes: Sequence[str]) -> Callable[[int, float], None] | None:
    """Return what sets an input of this kind of an axis, where the plant has it."""
    inputs = [f"{kind}{axis}" for axis in axes]
    if not set(inputs) <= set(plant.input_names):
        return None
    places = [plant.input_names.index(name) for name in inputs]

    def put(axis: int, value: float) -> None:
        plant.inputs[places[axis]] = value

    return put


def _line(robot: AnyRobot, node: Node, link: BridgeLink, _host: str, before: Line | None) -> BoardLine:
    table = ShieldLink.of_link(robot, link.name)
    busy = partial(_i2c_busy, link.name)
    return board_line(node, link, table, table.protocol.value, before, i2c_busy=busy)


def _i2c_busy(link: str, devices: Devices) -> Nanoseconds:
    return devices.nodes(Board)[link].mega.bus.busy


def _protocols(robot: AnyRobot, link: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys((ShieldLink.of_link(robot, link).protocol.value, *FIRMWARES)))


def _faults() -> "tuple[FaultKind, ...]":
    from emulators.arduino_omni.fault_rows import BOARD_ROWS  # noqa: PLC0415 - only who injects faults needs them

    return BOARD_ROWS


def _alone() -> AnyRobot:
    from emulators.arduino_omni.commands.board import alone_on_line  # noqa: PLC0415 - a command's own
    from emulators.arduino_omni.motors import four_motors  # noqa: PLC0415 - as above

    return alone_on_line(four_motors().names)


def _reports(node: Node, link: str) -> None:
    from emulators.arduino_omni.commands.reported import keeping_reported  # noqa: PLC0415 - a command's own

    if isinstance(node, Board):
        keeping_reported(node.mega, link)


def _spoken(robot: AnyRobot, link: str) -> str:
    table = ShieldLink.of_link(robot, link)
    return f"{table.protocol.value}, {table.counted} encoders{'' if table.stock else ', not stock'}"


def _axis_table(drive: "AxisDrive") -> "AxisTable":
    from emulators.arduino_omni.starter import axis_table  # noqa: PLC0415 - only `new` needs it

    return axis_table(drive)


FAMILY: Final = EmulatedFamily(
    links=(ShieldLink,),
    plans=_plans,
    line=_line,
    protocols=_protocols,
    traits=frozenset({Trait.MOTOR, Trait.ENCODER}),
    faults=_faults,
    aliases=("board",),
    alone=_alone,
    spoken=_spoken,
    reports_to_console=_reports,
    questions=QUESTIONS,
    axis_table=_axis_table,
)
