"""ROME's motion in its own terms, and the state of its body; ahead, left, counter-clockwise positive."""

from firmware_bridge import renamed
from firmware_bridge.motion.omni import BodyTwist
from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class RomeMotion:
    """A motion: the operator's command, the permitted one, or the bridge's set-point."""

    ahead_mps: float = 0.0
    left_mps: float = 0.0
    turn_rad_s: float = 0.0
    path_s: float | None = None
    """Progress of a path follower on its path, in the path's own seconds; None without one."""

    @property
    def twist(self) -> BodyTwist:
        """The motion in the body's frame."""
        return BodyTwist(self.ahead_mps, self.left_mps, self.turn_rad_s)


@valueclass(frozen=True, slots=True)
class RomeState:
    """State of the wheels."""

    ahead_mps: float
    left_mps: float
    turn_rad_s: float


__getattr__ = renamed.module(__name__, __name__, Motion="RomeMotion", State="RomeState")
