"""The emulated half of a robot: its drives and the plant below them, for the bench and for a real bus."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

from emulators.epos2.drive import Epos2
from emulators.epos2.objects.device_profile import EPOS2_70_10, DeviceProfile, realistic
from emulators.epos2.serial.serial_drive import SerialEpos2
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank, plant_inputs, plant_outputs
from emulators.servo.pins import input_lines, output_lines, pin_inputs, pin_outputs
from emulators.servo.sensor_lines import sensor_lines, sensor_outputs
from firmware_bridge.robot import Robot, RobotFileError
from firmware_bridge.wire.maxon.frame import Generation
from fmu.build import ensure
from fmu.errors import UnknownNameError
from fmu.interface import units
from fmu.plant import FmuPlant, PlantError
from fmu.plants import Plant
from fmu.plants import find as find_plant

BODY: Final = ("battery_voltage", "x", "y", "heading", "speed", "yaw_rate", "steer", "lift_height")
"""Outputs of the plant beside those of its axes, in this order."""
NO_SERIAL: Final[Mapping[str, Generation]] = MappingProxyType({})
BACK_EMF_UNIT: Final = 1 << 24
"""Parts of 1 V s/rad in which a servo axis keeps its motor's constant."""


@dataclass(frozen=True, slots=True)
class Devices:
    """The emulated half of a robot: its drives by axis name, what moves them, and the plant below."""

    drives: dict[str, Epos2]
    bank: ServoBank
    plant: FmuPlant


def devices(
    robot: Robot,
    plant_path: Path | None = None,
    *,
    realistic_latency: bool = False,
    serial: Mapping[str, Generation] = NO_SERIAL,
) -> Devices:
    """Build a robot's drives above its plant; PlantError where the plant cannot be used.

    With `realistic_latency` they take the published time for an SDO answer; otherwise they answer at once.
    `serial` names the axes whose drives have a host on their serial port, and the protocol that they speak.

    Geometry that both know is set from the robot file into our own plant, so that they agree; a plant of the
    user's is taken as it is, with the parameters that the robot file lists for it.
    """
    names = [axis.name for axis in robot.axes]
    outputs = plant_outputs(names)
    if plant_path is None:
        path, parameters = ensure(_plant(robot)), plant_parameters(robot)
    else:
        path, parameters = plant_path, robot.plant.parameters
    plant = FmuPlant(
        path,
        plant_inputs(names),
        (*outputs, *BODY),
        parameters,
        units=units(names),
        optional_inputs=pin_inputs(names),
        optional_outputs=pin_outputs(names) + sensor_outputs(names),
    )
    axes = [
        ServoAxis(axis.name, axis.quadcounts_per_turn, back_emf=_back_emf(plant, axis.name))
        for axis in robot.axes
    ]
    bank = ServoBank(
        plant,
        axes,
        supply=len(outputs),
        analogue=(robot.battery.axis, robot.battery.divider),
        input_lines=input_lines(plant.output_names, names) + sensor_lines(plant.output_names, names),
        output_lines=output_lines(plant.input_names, names),
    )
    kind = realistic(EPOS2_70_10) if realistic_latency else EPOS2_70_10
    drives = {
        axis.name: _drive(axis.node, servo, _individual(kind, axis.node), serial.get(axis.name))
        for axis, servo in zip(robot.axes, axes, strict=True)
    }
    return Devices(drives, bank, plant)


def _drive(node: int, servo: ServoAxis, profile: DeviceProfile, serial: Generation | None) -> Epos2:
    if serial is None:
        return Epos2(node, servo, profile)
    return SerialEpos2(node, servo, profile, generation=serial)


def _individual(kind: DeviceProfile, node: int) -> DeviceProfile:
    """Return such a drive with a serial number of its own, so that no two on one bus are the same."""
    return replace(kind, serial_number=kind.serial_number + node)


def _back_emf(plant: FmuPlant, axis: str) -> int:
    """Return the motor's constant as an axis takes it; 0, to be learnt, where the plant does not tell it."""
    try:
        return round(plant.read(f"torque_constant_{axis}") * BACK_EMF_UNIT)
    except PlantError:
        return 0


def plant_parameters(robot: Robot) -> dict[str, float]:
    """Return the plant's parameters that the robot file knows, under the plant's names and in its units.

    The geometry that bridge and plant share wins over the parameter set, single values win over both.
    RobotFileError where plant, set or geometry are unknown.
    """
    plant, chosen = _plant(robot), robot.plant.parameter_set
    try:
        found = {} if chosen is None else plant.parameter_set(chosen)
    except UnknownNameError as error:
        raise RobotFileError(robot.name, "plant.parameter_set", str(error)) from error
    try:
        return found | plant.parameters_of(robot) | robot.plant.parameters
    except UnknownNameError as error:
        raise RobotFileError(robot.name, "plant.fmu", str(error)) from error


def _plant(robot: Robot) -> Plant:
    try:
        return find_plant(robot.plant.fmu)
    except UnknownNameError as error:
        raise RobotFileError(robot.name, "plant.fmu", str(error)) from error
