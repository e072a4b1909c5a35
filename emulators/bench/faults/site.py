"""Places of faults: the parts of one bench, by the names in its robot file.

It does not know the individual faults. On real buses it has fewer parts: `emulators.control.live_site`.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Protocol, runtime_checkable

from emulators.family import Devices
from emulators.wires import DatagramWire, Disturbance
from emulators.world import Wire, WorldNode
from firmware_bridge.node import CAN, OPERATOR, SERIAL, Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import Nanoseconds

if TYPE_CHECKING:
    from emulators.bench.second_station import SecondStation

BRIDGE: Final = "bridge"
OPERATOR_STATION: Final = "operator"
FOREIGN_NODE: Final = "foreign node"
SECOND_BRIDGE: Final = "second bridge"
SECOND_STATION: Final = "second station"


class Carrier(Protocol):
    """What carries the nodes of a bench, in virtual time or in real time."""

    @property
    def now(self) -> Nanoseconds:
        """The present instant."""

    def call_at(self, at: Nanoseconds, call: Callable[[Any], None], argument: object = None) -> None:
        """Call back at an instant."""

    def here(self, name: str) -> bool:
        """Return whether a node of this name is on its wires."""

    def links(self, name: str) -> Mapping[str, Any]:
        """Return what a node is attached to, by the names that it has for it."""

    def attach(self, name: str, node: Node, links: Mapping[str, Any]) -> Any:
        """Put a node there; it is first woken now."""

    def detach(self, name: str) -> None:
        """Remove a node."""

    def silence(self, name: str, from_time: Nanoseconds) -> None:
        """Cut a node off from an instant on; `NEVER` restores it."""

    def rouse(self, name: str) -> None:
        """Wake a node now."""


class Bus(Wire, Protocol):
    """A CAN bus, as far as faults are concerned."""

    def disturb(self, what: Disturbance, of: object = None) -> None:
        """Damage or lose frames from now on, until `calm` where a fault has done it."""

    def calm(self, of: object) -> None:
        """End what this fault has disturbed."""

    def cut(self, beyond: Collection[str]) -> None:
        """Cut the cable: the nodes of these names receive from each other only, and so do the others."""

    def swap(self, names: Collection[str]) -> None:
        """Exchange CAN high and CAN low at these nodes."""

    def repair(self) -> None:
        """Put the cable right: neither cut nor swapped."""

    def throw_off(self, name: str, until: Nanoseconds) -> None:
        """Damage a node's frames until its controller is off the bus, and keep it there until an instant."""

    def waiting(self, station: WorldNode) -> int:
        """Return how many frames of a node have not wholly left."""


class Pluggable(Protocol):
    """What has a plug that a fault can pull."""

    plugged: bool


class Bridges(Protocol):
    """Source of the bridge's processes, with the adapters that they use."""

    @property
    def adapters(self) -> Sequence[Pluggable]:
        """Adapters of the newest process at its ends of the serial lines."""

    def start(self) -> None:
        """Start one in the place of the one that was; it is killed where it still runs."""

    def start_second(self) -> None:
        """Start one beside it, as `SECOND_BRIDGE`."""

    def end(self, name: str) -> None:
        """Request one to end in good order, as by Ctrl-C."""

    def suspend(self, name: str) -> None:
        """Let one not run, if it has not ended."""

    def resume(self, name: str) -> None:
        """Let it run again."""


@runtime_checkable
class Supplied(Protocol):
    """A device that loses everything with its supply, its logic's included."""

    def switch_off(self) -> None:
        """Take the supply away."""


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
    """One bench: its devices, and its wires by link."""

    robot: AnyRobot
    world: Carrier
    cans: Mapping[str, Bus]
    operator: DatagramWire
    devices: Devices
    bridges: Bridges
    datagram_wires: Mapping[str, DatagramWire] = field(default_factory=dict)
    """The datagrams of devices, by link."""
    lines: Mapping[str, Wire] = field(default_factory=dict)
    """The serial lines by link."""
    stations: "list[SecondStation]" = field(default_factory=list)
    """All stations that have joined the operator's link, the newest last."""
    _foreign_nodes: dict[str, WorldNode] = field(default_factory=dict)
    """Foreign nodes by the link on whose bus or line they are."""
    _unplugged: dict[str, Mapping[str, Any]] = field(default_factory=dict)
    _cleared: list[object] = field(default_factory=list)
    """The faults that were ended before their time."""

    def clear(self, fault: object) -> None:
        """Note that a fault is ended before its time."""
        self._cleared.append(fault)

    def lasts(self, fault: object, end: Nanoseconds) -> bool:
        """Return whether a fault with this end still goes on."""
        return self.world.now < end and not any(one is fault for one in self._cleared)

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
        """Take the supply from a device, logic included: it is off its wires, its motor without power.

        TypeError for one that cannot lose its supply so.
        """
        node = self.devices.stations[name].node
        if not isinstance(node, Supplied):
            raise TypeError(f"'{name}' has no supply of its own")
        self._unplugged[name] = self.world.links(name)
        # Off the wires first: a frame that is under way is destroyed with the supply.
        self.world.detach(name)
        node.switch_off()

    def switch_on(self, name: str) -> None:
        """Give the supply back: the device starts as after power-on."""
        self.world.attach(name, self.devices.stations[name].node, self._unplugged.pop(name))

    def join_station(self, system: int, stick: float, order: str) -> None:
        """Let a second ground station join the operator's link."""
        from emulators.bench.second_station import SecondStation  # noqa: PLC0415 - with it comes pymavlink

        if self.world.here(SECOND_STATION):
            self.world.detach(SECOND_STATION)
        ids = (self.robot.operator.system_id, self.robot.operator.component_id)
        self.stations.append(SecondStation(ids, system, stick, order, len(self.stations)))
        self.world.attach(SECOND_STATION, self.stations[-1], {OPERATOR: self.operator})

    def dismiss_station(self) -> None:
        """Let it say nothing any more; what is on its way still arrives."""
        self.stations[-1].leaves()
