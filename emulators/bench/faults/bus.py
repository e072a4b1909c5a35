"""Faults of the CAN bus: frames, cables, controllers, foreign nodes."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Annotated, ClassVar, Final, Literal

from numpy.random import Generator
from pydantic import Field

from emulators.bench.faults.fault import (
    CABLE_ORDER,
    Fault,
    Lasting,
    Node,
    OnBus,
    Problem,
    Share,
    Stations,
    absent,
    named,
)
from emulators.bench.faults.site import BRIDGE, Site
from emulators.wires import Disturbance, Effect
from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MICROSECOND, MILLISECOND, NEVER

_COMMANDS: Final = {
    "start": NmtCommand.START,
    "stop": NmtCommand.STOP,
    "enter_pre_operational": NmtCommand.ENTER_PRE_OPERATIONAL,
    "reset_node": NmtCommand.RESET_NODE,
    "reset_communication": NmtCommand.RESET_COMMUNICATION,
}
CONTROLLERS: Final = "bits of a frame and error counters are the real controller's"
_AHEAD: Final = 2
"""Frames in a babbler's queue: with one under way and one behind it the bus is never idle."""
Sender = Annotated[Node | None, Field(description="sender of the frames; without it all nodes")]
Receiver = Annotated[Node, Field(description="node that receives them with errors")]


class _Disturbing(OnBus, Lasting, ABC):
    """A disturbance of frames from the fault's begin to its end."""

    def take_off(self, site: Site) -> None:
        """Disturb no more."""
        site.cans[self.on(site.robot)].calm(self)


class FrameError(_Disturbing):
    """Frames are damaged on the bus."""

    kind: ClassVar = "frame_error"
    bench_only: ClassVar = CONTROLLERS
    among: ClassVar = Stations.ON_THE_BUS
    node: Sender = None
    share: Share = 1.0
    count: Annotated[int | None, Field(ge=1, description="greatest number of damaged frames")] = None

    def put_on(self, site: Site, chance: Generator) -> None:
        """Damage frames."""
        sender = None if self.node is None else named(site.robot, self.node)
        site.cans[self.on(site.robot)].disturb(
            Disturbance(sender, None, self.begin, self.end, self.count, Effect.ERROR, self.share, chance),
            of=self,
        )


class ReceptionError(_Disturbing):
    """Frames are damaged for one receiver."""

    kind: ClassVar = "reception_error"
    bench_only: ClassVar = CONTROLLERS
    among: ClassVar = Stations.ON_THE_BUS
    node: Receiver
    share: Share = 1.0

    def put_on(self, site: Site, chance: Generator) -> None:
        """Spoil frames at one receiver."""
        receiver = named(site.robot, self.node)
        site.cans[self.on(site.robot)].disturb(
            Disturbance(None, receiver, self.begin, self.end, None, Effect.ERROR, self.share, chance),
            of=self,
        )


class FrameLoss(_Disturbing):
    """Frames are lost between a node and the bus."""

    kind: ClassVar = "frame_loss"
    among: ClassVar = Stations.ON_THE_BUS
    node: Sender = None
    share: Share = 1.0

    def put_on(self, site: Site, chance: Generator) -> None:
        """Lose frames."""
        sender = None if self.node is None else named(site.robot, self.node)
        site.cans[self.on(site.robot)].disturb(
            Disturbance(sender, None, self.begin, self.end, None, Effect.LOSS, self.share, chance),
            of=self,
        )


class _NotOfTheBridge(Fault, ABC):
    """A fault of a node on a bus, which is not possible where the bridge, another program, is that node."""

    def real_bus_problem(self, robot: AnyRobot) -> str:
        """Return why it is not possible on a real bus: it is the bridge's."""
        bridge = named(robot, getattr(self, "node", "")) == BRIDGE
        return "the bridge is another program, and its controller is a real one" if bridge else ""


class ReceiveOverrun(_NotOfTheBridge, _Disturbing):
    """A node's controller has no room for frames."""

    kind: ClassVar = "receive_overrun"
    among: ClassVar = Stations.ON_THE_BUS
    node: Annotated[Node, Field(description="node with the slow controller")]
    share: Share = 1.0

    def put_on(self, site: Site, chance: Generator) -> None:
        """Lose frames at one receiver."""
        receiver = named(site.robot, self.node)
        site.cans[self.on(site.robot)].disturb(
            Disturbance(None, receiver, self.begin, self.end, None, Effect.OVERRUN, self.share, chance),
            of=self,
        )


class _Station(OnBus, Lasting, ABC):
    """A fault of one named node on the bus."""

    among: ClassVar = Stations.ON_THE_BUS
    node: Annotated[Node, Field(description="affected node")]

    def put_on(self, site: Site, chance: Generator) -> None:
        """Let it begin at the node."""
        del chance
        self.meet(site, next(iter(self.targets(site.robot))))

    @abstractmethod
    def meet(self, site: Site, name: str) -> None:
        """Let it begin at the node of this name."""


class BusOff(_Station):
    """A controller leaves the bus."""

    kind: ClassVar = "bus_off"
    bench_only: ClassVar = CONTROLLERS

    def meet(self, site: Site, name: str) -> None:
        """Damage all its frames until it is off, and keep it there."""
        site.cans[self.on(site.robot)].throw_off(name, self.end)


class CanSwapped(_Station):
    """CAN high and CAN low are exchanged at a node."""

    kind: ClassVar = "can_swapped"
    bench_only: ClassVar = CONTROLLERS

    def meet(self, site: Site, name: str) -> None:
        """Exchange the wires."""
        site.cans[self.on(site.robot)].swap([name])

    def take_off(self, site: Site) -> None:
        """Correct the wiring, and send what waited."""
        site.cans[self.on(site.robot)].repair()


class CanCut(OnBus, Lasting):
    """The CAN cable is cut between two neighbors."""

    kind: ClassVar = "can_cut"
    among: ClassVar = Stations.ON_THE_BUS
    between: Annotated[
        tuple[Node, Node],
        Field(strict=False, description=f"two neighbors on the cable; order on the cable: {CABLE_ORDER}"),
    ]

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Yield the equipment that this robot lacks for it."""
        found = [problem for node in self.between for problem in absent("between", node, self.among, robot)]
        yield from found
        if found:
            return
        # The bridge is at one end, the drives follow in the order of the robot file.
        cable = self.among.of(robot)
        one, other = sorted(cable.index(named(robot, node) or "") for node in self.between)
        if other != one + 1:
            yield "between", f"these two are not neighbors on the cable: {', '.join(cable)}"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Cut it."""
        del chance
        cable = self.among.of(site.robot)
        # The cable is a line: from the farther neighbor on, every node is beyond the cut.
        far = max(cable.index(named(site.robot, node) or "") for node in self.between)
        site.cans[self.on(site.robot)].cut(cable[far:])

    def take_off(self, site: Site) -> None:
        """Repair it, and send the frames that waited."""
        site.cans[self.on(site.robot)].repair()


class BabblingNode(OnBus, Lasting):
    """A foreign node floods the bus."""

    kind: ClassVar = "babbling_node"
    among: ClassVar = Stations.NONE
    identifier: Annotated[
        int, Field(ge=1, le=0x7FF, description="identifier of its frames; the lowest wins")
    ] = 1
    every_us: Annotated[
        int, Field(ge=50, le=1_000_000, description="interval between two frames of 8 bytes, in us")
    ] = 200

    def put_on(self, site: Site, chance: Generator) -> None:
        """Begin to babble."""
        del chance
        self._babble(site)

    def _babble(self, site: Site) -> None:
        world = site.world
        if site.lasts(self, self.end):
            # No more than that: a queue that grew would go on after the fault's end.
            if site.waiting(self.on(site.robot)) < _AHEAD:
                site.send(self.on(site.robot), self.identifier, bytes(8))
            world.call_at(world.now + self.every_us * MICROSECOND, self._babble, site)


class NmtForeignNode(OnBus):
    """A foreign node sends a network command."""

    kind: ClassVar = "nmt_foreign_node"
    command: Annotated[
        Literal["start", "stop", "enter_pre_operational", "reset_node", "reset_communication"],
        Field(description="network command of CiA 301"),
    ]
    node: Annotated[Node | None, Field(description="addressed node; without it all nodes")] = None

    def put_on(self, site: Site, chance: Generator) -> None:
        """Send it."""
        del chance
        name = None if self.node is None else named(site.robot, self.node)
        # Node-ID 0 is a broadcast (CiA 301).
        number = next(
            (axis.settings.number for axis in site.robot.axes if axis.name == name), cia301.ALL_NODES
        )
        site.send(self.on(site.robot), cia301.NMT, cia301.encode_nmt(_COMMANDS[self.command], number))


class StrayFrames(OnBus, Lasting):
    """A foreign node sends one frame again and again."""

    kind: ClassVar = "stray_frames"
    among: ClassVar = Stations.NONE
    identifier: Annotated[int, Field(ge=0, le=0x7FF, description="identifier of its frame")]
    data: Annotated[
        str, Field(pattern="^([0-9A-Fa-f]{2}){0,8}$", description="its data bytes, in hexadecimal digits")
    ] = ""
    every_ms: Annotated[int, Field(ge=1, le=10_000, description="interval between two frames, in ms")] = 50

    def put_on(self, site: Site, chance: Generator) -> None:
        """Begin to send."""
        del chance
        self._send(site)

    def _send(self, site: Site) -> None:
        world, link = site.world, self.on(site.robot)
        if site.lasts(self, self.end):
            if site.waiting(link) < _AHEAD:
                site.send(link, self.identifier, bytes.fromhex(self.data))
            world.call_at(world.now + self.every_ms * MILLISECOND, self._send, site)


class NodeSilent(_NotOfTheBridge, Lasting):
    """A node is cut off all its links."""

    kind: ClassVar = "node_silent"
    among: ClassVar = Stations.ALL
    node: Annotated[Node, Field(description="silent node; the bridge is off the operator's link, too")]

    def put_on(self, site: Site, chance: Generator) -> None:
        """Cut it off."""
        del chance
        site.world.silence(next(iter(self.targets(site.robot))), site.world.now)

    def take_off(self, site: Site) -> None:
        """Connect it again."""
        site.world.silence(next(iter(self.targets(site.robot))), NEVER)
