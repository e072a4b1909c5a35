"""The climber's motion in its own terms, and the state of its body; ahead and left are positive."""

from firmware_bridge import renamed
from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class ClimberMotion:
    """A motion: the operator's command, the permitted one, or the bridge's set-point."""

    speed_mps: float = 0.0
    """Of the middle between the wheels; ahead, the caster trails."""
    turn_rad_s: float = 0.0
    path_s: float | None = None
    """Progress of a path follower on its path, in the path's own seconds; None without one."""


@valueclass(frozen=True, slots=True)
class ClimberState:
    """State of wheels and joint."""

    speed_mps: float
    turn_rad_s: float
    joint_rad: float | None = None
    """The right half against the left, 0 where both are flat; None where its sensor is silent."""
    on_wall: float | None = None
    """The share of its magnets that are on the wall; None without a measurement."""


__getattr__ = renamed.module(__name__, __name__, Motion="ClimberMotion", State="ClimberState")
