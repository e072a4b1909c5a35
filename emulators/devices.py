"""The emulated half of a robot: its drives and the plant below them, for the bench and for a real bus."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Final

from emulators.arduino_omni.ar2.board import Ar2Board
from emulators.arduino_omni.ar2.firmwares import FIRMWARES as AR2_FIRMWARES
from emulators.arduino_omni.board import FIRMWARES, Board
from emulators.arduino_omni.motors import MotorLoad
from emulators.canopen.saved_parameters import Storage
from emulators.carried_bank import CarriedBank
from emulators.epos2.drive import Epos2
from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.objects.device_profile import DeviceProfile, numbered, realistic
from emulators.epos2.serial.serial_drive import SerialEpos2
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank, plant_inputs, plant_outputs
from emulators.servo.fmu_axes import HELD, LIFTED, fmu_bank, fmu_plant, set_motor
from emulators.servo.pins import SWITCHES, input_lines
from emulators.shield_bank import ShieldBank, ShieldMotor
from emulators.stepper_bank import ANGLES, FIELDS, INPUTS, PlantJoints, StepperBank, stepper_plant
from firmware_bridge.families.ar2.settings import Ar2Axis, Ar2Link
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.settings import Epos2AnalogueInput, Epos2Axis
from firmware_bridge.families.motor_shield.settings import ShieldAxis, ShieldLink
from firmware_bridge.robot import AnyRobot, Axis, Problem, RobotFileError
from fmu.build import ensure
from fmu.errors import PlantError, UnknownNameError
from fmu.plant import FmuPlant
from fmu.plants import Plant
from fmu.plants import find as find_plant

SUPPLY: Final = "battery_voltage"
"""The plant's output that feeds the drives, V."""
CONSTANT: Final = "torque_constant_"
NO_SERIAL: Final[Mapping[str, Generation | None]] = MappingProxyType({})
NO_STORAGE: Final[Mapping[str, Storage]] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Devices:
    """The emulated half of a robot: its drives by axis name, what moves them, and the plant below."""

    drives: dict[str, Epos2]
    bank: ServoBank | ShieldBank | StepperBank | CarriedBank
    plant: FmuPlant
    boards: dict[str, Board | Ar2Board] = field(default_factory=dict)
    """Boards by the links' names."""

    @property
    def servo_bank(self) -> ServoBank:
        """The servo bank of the drives; TypeError where a board turns the motors."""
        if not isinstance(self.bank, ServoBank):
            raise TypeError("no drive is on this bench")
        return self.bank

    @property
    def servo_axes(self) -> dict[str, ServoAxis]:
        """The axes of the drives by their names; none where a board turns the motors."""
        return {axis.name: axis for axis in self.bank.axes if isinstance(axis, ServoAxis)}


def devices(
    robot: AnyRobot,
    plant_path: Path | None = None,
    *,
    outputs: Sequence[str] = (),
    optional: Sequence[str] = (),
    realistic_latency: bool = False,
    serial: Mapping[str, Generation | None] = NO_SERIAL,
    storages: Mapping[str, Storage] = NO_STORAGE,
) -> Devices:
    """Build a robot's drives above its plant; PlantError where the plant cannot be used.

    `outputs` are the plant's that someone wants to look at, whether an axis needs them or not, `optional`
    those that he looks at where it has them. With `realistic_latency` the drives take the published time for
    an SDO answer; otherwise they answer at once.
    `serial` names the axes whose drives have a host on their serial port, and the protocol that they speak,
    None as the host does.
    `storages` keeps saved parameters by axis; without one a drive comes from the factory, and forgets.
    StorageError where they cannot be read.

    Geometry that both know is set from the robot file into our own plant, so that they agree; a plant of the
    user's is taken as it is, with the parameters that the robot file lists for it.
    """
    if plant_path is None:
        path, parameters = ensure(_plant(robot)), plant_parameters(robot)
    else:
        path, parameters = plant_path, robot.plant.parameters
    mirrored = _mirrored(robot)
    if Ar2Link.all_of(robot) and not ShieldLink.all_of(robot):
        return _on_steppers(robot, stepper_plant(path, parameters, outputs, mirrored))
    names = [axis.name for axis in robot.axes if axis.link not in Ar2Link.all_of(robot)]
    if Ar2Link.all_of(robot):
        plant = fmu_plant(
            path,
            names,
            parameters,
            (SUPPLY, *ANGLES, *outputs),
            optional,
            set_by_plant=INPUTS,
            mirrored=mirrored,
        )
        return _on_both(robot, plant)
    plant = fmu_plant(path, names, parameters, (SUPPLY, *outputs), optional, mirrored=mirrored)
    if ShieldLink.all_of(robot):
        return _on_boards(robot, plant)
    _have_switches(robot, plant)
    axes = [ServoAxis(axis.name, Epos2Axis.of(axis).quadcounts_per_turn) for axis in robot.axes]
    for servo in axes:
        set_motor(plant, servo)
    bank = fmu_bank(plant, axes, len(plant_outputs(names)), _supply_input(robot), _turned(robot))
    drives = {
        axis.name: _drive(
            axis,
            servo,
            _profile(axis, realistic_latency=realistic_latency),
            serial,
            storages.get(axis.name),
        )
        for axis, servo in zip(robot.axes, axes, strict=True)
    }
    return Devices(drives, bank, plant)


def _turned(robot: AnyRobot) -> tuple[str, ...]:
    """Return the axes whose motor is mounted the other way round: its forwards is the axis's backwards."""
    return tuple(axis.name for axis in robot.axes if axis.direction < 0)


def _mirrored(robot: AnyRobot) -> tuple[str, ...]:
    """Return the plant's inputs and outputs at those motors' terminals: they have the other sign there.

    An arm's motors have no encoder, and its switches stay where they are: only their fields turn over.
    """
    turned = [axis for axis in robot.axes if axis.direction < 0]
    fields = [FIELDS[Ar2Axis.of(axis).joint - 1] for axis in turned if axis.link in Ar2Link.all_of(robot)]
    names = [axis.name for axis in turned if axis.link not in Ar2Link.all_of(robot)]
    return (*fields, *plant_inputs(names), *plant_outputs(names))


def _on_boards(robot: AnyRobot, plant: FmuPlant) -> Devices:
    """Put a plant's motors at the terminals of a board's shield; RobotFileError where that cannot be."""
    name, board, bank = _shield(robot, plant)
    _moves_all(robot, name)
    return Devices({}, bank, plant, {name: board})


def _on_steppers(robot: AnyRobot, plant: FmuPlant) -> Devices:
    """Put an arm's joints on its board; RobotFileError where that cannot be."""
    name, board, bank = _steppers(robot, PlantJoints(plant))
    _moves_all(robot, name)
    return Devices({}, bank, plant, {name: board})


def _on_both(robot: AnyRobot, plant: FmuPlant) -> Devices:
    """Put an arm's joints on its board, and what carries it on another; RobotFileError."""
    below, board, base = _shield(robot, plant)
    above, carried, arm = _steppers(robot, PlantJoints(plant, carried=True))
    _moves_all(robot, below, above)
    return Devices({}, CarriedBank(base, board, arm), plant, {below: board, above: carried})


def _moves_all(robot: AnyRobot, *links: str) -> None:
    """Check that every axis is on one of these links, and there is no other with a board."""
    boards = {*ShieldLink.all_of(robot), *Ar2Link.all_of(robot)}
    if boards != set(links) or not {axis.link for axis in robot.axes} <= boards:
        problem = "a board for all motors, one for all joints, or one of each are emulated, and no more"
        raise RobotFileError(robot.name, Problem("links", problem))


def _shield(robot: AnyRobot, plant: FmuPlant) -> tuple[str, Board, ShieldBank]:
    """Return a board with its link, and the motors on its shield."""
    (name, link), *_ = ShieldLink.all_of(robot).items()
    axes = robot.axes_on(name)
    # The plant's motors are put at the terminals in the order of the axes, without gaps.
    if [ShieldAxis.of(axis).port for axis in axes] != list(range(1, len(axes) + 1)):
        problem = "the axes' ports must be 1, 2 and so on, in their order, to be emulated"
        raise RobotFileError(robot.name, Problem(f"links.{name}", problem))
    firmware = FIRMWARES[link.protocol.value]
    if link.counted not in firmware.encoders:
        known = " or ".join(map(str, firmware.encoders))
        problem = f"{link.protocol.value} counts {known} encoders, not {link.counted}"
        raise RobotFileError(robot.name, Problem(f"links.{name}.encoders", problem))
    names = tuple(axis.name for axis in axes)
    constants = tuple(_constant(plant, axis) for axis in names)
    # The shield's encoders share one scale in the C kernel.
    counts, *others = {ShieldAxis.of(axis).counts_per_turn for axis in axes}
    if others:
        problem = "counts_per_turn must be the same for all motors of a board, to be emulated"
        raise RobotFileError(robot.name, Problem("axes", problem))
    supply = plant.output_names.index(SUPPLY)
    holds, hoists = (_puts(plant, kind, names) for kind in (HELD, LIFTED))
    load = MotorLoad(plant, names, constants, supply, counts_per_turn=counts, holds=holds, hoists=hoists)
    auto_stop = None if firmware.auto_stop is None else link.auto_stop_ms
    wiring = tuple(ShieldAxis.of(axis).encoder_pins for axis in axes)
    board = Board(firmware, load, encoders=link.counted, auto_stop=auto_stop, wiring=wiring)
    motors = tuple(ShieldMotor(axis.name, board, ShieldAxis.of(axis).port) for axis in axes)
    return name, board, ShieldBank({name: board}, motors)


def _steppers(robot: AnyRobot, joints: PlantJoints) -> tuple[str, Ar2Board, StepperBank]:
    """Return an arm's board with its link, and its joints."""
    (name, _), *_ = Ar2Link.all_of(robot).items()
    board = Ar2Board(AR2_FIRMWARES["2.0"], joints)
    return name, board, StepperBank(board, joints, [axis.name for axis in robot.axes_on(name)])


def _puts(plant: FmuPlant, kind: str, axes: Sequence[str]) -> Callable[[int, float], None] | None:
    """Return what sets an input of this kind of an axis, where the plant has it."""
    wanted = [f"{kind}{axis}" for axis in axes]
    if not set(wanted) <= set(plant.input_names):
        return None
    places = [plant.input_names.index(name) for name in wanted]

    def put(axis: int, value: float) -> None:
        plant.inputs[places[axis]] = value

    return put


def _constant(plant: FmuPlant, axis: str) -> float:
    """Return a motor's torque constant: its own, or that of all motors."""
    own, common = f"{CONSTANT}{axis}", [name for name in plant.variables if name.startswith(CONSTANT)]
    return plant.read(own if own in common else common[0])


def _have_switches(robot: AnyRobot, plant: FmuPlant) -> None:
    """Check that the plant has the switches by which axes are homed; RobotFileError."""
    # With mirrored axes: the plant's negative switch ends the drive's positive direction.
    wired = input_lines(plant.output_names, [axis.name for axis in robot.axes], _turned(robot))
    closed = {(line.axis, line.mask) for line in wired}
    for index, axis in enumerate(robot.axes):
        switch = None if axis.zero.homing is None else axis.zero.homing.goes_by.switch
        if switch is not None and (index, 1 << SWITCHES[switch] - 1) not in closed:
            problem = f"goes by a switch; the plant has no output '{switch}_{axis.name}'"
            raise RobotFileError(robot.name, Problem(f"axes[{index}].zero.homing.method", problem))


def _supply_input(robot: AnyRobot) -> tuple[str, float] | None:
    """Return the axis whose first analog input sees the supply, and the divider before that input."""
    if robot.battery is None:
        return None
    sensor = next(sensor for sensor in robot.sensors if sensor.name == robot.battery.sensor)
    return Epos2AnalogueInput.of(sensor).axis, Epos2AnalogueInput.of(sensor).per_volt


def _drive(
    axis: Axis,
    servo: ServoAxis,
    profile: DeviceProfile,
    serial: Mapping[str, Generation | None],
    storage: Storage | None,
) -> Epos2:
    node = Epos2Axis.of(axis).node
    if axis.name not in serial:
        return Epos2(node, servo, profile, storage=storage)
    return SerialEpos2(node, servo, profile, generation=serial[axis.name], storage=storage)


def _profile(axis: Axis, *, realistic_latency: bool) -> DeviceProfile:
    """Return the type of drive that the file names, with a serial number of its own: no two are the same."""
    # The type decides currents, supply and objects; the number in its serial number is the node's.
    kind = PROFILES[Epos2Axis.of(axis).device.value]
    kind = realistic(kind) if realistic_latency else kind
    return numbered(kind, Epos2Axis.of(axis).node)


def plant_parameters(robot: AnyRobot) -> dict[str, float]:
    """Return the plant's parameters that the robot file knows, under the plant's names and in its units.

    The geometry that bridge and plant share wins over the parameter set, single values win over both.
    RobotFileError where plant, set or geometry are unknown.
    """
    plant, chosen = _plant(robot), robot.plant.parameter_set
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
    return _plant(robot).starting(plant_parameters(robot))


def _plant(robot: AnyRobot) -> Plant:
    try:
        return find_plant(robot.plant.fmu)
    except UnknownNameError as error:
        raise RobotFileError(robot.name, Problem("plant.fmu", str(error))) from error
