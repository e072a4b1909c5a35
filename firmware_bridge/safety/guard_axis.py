"""One axis as the guard remembers it: what left for its drive last, and the safe frame that follows."""

from typing import Final

from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Mode
from firmware_bridge.safety.guard_rules import ENABLE, HALT, NEW_SET_POINT, POWERED, SET_POINT, AxisRules


class GuardedAxis:
    """What one drive was last told; without power until it is told otherwise."""

    __slots__ = ("_has_speed", "rules", "spoken_at", "target", "word")

    def __init__(self, rules: AxisRules) -> None:
        self.rules: Final = rules
        self.word = 0
        self.target = 0
        self.spoken_at = 0
        """When the node last had a set-point for it, good or bad."""
        self._has_speed: Final = rules.axis.mode is Mode.VELOCITY
        """Whether its target is a speed; else it is a position."""

    @property
    def powered(self) -> bool:
        """Whether the newest frame leaves the drive with power."""
        return self.word in POWERED

    @property
    def under_way(self) -> bool:
        """Whether the newest frame asks for motion."""
        if self._has_speed:
            return self.word == ENABLE and self.target != 0
        return self.word == NEW_SET_POINT

    def told(self, payload: bytes) -> None:
        """Learn what an admitted set-point says."""
        self.word, self.target = SET_POINT.unpack(payload)

    def safe(self) -> Packet:
        """Return the frame that takes motion away and changes nothing about the power."""
        if self._has_speed:
            word, target = ENABLE, 0
        else:
            word, target = HALT, self.target
        return Packet(
            CAN, self.rules.set_point_id, SET_POINT.pack(word if self.powered else self.word, target)
        )
