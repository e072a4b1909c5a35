"""A python-can bus and an ear for the `canopen` library, above the virtual bus.

Whoever sends lets the world run until the answers are there, so the library's own time-outs, which read the
real clock, never come into play.
"""

from typing import Any

import can
import canopen

from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, Nanoseconds, from_seconds
from firmware_bridge.wire.can import REMOTE, identifier


class Listener:
    """The master's ear on the wire: a node that never speaks by itself."""

    def __init__(self, network: canopen.Network) -> None:
        self.network = network
        self.heard: list[Packet] = []

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self.heard.append(packet)
        if not packet.address & REMOTE:
            self.network.notify(identifier(packet.address), bytearray(packet.payload), now / 1e9)
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        del now
        return Reaction((), NEVER)


class VirtualBus:
    """What `canopen` takes for a python-can bus."""

    def __init__(self, world: World, wire: CanWire, station: Any) -> None:
        self.world, self.wire, self.station = world, wire, station

    def send(self, message: can.Message) -> None:
        address = message.arbitration_id | (REMOTE if message.is_remote_frame else 0)
        self.wire.carry(self.station, Packet(CAN, address, bytes(message.data or b"\0" * message.dlc)))
        self.runs(0.002)

    def runs(self, seconds: float) -> None:
        self.world.run(self.world.now + from_seconds(seconds))
