"""The climber's motion in its own words, and what is known of its body; ahead and left are positive."""

from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class Motion:
    """What the operator commands, what the gate allows, and what the bridge demands."""

    speed_mps: float = 0.0
    """Of the middle between the wheels; ahead, the caster trails."""
    turn_rad_s: float = 0.0
    path_s: float | None = None
    """How far a guide is on its path, in the path's own seconds; None where no one guides."""


@valueclass(frozen=True, slots=True)
class State:
    """What wheels and joint tell."""

    speed_mps: float
    turn_rad_s: float
    joint_rad: float | None = None
    """The right half against the left, 0 where both are flat; None where its sensor is silent."""
    on_wall: float | None = None
    """The share of its magnets that are on the wall; None where no one tells."""
