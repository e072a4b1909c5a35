"""RARS's motion in its own terms, and the state of its body; forward, left and up are positive."""

from firmware_bridge import renamed
from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class RarsMotion:
    """A motion: the operator's command, the permitted one, or the bridge's set-point."""

    speed_mps: float = 0.0
    """Of the rear axle's middle."""
    steer_rad: float | None = None
    """Angle of the inner front wheel; its sign is the side of the turn. None: it stays where it is."""
    lift_m: float | None = None
    """Height above collapsed to go to; None leaves it to `lift_rate_mps`."""
    lift_rate_mps: float = 0.0
    headlamp: bool = False
    detector: bool = False


@valueclass(frozen=True, slots=True)
class RarsState:
    """State by axes and sensors."""

    steer_rad: float | None
    """Actual angle of the inner front wheel; None while it is unknown."""
    lift_m: float | None
    """Actual height above collapsed; None while it is unknown."""
    screw_rad_s: float | None
    """Actual speed of the lift's screw; None while it is unknown."""
    speed_mps: float
    """Actual speed of the rear axle's middle."""
    yaw_rate_rad_s: float
    tilt_rad: tuple[float, float] | None = None
    """Pitch, nose up, and roll, left side up; None while they are unknown, or no IMU is there."""
    margin_m: float | None = None
    """Of the zero-moment point inside the support at standstill, with the heaviest payload; None: unknown."""
    mass_kg: float | None = None
    """By currents and IMU; None: not known, or not measured."""


__getattr__ = renamed.module(__name__, __name__, Motion="RarsMotion", State="RarsState")
