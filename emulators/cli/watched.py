"""Reports of an emulated device's console on its peers, each reported once."""

from collections.abc import Iterable
from typing import Final

from firmware_bridge.canopen.cia301 import EMERGENCY, ERROR_CONTROL, SDO_REQUEST, SDO_RESPONSE
from firmware_bridge.canopen.objects import DEVICE_TYPE
from firmware_bridge.canopen.sdo import encode_upload
from firmware_bridge.cli.console import say
from firmware_bridge.node import Node, Stoppable
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.recording import Direction, Recorded
from firmware_bridge.units import Nanoseconds

OWN: Final = {SDO_RESPONSE: "answers", ERROR_CONTROL: "heartbeats", EMERGENCY: "emergencies"}
"""Services that only the node itself sends."""


def duplicates_reported(node: Node, places: Iterable[tuple[str, int]]) -> Node:
    """Return a node that reports, once for each link and number, a second node with the same number."""
    own = {(link, kind + number): (number, text) for link, number in places for kind, text in OWN.items()}
    named = set[tuple[str, int]]()

    def received(_now: Nanoseconds, direction: Direction, packet: Packet) -> None:
        place = packet.link, packet.address
        if direction is not Direction.RECEIVED or place not in own:
            return
        number, text = own[place]
        if (packet.link, number) not in named:
            named.add((packet.link, number))
            say(
                f"node {number} is on the bus twice: {text} with its number have come from elsewhere "
                f"(0x{packet.address:03X}); end the other drive, or take another number"
            )

    return Recorded(node, received)


class RollCalled:
    """A node around drives that checks at its start, once for each number, if another node has it, too.

    The request is the program's, no drive's: it reads 0x1000, changes nothing, and is not recorded. Our own
    frames do not come back to us, so that only another node can answer; `duplicates_reported` inside it
    reports that.
    """

    def __init__(self, node: Node, places: Iterable[tuple[str, int]]) -> None:
        self.node = node
        self._requested = tuple(
            Packet(link, SDO_REQUEST + number, encode_upload(DEVICE_TYPE)) for link, number in places
        )

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Pass it on."""
        return self.node.receive(packet, now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the drives; the first time, ask."""
        reaction = self.node.wake(now)
        requested, self._requested = self._requested, ()
        return Reaction(requested + reaction.sent, reaction.wake_at) if requested else reaction

    def stop(self, now: Nanoseconds) -> Reaction:
        """Stop the drives, where they can be stopped."""
        return self.node.stop(now) if isinstance(self.node, Stoppable) else Reaction()
