"""One axis as the guard remembers it: what left for its drive last, and the safe frame that follows."""

from dataclasses import dataclass

from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Mode
from firmware_bridge.safety.guard_rules import ENABLE, HALT, NEW_SET_POINT, POWERED, SET_POINT, AxisRules
from firmware_bridge.units import Nanoseconds


@dataclass(slots=True)
class GuardedAxis:
    """What one drive was last told; without power until it is told otherwise."""

    rules: AxisRules
    word: int = 0
    target: int = 0
    spoken_at: Nanoseconds = 0
    """When the node last had a set-point for it, good or bad."""

    @property
    def powered(self) -> bool:
        """Whether the newest frame leaves the drive with power."""
        return self.word in POWERED

    @property
    def under_way(self) -> bool:
        """Whether the newest frame asks for motion."""
        if self.rules.axis.mode is Mode.VELOCITY:
            return self.word == ENABLE and self.target != 0
        return self.word == NEW_SET_POINT

    def told(self, payload: bytes) -> None:
        """Learn what an admitted set-point says."""
        self.word, self.target = SET_POINT.unpack(payload)

    def safe(self) -> Packet:
        """Return the frame that takes motion away and changes nothing about the power."""
        if self.rules.axis.mode is Mode.VELOCITY:
            word, target = ENABLE, 0
        else:
            word, target = HALT, self.target
        return Packet(
            CAN, self.rules.set_point_id, SET_POINT.pack(word if self.powered else self.word, target)
        )
