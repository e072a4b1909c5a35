"""One axis's limits in its robot file."""

from firmware_bridge.robot.table import Positive, Table


class AxisLimits(Table):
    """The limits that the interlocks enforce, whatever the operator commands; in the axis's unit."""

    speed: Positive
    """In a second: by stick, by velocity, and towards a target."""
    acceleration: Positive
    """In a second squared, of the set-points; by position an axis halts by its drive's own ramp."""


class AxisGeometry(Table):
    """The axis's part of a robot file beside its drive."""

    limits: AxisLimits
