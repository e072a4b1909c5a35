"""Where a robot is on its plane."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Pose:
    """The robot's reference point: x forward and y left of the start, heading counter-clockwise, not wrapped."""

    x_m: float = 0.0
    y_m: float = 0.0
    heading_rad: float = 0.0
