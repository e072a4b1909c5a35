"""ROME's motion in its own terms, and the state of its body; ahead, left, counter-clockwise positive."""

from firmware_bridge.motion.omni import Twist
from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class Motion:
    """A motion: the operator's command, the permitted one, or the bridge's set-point."""

    ahead_mps: float = 0.0
    left_mps: float = 0.0
    turn_rad_s: float = 0.0
    path_s: float | None = None
    """Progress of a path follower on its path, in the path's own seconds; None without one."""

    @property
    def twist(self) -> Twist:
        """The motion in the body's frame."""
        return Twist(self.ahead_mps, self.left_mps, self.turn_rad_s)


@valueclass(frozen=True, slots=True)
class State:
    """State of the wheels."""

    ahead_mps: float
    left_mps: float
    turn_rad_s: float
