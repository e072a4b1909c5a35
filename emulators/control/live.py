"""Emulated devices that run and take faults: what the control desk has to know of them."""

from dataclasses import dataclass

from emulators.bench.faults import Faults
from emulators.bench.faults.site import Carrier
from emulators.control.live_site import LiveSite
from emulators.family import Devices
from emulators.gateway import Cluster
from firmware_bridge.robot import AnyRobot
from fmu.plant import FmuPlant


@dataclass(frozen=True, slots=True, eq=False)
class Live:
    """Emulated devices while they run."""

    robot: AnyRobot
    """Of devices without a robot: a stand-in with their axes and links."""
    devices: Devices
    carrier: Carrier
    """What carries them; its clock is that of the faults."""
    plant: FmuPlant | None
    """What they move; None where it is no FMU."""
    faults: Faults
    in_reach: bool = False
    """True where bridge and wires are emulated, too, so that no kind of fault is out of reach."""


def on_real_links(robot: AnyRobot, devices: Devices, cluster: Cluster, plant: FmuPlant | None) -> Live:
    """Return devices on real buses and lines, as `emulate` runs them."""
    return Live(robot, devices, cluster, plant, Faults(LiveSite(robot, devices, cluster)))
