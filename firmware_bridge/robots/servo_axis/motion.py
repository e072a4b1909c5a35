"""The motion of one axis, in its unit: rad or m."""

from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class AxisMotion:
    """A motion: the operator's command, the permitted one, or the bridge's set-point."""

    speed: float = 0.0
    """In a second: with a sign where there is no target, else the speed towards it."""
    target: float | None = None
    """Where to go; None: wherever `speed` leads."""


@valueclass(frozen=True, slots=True)
class AxisState:
    """What is reported of the axis."""

    position: float | None
    """None before its first report."""
    speed: float
    """In a second."""
