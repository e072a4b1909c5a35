"""A node that sends the recorded packets again, at the recorded instants, and ignores its input."""

from collections.abc import Sequence

from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, Nanoseconds


class Player:
    """Player that sends each packet at its instant; the instants never fall."""

    def __init__(self, script: Sequence[tuple[Nanoseconds, Packet]]) -> None:
        self._script = script
        self._next = 0

    def receive(self, _packet: Packet, _now: Nanoseconds) -> Reaction:
        """Ignore the packet, and go on as planned."""
        return Reaction((), self._wake_at())

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send what is due."""
        begin = self._next
        while self._wake_at() <= now:
            self._next += 1
        return Reaction(tuple(packet for _, packet in self._script[begin : self._next]), self._wake_at())

    def listens(self, _packet: Packet) -> bool:
        """Listen to nothing."""
        return False

    def _wake_at(self) -> Nanoseconds:
        return self._script[self._next][0] if self._next < len(self._script) else NEVER
