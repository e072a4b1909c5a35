"""The bridge behind its lines, and wires for all its links, as a recording of it wants them.

On the bench a bus and a board's chip take the time that they took. On its line to drives only the recording
has the times of arrival, so they are replayed. A real machine's own recording has the packets that left, with
their times.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from emulators.family import Lane, family_of
from emulators.replay.order import ReplayOrder
from emulators.replay.recordings import duration_of
from emulators.replay.senders import BRIDGE
from emulators.replay.stage import RECORDING
from emulators.wires import CanWire, DatagramWire
from emulators.world import Wire
from firmware_bridge.bridge import Bridge
from firmware_bridge.dissector import kinds_of
from firmware_bridge.node import CAN, OPERATOR, Node
from firmware_bridge.robot_types import robot_type_of
from firmware_bridge.runtime.last_places import RECORDED, LastPlaces
from firmware_bridge.safety.guard import guarded


@dataclass(frozen=True, slots=True)
class Machine:
    """The bridge, and its links by their names."""

    bridge: Bridge
    node: Node
    """The bridge behind its guard and its lines."""
    lanes: Mapping[str, Lane]

    @property
    def wires(self) -> dict[str, Wire]:
        """All wires."""
        return {name: lane.wire for name, lane in self.lanes.items()}


def machine_of(order: ReplayOrder, *, timed: bool) -> Machine:
    """Return a bridge that was not woken yet; not `timed`, its packets arrive as they leave.

    A bus is timed even so, unless it was recorded where the bridge is: its folder has it as it left.
    """
    robot = order.robot
    bridge = Bridge(robot, robot_type_of(robot), confirmed=order.confirmed, mode=order.mode)
    if order.recording.is_dir():
        # The last positions, as that bridge read them at its start: they are in the run's folder.
        bridge.offer(LastPlaces(order.recording / RECORDED).read())
    node: Node = guarded(bridge, robot)
    lanes = {name: _untimed(name, kind) for name, kind in kinds_of(robot).items() if kind != CAN}
    for link_drivers in bridge.all_drivers.all:
        name = link_drivers.name
        make = family_of(robot, name).line
        line = None if make is None else make(robot, node, link_drivers.link, BRIDGE, None)
        if line is not None:
            node = line.adapter
            if timed:
                lanes[name] = line.lane(lanes[name].kind, RECORDING)
    for name in robot.links:
        bus = family_of(robot, name).bus(robot, name)
        if bus is not None and name not in lanes:
            # A frame in the folder of a real run has its departure, not its arrival.
            at_bridge = not timed and order.recording.is_dir()
            lanes[name] = _untimed(name, CAN) if at_bridge else _bus(bus.bit_rate)
    return Machine(bridge, node, {**lanes, OPERATOR: _untimed(OPERATOR, OPERATOR)})


def _untimed(name: str, kind: str) -> Lane:
    return Lane(kind, DatagramWire(name=name), lambda _: 0)


def _bus(bit_rate: int) -> Lane:
    bus = CanWire(bit_rate)
    return Lane(CAN, bus, lambda packet: duration_of(packet, bus.bit_time))
