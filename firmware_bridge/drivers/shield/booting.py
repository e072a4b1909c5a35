"""When a board that may be starting anew is spoken to, and when it is reset.

A byte in the first second after a reset keeps the boot loader of a Mega, stk500v2, until it has heard none
for 9 s: who asks again and again is never answered. So nothing is said until the firmware must run.
"""

from typing import Final

from firmware_bridge.node import DTR_DOWN, DTR_UP
from firmware_bridge.packet import Packet
from firmware_bridge.robot.settings.shield import ShieldLink
from firmware_bridge.units import MILLISECOND, Nanoseconds


class Booting:
    """Of one board on the link of this name."""

    def __init__(self, name: str, table: ShieldLink) -> None:
        self._name: Final = name
        self._boots: Final = table.boots * MILLISECOND
        self._within: Final = table.boots_within_ms * MILLISECOND
        self.speaks_at: Nanoseconds = 0
        """Before this nothing is said."""
        self.seeks_at: Nanoseconds = 0
        """When a board that is lost is reset, whoever asks for it."""
        self.found_until: Nanoseconds = 0
        """When a board that is looked for must have answered."""

    def begun(self, now: Nanoseconds) -> None:
        """Learn that it may have been reset now."""
        self.speaks_at = now + self._boots

    def pulse(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Return what resets it."""
        self.begun(now)
        return Packet(self._name, DTR_DOWN, b""), Packet(self._name, DTR_UP, b"")

    def looked_for(self, now: Nanoseconds) -> None:
        """Learn that it is looked for from now on."""
        self.found_until = now + self._within

    def lost(self, now: Nanoseconds) -> None:
        """Learn that it is silent, or has not been found; it is given time before the next reset."""
        self.seeks_at = now + self._within
