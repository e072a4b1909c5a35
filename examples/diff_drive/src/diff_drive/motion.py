"""The robot's motion in its own words, and what is known of its body; forward and left are positive."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Motion:
    """The operator's command, the motion that the gate allows, and the bridge's set-point."""

    speed_mps: float = 0.0
    """Of the axle's middle."""
    turn_rad_s: float = 0.0
    lamp: bool = False


@dataclass(frozen=True, slots=True)
class State:
    """State of the wheels."""

    speed_mps: float
    turn_rad_s: float
