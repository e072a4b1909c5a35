"""A serial line on which one end is a recording: its bytes arrive as they were recorded."""

from typing import Final, TypeAlias

from emulators.wires.serial import BITS_PER_BYTE, SerialWire
from emulators.world import WorldNode
from firmware_bridge.packet import Packet
from firmware_bridge.units import SECOND, Nanoseconds

_Flight: TypeAlias = tuple[WorldNode, Packet]


class PlayedLine(SerialWire):
    """Line on which the packets of the station `player` arrive whole, after their bytes' time."""

    def __init__(self, baud: int, player: str, name: str) -> None:
        super().__init__(baud, name=name)
        self._player: Final = player

    def duration(self, packet: Packet) -> Nanoseconds:
        """Return how long the bytes take, in ns."""
        return len(packet.payload) * BITS_PER_BYTE * SECOND // self.baud

    def carry(self, sender: WorldNode, packet: Packet) -> None:
        """Queue another one's bytes; bring the player's."""
        if sender.name == self._player:
            world = self._ends.world
            world.call_at(world.now + self.duration(packet), self._bring, (sender, packet))
        else:
            super().carry(sender, packet)

    def _bring(self, flight: _Flight) -> None:
        sender, packet = flight
        self._ends.hand_over(sender, packet)
