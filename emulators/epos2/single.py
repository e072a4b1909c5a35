"""Drives without a robot: each with a motor and a load of its own, or all above one plant from an FMU.

Not known here: which bus they are on.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import MappingProxyType

from emulators.epos2.drive import Epos2
from emulators.epos2.mounted import Comparison, Mounted, Torque
from emulators.epos2.objects.device_profile import DeviceProfile, numbered
from emulators.epos2.options import PRODUCT
from emulators.epos2.serial.serial_drive import SerialEpos2
from emulators.parameter_files import Commissioned, storage_in
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank, ServoPlant
from emulators.servo.fmu_axes import axis_needs, fmu_bank, load_plant, set_motor
from emulators.servo.motor import SUPPLY_MV, DcMotors
from emulators.servo.winding import set_winding
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.maxon.frame import Generation
from fmu.plant import FmuPlant


@dataclass(frozen=True, slots=True)
class DrivesOrder:
    """The drives to emulate: nodes and type, on a bus of this bit rate."""

    nodes: Sequence[int]
    profile: DeviceProfile
    bit_rate: int
    mounted: Mounted = field(default_factory=Mounted)
    """Equipment at each of them."""
    plant: Path | None = None
    plant_parameters: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    """The FMU's parameters that are to be set, by their names."""
    axes: Sequence[str] = ()
    """The plant's names for its axes, in the order of the nodes."""
    supply_mv: int = SUPPLY_MV
    parameters: Path | None = None
    """The folder that keeps saved parameters; None keeps them as long as the drives live."""
    dip_off: bool = False
    """True if the DIP switches are at 0, so that the saved number counts."""
    commissioned: Mapping[Address, int] = field(default_factory=lambda: MappingProxyType({}))
    """Parameters of a drive that someone has set up, until it saves others."""
    serial: Mapping[int, Generation | None] = field(default_factory=lambda: MappingProxyType({}))
    """The nodes with a host on their serial port, and the protocol that they speak; None as the host does."""

    @property
    def names(self) -> list[str]:
        """The drives' names, in the order of the nodes."""
        return list(self.axes) or [f"motor{node}" for node in self.nodes]


def drives(
    order: DrivesOrder, say: Callable[[str], None] | None = None
) -> tuple[dict[str, Epos2], ServoBank]:
    """Build the drives by the names of their axes, and what moves them.

    `say` takes what a client has set up otherwise than it is mounted. PlantError where the FMU cannot be
    used, StorageError where saved parameters cannot be read.
    """
    names = order.names
    plant: ServoPlant = (
        DcMotors((order.mounted.shaft,) * len(names))
        if order.plant is None
        else load_plant(order.plant, [axis_needs(names)], order.plant_parameters)
    )
    axes = [ServoAxis(name, order.mounted.counts, supply_mv=order.supply_mv) for name in names]
    for axis in axes:
        order.mounted.mount(axis)
        if isinstance(plant, FmuPlant):
            set_motor(plant, axis)
        else:
            shaft = order.mounted.shaft
            set_winding(axis, shaft.torque_constant, shaft.resistance, shaft.inductance)
    made = {
        name: _drive(order, node, axis) for name, node, axis in zip(names, order.nodes, axes, strict=True)
    }
    if isinstance(plant, DcMotors):
        for place, (name, axis) in enumerate(zip(names, axes, strict=True)):
            # It hooks the store, which keeps it alive.
            Torque(order.mounted, made[name].store, axis, partial(plant.becomes, place))
    for node, name in zip(order.nodes, names, strict=True):
        if say is not None:
            Comparison(order.mounted, made[name].store, _at(node, say))
    return made, fmu_bank(plant, axes) if isinstance(plant, FmuPlant) else ServoBank(plant, axes)


def _drive(order: DrivesOrder, node: int, axis: ServoAxis) -> Epos2:
    switch = 0 if order.dip_off else node
    profile = numbered(order.profile, node)
    storage = storage_in(order.parameters, node, PRODUCT)
    if order.commissioned:
        storage = Commissioned(order.commissioned, storage)
    if node not in order.serial:
        return Epos2(switch, axis, profile, storage=storage, bus_rate=order.bit_rate)
    generation = order.serial[node]
    return SerialEpos2(switch, axis, profile, generation=generation, storage=storage, bus_rate=order.bit_rate)


def _at(node: int, say: Callable[[str], None]) -> Callable[[str], None]:
    return lambda text: say(f"node {node}: {text}")
