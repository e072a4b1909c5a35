"""Drives without a robot: each with a motor and a load of its own, or all above one plant from an FMU.

It refuses to know which bus they are on.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

from emulators.epos2.drive import Epos2
from emulators.epos2.objects.device_profile import DeviceProfile
from emulators.epos2.serial.serial_drive import SerialEpos2
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import Plant, ServoBank, plant_inputs, plant_outputs
from emulators.servo.motor import MOTOR, SUPPLY_MV, DcMotor, DcMotors
from emulators.servo.pins import input_lines, output_lines, pin_inputs, pin_outputs
from emulators.servo.sensor_lines import sensor_lines, sensor_outputs
from emulators.storage import ParameterFile
from firmware_bridge.wire.maxon.frame import Generation
from fmu.plant import FmuPlant, PlantError

QUADCOUNTS: Final = 2_000
"""Of the encoder in one turn: the default of 0x2210:1, 500 pulses."""
BACK_EMF_UNIT: Final = 1 << 24
"""Parts of 1 V s/rad in which a servo axis keeps its motor's constant."""


@dataclass(frozen=True, slots=True)
class Order:
    """What is wanted: which nodes of which type, on a bus of which bit rate."""

    nodes: Sequence[int]
    profile: DeviceProfile
    bit_rate: int
    motor: DcMotor = MOTOR
    plant: Path | None = None
    plant_parameters: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    """The FMU's parameters that are to be set, by their names."""
    axes: Sequence[str] = ()
    """The plant's names for its axes, in the order of the nodes."""
    supply_mv: int = SUPPLY_MV
    parameters: Path | None = None
    """The folder that keeps saved parameters; None keeps them as long as the drives live."""
    dip_off: bool = False
    """Whether the DIP switches say 0, so that the saved number counts."""
    serial: Mapping[int, Generation] = field(default_factory=lambda: MappingProxyType({}))
    """The nodes with a host on their serial port, and the protocol that they speak."""

    @property
    def names(self) -> list[str]:
        """The drives' names, in the order of the nodes."""
        return list(self.axes) or [f"motor{node}" for node in self.nodes]


def drives(order: Order) -> tuple[dict[str, Epos2], ServoBank]:
    """Build the drives by the names of their axes, and what moves them.

    PlantError where the FMU cannot be used, StorageError where saved parameters cannot be read.
    """
    names = order.names
    plant: Plant = (
        DcMotors((order.motor,) * len(names))
        if order.plant is None
        else _fmu(order.plant, names, order.plant_parameters)
    )
    axes = [
        ServoAxis(name, QUADCOUNTS, supply_mv=order.supply_mv, back_emf=_back_emf(order, plant, name))
        for name in names
    ]
    made = {
        name: _drive(order, node, axis) for name, node, axis in zip(names, order.nodes, axes, strict=True)
    }
    if not isinstance(plant, FmuPlant):
        return made, ServoBank(plant, axes)
    wires = output_lines(plant.input_names, names)
    switches = input_lines(plant.output_names, names) + sensor_lines(plant.output_names, names)
    return made, ServoBank(plant, axes, input_lines=switches, output_lines=wires)


def _drive(order: Order, node: int, axis: ServoAxis) -> Epos2:
    switch = 0 if order.dip_off else node
    profile = replace(order.profile, serial_number=order.profile.serial_number + node)
    storage = None if order.parameters is None else ParameterFile(order.parameters / f"node-{node}.json")
    generation = order.serial.get(node)
    if generation is None:
        return Epos2(switch, axis, profile, storage=storage, bus_rate=order.bit_rate)
    return SerialEpos2(switch, axis, profile, generation=generation, storage=storage, bus_rate=order.bit_rate)


def _fmu(path: Path, names: Sequence[str], parameters: Mapping[str, float]) -> FmuPlant:
    return FmuPlant(
        path,
        plant_inputs(names),
        plant_outputs(names),
        parameters,
        optional_inputs=pin_inputs(names),
        optional_outputs=pin_outputs(names) + sensor_outputs(names),
    )


def _back_emf(order: Order, plant: Plant, name: str) -> int:
    """Return the motor's constant as an axis takes it; 0, to be learnt, where an FMU does not tell it."""
    constant = order.motor.torque_constant
    if isinstance(plant, FmuPlant):
        try:
            constant = plant.read(f"torque_constant_{name}")
        except PlantError:
            return 0
    return round(constant * BACK_EMF_UNIT)
