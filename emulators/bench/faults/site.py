"""Where faults are put on: the parts of one bench, by the names in its robot file.

It refuses to know which faults there are.
"""

from collections.abc import Mapping
from typing import Final

from emulators.bench.adapter import Adapter
from emulators.epos2.drive import Epos2
from emulators.servo.axis import ServoAxis
from emulators.wires import DatagramWire, FaultyCanWire
from emulators.world import Station, Wire, World
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import Robot
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


class Site:
    """One bench."""

    def __init__(
        self,
        robot: Robot,
        world: World,
        can: FaultyCanWire,
        operator: DatagramWire,
        *,
        drives: Mapping[str, Epos2],
        axes: Mapping[str, ServoAxis],
        adapter: Adapter | None = None,
    ) -> None:
        """Take drives and servo axes by axis name, and the adapter of a bridge on a serial line."""
        self.robot: Final = robot
        self.world: Final = world
        self.can: Final = can
        self.operator: Final = operator
        self.drives: Final = drives
        self.axes: Final = axes
        self.adapter: Final = adapter
        self._stranger: Station | None = None
        self._unplugged: dict[str, Mapping[str, Wire]] = {}

    def send(self, address: int, payload: bytes) -> None:
        """Have a stranger queue a frame on the CAN bus; he is there from the first one on."""
        if self._stranger is None:
            self._stranger = self.world.attach(STRANGER, Stranger(), {CAN: self.can})
        self.can.carry(self._stranger, Packet(CAN, address, payload))

    @property
    def waiting(self) -> int:
        """How many frames of the stranger's wait or are under way."""
        return 0 if self._stranger is None else self.can.waiting(self._stranger)

    def switch_off(self, name: str) -> None:
        """Take the supply from a drive, logic included: it is off its wires, its motor without power."""
        self._unplugged[name] = self.world.links(name)
        self.world.detach(name)
        self.drives[name].switch_off()

    def switch_on(self, name: str) -> None:
        """Give the supply back: the drive starts as after power-on."""
        self.world.attach(name, self.drives[name], self._unplugged.pop(name))
