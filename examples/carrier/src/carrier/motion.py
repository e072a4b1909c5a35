"""The robot's motion in its own words, and what is known of its body; forward and left are positive."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Motion:
    """What the operator commands, what the gate allows, and what the bridge demands."""

    speed_mps: float = 0.0
    """Of the axle's middle."""
    turn_rad_s: float = 0.0
    lamp: bool = False


@dataclass(frozen=True, slots=True)
class State:
    """What the wheels tell."""

    speed_mps: float
    turn_rad_s: float
