"""Where faults are put on: the parts of one bench, by the names in its robot file.

It refuses to know which faults there are.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from emulators.bench.adapter import Adapter
from emulators.epos2.drive import Epos2
from emulators.servo.axis import ServoAxis
from emulators.wires import DatagramWire, FaultyCanWire
from emulators.world import Station, Wire, World
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import Nanoseconds

BRIDGE: Final = "bridge"
OPERATOR_STATION: Final = "operator"
STRANGER: Final = "stranger"


class Stranger:
    """A node on the CAN bus that hears nothing, and sends what a fault has it send."""

    def listens(self, packet: Packet) -> bool:
        """Return that it listens to nothing."""
        del packet
        return False

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Ignore a frame."""
        del packet, now
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        """Do nothing."""
        del now
        return Reaction()


@dataclass(slots=True, eq=False)
class Site:
    """One bench: buses by link, drives and servo axes by axis, and the adapters of serial lines by link."""

    robot: AnyRobot
    world: World
    cans: Mapping[str, FaultyCanWire]
    operator: DatagramWire
    drives: Mapping[str, Epos2]
    axes: Mapping[str, ServoAxis]
    adapters: Mapping[str, Adapter]
    _strangers: dict[str, Station] = field(default_factory=dict)
    """By the link on whose bus they are."""
    _unplugged: dict[str, Mapping[str, Wire]] = field(default_factory=dict)

    def send(self, link: str, address: int, payload: bytes) -> None:
        """Have a stranger queue a frame on a link's bus; he is there from the first one on."""
        stranger = self._strangers.get(link)
        if stranger is None:
            name = STRANGER if len(self.cans) == 1 else f"{STRANGER} on {link}"
            stranger = self.world.attach(name, Stranger(), {CAN: self.cans[link]})
            self._strangers[link] = stranger
        self.cans[link].carry(stranger, Packet(CAN, address, payload))

    def waiting(self, link: str) -> int:
        """Return how many frames of the stranger's on this link wait or are under way."""
        stranger = self._strangers.get(link)
        return 0 if stranger is None else self.cans[link].waiting(stranger)

    def switch_off(self, name: str) -> None:
        """Take the supply from a drive, logic included: it is off its wires, its motor without power."""
        self._unplugged[name] = self.world.links(name)
        self.world.detach(name)
        self.drives[name].switch_off()

    def switch_on(self, name: str) -> None:
        """Give the supply back: the drive starts as after power-on."""
        self.world.attach(name, self.drives[name], self._unplugged.pop(name))
