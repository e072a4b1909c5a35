"""Emulated devices that run and take faults: what the control desk has to know of them."""

from dataclasses import dataclass
from typing import Final

from emulators.bench.faults import Fault, Faults
from emulators.bench.faults.link import SerialUnplugged
from emulators.bench.faults.site import Carrier
from emulators.control.live_site import LiveSite
from emulators.family import Devices
from emulators.gateway import Cluster
from firmware_bridge.robot import AnyRobot
from fmu.plant import FmuPlant

ON_PTYS: Final = frozenset({SerialUnplugged.kind})
"""Kinds that a real line cannot have, but a pseudo-terminal can."""


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
    on_ptys: bool = False
    """True where a line is a pseudo-terminal, so that its cable can be pulled."""

    def out_of_reach(self, fault: Fault) -> str:
        """Return why a fault cannot be put on these devices; empty where it can."""
        pulled = self.on_ptys and fault.kind in ON_PTYS
        return "" if self.in_reach or pulled else fault.real_bus_problem(self.robot)


def on_real_links(
    robot: AnyRobot, devices: Devices, cluster: Cluster, plant: FmuPlant | None, *, on_ptys: bool = False
) -> Live:
    """Return devices on real buses and lines, as `emulate` runs them."""
    faults = Faults(LiveSite(robot, devices, cluster))
    return Live(robot, devices, cluster, plant, faults, on_ptys=on_ptys)
