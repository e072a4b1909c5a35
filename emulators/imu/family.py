"""IMUs as a family of emulated devices: for each link to one, a part on the plant's body."""

from functools import partial
from math import radians
from typing import TYPE_CHECKING, Final

import numpy as np

from emulators.family import Beside, BuildOrder, Devices, EmulatedFamily, Observed, Station, Way
from emulators.imu.device import Imu
from emulators.imu.line import listened_line
from emulators.imu.part import MemsPart
from emulators.imu.sampled import Physics, Sampled, lacking
from emulators.imu.truth import FLOOR, SPACE, TILT, Matrix, about_x, about_y, about_z, product
from emulators.servo.fmu_axes import PlantNeeds
from firmware_bridge.families.imu.settings import ImuLink, Mounted
from firmware_bridge.node import SERIAL
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from firmware_bridge.robot.table import Medium
from fmu.plant import FmuPlant

if TYPE_CHECKING:
    from emulators.bench.faults.kind import FaultKind
    from firmware_bridge.runtime.ports import Port

IMU_STREAM: Final = 4
"""Stream of random numbers for the IMUs, beside the run's seed."""
SEEN: Final = tuple(dict.fromkeys((*FLOOR, *TILT, *SPACE)))
"""The plant's outputs by which a body is seen; `FLOOR` or `SPACE` will do."""


def rotation_of(mounted: Mounted) -> Matrix:
    """Return the rotation from the part's axes into the body's: about x, then y, then z."""
    x, y, z = (radians(one) for one in (mounted.about_x_deg, mounted.about_y_deg, mounted.about_z_deg))
    return product(about_z(z), product(about_y(y), about_x(x)))


def _observe(order: BuildOrder, plant: FmuPlant, physics: Physics) -> Observed:
    """Return the IMUs on a robot; RobotFileError where its plant has no place."""
    robot, links = order.robot, ImuLink.all_of(order.robot)
    if lacks := lacking(plant.output_names):
        problem = f"an IMU needs the plant's outputs {', '.join(lacks)}"
        raise RobotFileError(robot.name, Problem("plant.fmu", problem))
    sampled, stations = Sampled(physics, plant), dict[str, Station]()
    for number, (name, link) in enumerate(links.items()):
        # A stream for each: one more IMU changes no other's noise.
        chance = np.random.default_rng([order.seed, IMU_STREAM, number])
        stations[name] = Station(
            Imu(sampled, MemsPart(chance, rotation_of(link.mounted))), name, {SERIAL: Way.LINE}
        )
    return Observed(stations, sampled)


def _beside(robot: AnyRobot, below: Devices) -> Beside:
    """Return the IMUs beside drives on a bus, each on a pseudo-terminal; PortError.

    Where all links are lines they are on lines as the others are.
    """
    from firmware_bridge.cli.links import open_serial  # noqa: PLC0415 - the bench has no ports
    from firmware_bridge.runtime.ports.pseudo_terminal import WORD  # noqa: PLC0415 - as above

    if all(link.medium is not Medium.CAN for link in robot.links.values()):
        return Beside({}, {}, {}, ())
    links, nodes = ImuLink.all_of(robot), below.nodes(Imu)
    # At once: the name of a pseudo-terminal is known only then.
    ports = {name: open_serial(WORD, link.rate) for name, link in links.items()}
    return Beside(
        {name: nodes[name] for name in links},
        {name: {SERIAL: name} for name in links},
        {name: partial(_same, port) for name, port in ports.items()},
        tuple(f"{port.name} ({name})" for name, port in ports.items()),
    )


def _same(port: "Port") -> "Port":
    return port


def _faults() -> "tuple[FaultKind, ...]":
    from emulators.imu.fault_rows import IMU_ROWS  # noqa: PLC0415 - only who injects faults needs them

    return IMU_ROWS


FAMILY: Final = EmulatedFamily(
    links=(ImuLink,),
    sees=PlantNeeds(optional_outputs=SEEN),
    observe=_observe,
    line=listened_line,
    faults=_faults,
    beside=_beside,
)
