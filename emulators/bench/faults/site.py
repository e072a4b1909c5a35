"""Places of faults: the parts of one bench, by the names in its robot file.

It does not know the individual faults.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Protocol

from emulators.arduino_omni.ar2.board import Ar2Board
from emulators.arduino_omni.board import Board
from emulators.bench.adapter import Adapter
from emulators.bench.second_station import SecondStation
from emulators.epos2.drive import Epos2
from emulators.motion_capture.system import MotionCapture
from emulators.servo.axis import ServoAxis
from emulators.wires import DatagramWire, FaultyCanWire
from emulators.world import Wire, World, WorldNode
from firmware_bridge.node import CAN, OPERATOR, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import Nanoseconds
from fmu.plant import FmuPlant

BRIDGE: Final = "bridge"
OPERATOR_STATION: Final = "operator"
FOREIGN_NODE: Final = "foreign node"
SECOND_BRIDGE: Final = "second bridge"
SECOND_STATION: Final = "second station"


class Bridges(Protocol):
    """Source of the bridge's processes, with the adapters that they use."""

    @property
    def adapters(self) -> Sequence[Adapter]:
        """Adapters of the newest process at its ends of the serial lines."""

    def start(self) -> None:
        """Start one in the place of the one that was; it is killed where it still runs."""

    def start_second(self) -> None:
        """Start one beside it, as `SECOND_BRIDGE`."""


class ForeignNode:
    """A node on the CAN bus that receives nothing, and sends the frames of a fault."""

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
    """One bench: buses by link, drives and servo axes by axis."""

    robot: AnyRobot
    world: World
    cans: Mapping[str, FaultyCanWire]
    operator: DatagramWire
    drives: Mapping[str, Epos2]
    axes: Mapping[str, ServoAxis]
    bridges: Bridges
    captures: Mapping[str, MotionCapture] = field(default_factory=dict)
    """The capture systems by link."""
    capture_wires: Mapping[str, DatagramWire] = field(default_factory=dict)
    """Their outgoing datagrams, by link."""
    lines: Mapping[str, Wire] = field(default_factory=dict)
    """The serial lines by link."""
    boards: Mapping[str, Board | Ar2Board] = field(default_factory=dict)
    """Arduinos, with a motor shield or an arm, by the link."""
    plant: FmuPlant | None = None
    stations: list[SecondStation] = field(default_factory=list)
    """All stations that have joined the operator's link, the newest last."""
    _foreign_nodes: dict[str, WorldNode] = field(default_factory=dict)
    """Foreign nodes by the link on whose bus or line they are."""
    _unplugged: dict[str, Mapping[str, Wire]] = field(default_factory=dict)

    def shield(self, link: str) -> Board:
        """Return the board with a motor shield on a link; TypeError where it has none."""
        board = self.boards[link]
        if not isinstance(board, Board):
            raise TypeError(f"the board on the link '{link}' has no motor shield")
        return board

    def send(self, link: str, address: int, payload: bytes) -> None:
        """Queue a frame of a foreign node on a link's bus; the node is there from the first one on."""
        name = FOREIGN_NODE if len(self.cans) == 1 else f"{FOREIGN_NODE} on {link}"
        wire = self.cans[link]
        wire.carry(self._foreign_node(link, name, {CAN: wire}), Packet(CAN, address, payload))

    def disturb(self, link: str, data: bytes) -> None:
        """Put bytes that neither end has sent on a serial line, so that both receive them."""
        wire = self.lines[link]
        wire.carry(
            self._foreign_node(link, f"{FOREIGN_NODE} on {link}", {SERIAL: wire}), Packet(SERIAL, 0, data)
        )

    def _foreign_node(self, link: str, name: str, wires: Mapping[str, Wire]) -> WorldNode:
        # Attached with its first frame: a silent node on the bus would already acknowledge others' frames.
        found = self._foreign_nodes.get(link)
        if found is None:
            found = self._foreign_nodes[link] = self.world.attach(name, ForeignNode(), wires)
        return found

    def waiting(self, link: str) -> int:
        """Return how many frames of the foreign node's on this link wait or are under way."""
        foreign_node = self._foreign_nodes.get(link)
        return 0 if foreign_node is None else self.cans[link].waiting(foreign_node)

    def switch_off(self, name: str) -> None:
        """Take the supply from a drive, logic included: it is off its wires, its motor without power."""
        self._unplugged[name] = self.world.links(name)
        # Off the wires first: a frame that is under way is destroyed with the supply.
        self.world.detach(name)
        self.drives[name].switch_off()

    def switch_on(self, name: str) -> None:
        """Give the supply back: the drive starts as after power-on."""
        self.world.attach(name, self.drives[name], self._unplugged.pop(name))

    def join_station(self, system: int, stick: float, order: str) -> None:
        """Let a second ground station join the operator's link."""
        if self.world.here(SECOND_STATION):
            self.world.detach(SECOND_STATION)
        ids = (self.robot.operator.system_id, self.robot.operator.component_id)
        self.stations.append(SecondStation(ids, system, stick, order, len(self.stations)))
        self.world.attach(SECOND_STATION, self.stations[-1], {OPERATOR: self.operator})

    def dismiss_station(self) -> None:
        """Let it say nothing any more; what is on its way still arrives."""
        self.stations[-1].leaves()
