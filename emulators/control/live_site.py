"""Places of faults on real buses and lines: the emulated devices, and what reaches or leaves them.

What is outside is not in our hands: no bit of a frame, no other controller, no bridge, no operator. A frame
that was lost by a fault never reaches the real bus, or none of the emulated devices.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Final, NoReturn

from emulators.bench.faults.site import BRIDGE, Site
from emulators.family import Devices, Way
from emulators.gateway import Cluster
from emulators.wires import DatagramWire, Disturbance, Effect
from emulators.wires.disturbance import Standing
from emulators.world import World, WorldNode
from firmware_bridge.node import CAN, LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import NEVER, Nanoseconds


class NotOnARealBusError(Exception):
    """What no real bus lets us do; the kind's own row refuses it before."""


def _refused(*_: object) -> NoReturn:
    raise NotOnARealBusError("this is not in the hands of an emulated device")


class LiveBus:
    """A real CAN bus with emulated devices on it; a `emulators.bench.faults.site.Bus`."""

    def __init__(self, cluster: Cluster, name: str) -> None:
        """Take the devices, and the name that the link has outside."""
        self.name = name
        self._cluster: Final = cluster
        self._standing: list[Standing] = []
        self._beyond: tuple[str, ...] = ()

    def loses(self, sender: str, receiver: str | None) -> bool:
        """Return whether a frame is lost on its way from a device or from outside, or to a device."""
        now, whose = self._cluster.now, sender or BRIDGE
        if not self._standing:
            return False
        self._standing = [one for one in self._standing if now < one.what.end]
        effect = Effect.LOSS if receiver is None else Effect.OVERRUN
        return any(
            one.what.effect is effect and one.what.receiver in {None, receiver} and one.meets(whose, now)
            for one in self._standing
        )

    def disturb(self, what: Disturbance, of: object = None) -> None:
        """Lose frames from now on."""
        self._standing.append(Standing(what, of))

    def calm(self, of: object) -> None:
        """End what this fault has disturbed."""
        self._standing = [one for one in self._standing if one.of is not of]

    def cut(self, beyond: Collection[str]) -> None:
        """Cut the devices beyond off, each for itself."""
        self._beyond = tuple(name for name in beyond if self._cluster.here(name))
        for name in self._beyond:
            self._cluster.silence(name, self._cluster.now)

    def repair(self) -> None:
        """Let them send and receive again."""
        for name in self._beyond:
            self._cluster.silence(name, NEVER)
        self._beyond = ()

    def swap(self, names: Collection[str]) -> None:
        """Refuse: bits are not ours."""
        _refused(names)

    def throw_off(self, name: str, until: Nanoseconds) -> None:
        """Refuse: error counters are the real controller's."""
        _refused(name, until)

    def join(self, world: World, station: WorldNode, link: str) -> None:
        """Refuse: it is no wire of a virtual world."""
        _refused(world, station, link)

    def leave(self, station: WorldNode) -> None:
        """Refuse, as `join`."""
        _refused(station)

    def carry(self, sender: WorldNode, packet: Packet) -> None:
        """Refuse: a foreign node's frame is sent by the site."""
        _refused(sender, packet)

    def waiting(self, station: WorldNode) -> int:
        """Refuse, as `carry`."""
        _refused(station)


class Cable:
    """The cable of a device on a pseudo-terminal: without it the port is gone, and the device lives on."""

    def __init__(self, cluster: Cluster, name: str, line: str) -> None:
        """Take the devices, the name of the device, and that of the line outside."""
        self._cluster: Final = cluster
        self._name: Final = name
        self._line: Final = line
        self._plugged = True

    @property
    def plugged(self) -> bool:
        """False while it is out; setting it pulls it, or plugs it in."""
        return self._plugged

    @plugged.setter
    def plugged(self, plugged: bool) -> None:
        self._plugged = plugged
        self._cluster.report(self._line, LINE_BACK if plugged else LINE_LOST)
        self._cluster.silence(self._name, NEVER if plugged else self._cluster.now)


@dataclass(slots=True, eq=False)
class NoBridges:
    """The bridge is another program: its own control of it is the user's."""

    adapters: Sequence[Cable] = ()
    start: Callable[[], None] = _refused
    start_second: Callable[[], None] = _refused
    end: Callable[[str], None] = _refused
    suspend: Callable[[str], None] = _refused
    resume: Callable[[str], None] = _refused


class LiveSite(Site):
    """The emulated devices of one run."""

    def __init__(self, robot: AnyRobot, devices: Devices, cluster: Cluster) -> None:
        self._outer: Final = {
            one.link: {own: cluster.links(name).get(own, own) for own in one.on}
            for name, one in devices.stations.items()
            if cluster.here(name)
        }
        on_can = {one.link for one in devices.stations.values() if Way.BUS in one.on.values()}
        buses = {link: LiveBus(cluster, self._outer[link][CAN]) for link in sorted(on_can)}
        cables = [
            Cable(cluster, name, cluster.links(name).get(own, own))
            for name, one in devices.stations.items()
            for own, way in one.on.items()
            if way is Way.LINE and cluster.here(name)
        ]
        super().__init__(
            robot,
            cluster,
            buses,
            DatagramWire(),
            devices=devices,
            bridges=NoBridges(cables),
        )
        self._cluster: Final = cluster
        by_name = {bus.name: bus for bus in buses.values()}

        def loses(sender: str, receiver: str | None, link: str) -> bool:
            bus = by_name.get(link)
            return bus is not None and bus.loses(sender, receiver)

        cluster.loses = loses if by_name else None

    def send(self, link: str, address: int, payload: bytes) -> None:
        """Put a frame of a foreign node on the bus."""
        self._cluster.send(self._outer[link][CAN], Packet(CAN, address, payload))

    def disturb(self, link: str, data: bytes) -> None:
        """Put bytes that neither end has sent on a serial line."""
        (outer,) = self._outer[link].values()
        self._cluster.send(outer, Packet(outer, 0, data))

    def waiting(self, link: str) -> int:
        """Return 0: what waits is the system's."""
        del link
        return 0
