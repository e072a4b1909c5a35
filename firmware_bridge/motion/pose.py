"""Pose of a robot on its plane."""

from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class Pose:
    """Of the robot's reference point: x forward, y left, heading counter-clockwise and not wrapped."""

    x_m: float = 0.0
    y_m: float = 0.0
    heading_rad: float = 0.0
