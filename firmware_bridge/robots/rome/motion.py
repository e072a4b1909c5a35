"""ROME's motion in its own words, and what is known of its body; ahead, left, counter-clockwise positive."""

from firmware_bridge.motion.omni import Twist
from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class Motion:
    """What the operator commands, what the gate allows, and what the bridge demands."""

    ahead_mps: float = 0.0
    left_mps: float = 0.0
    turn_rad_s: float = 0.0
    path_s: float | None = None
    """How far a guide is on its path, in the path's own seconds; None where no one guides."""

    @property
    def twist(self) -> Twist:
        """The motion in the body's frame."""
        return Twist(self.ahead_mps, self.left_mps, self.turn_rad_s)


@valueclass(frozen=True, slots=True)
class State:
    """What the wheels tell."""

    ahead_mps: float
    left_mps: float
    turn_rad_s: float
