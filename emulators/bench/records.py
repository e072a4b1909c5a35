"""What a bench run leaves in memory: one row every 10 ms, and every hold from its beginning to its end.

These rows refuse to know how they are taken and what is drawn from them.
"""

from dataclasses import dataclass
from typing import Final, NamedTuple

from firmware_bridge.units import MILLISECOND, Nanoseconds

SAMPLE_EVERY: Final[Nanoseconds] = 10 * MILLISECOND


class Sample(NamedTuple):
    """The plant's truth at one instant, beside what the bridge demanded and believed.

    A tuple, because a hundred of them are taken in each simulated second.
    """

    at: Nanoseconds
    x_m: float
    """Rear axle's middle, in the frame in which the run began."""
    y_m: float
    heading_rad: float
    """Counter-clockwise from x."""
    speed_mps: float
    """Forward speed of the rear axle's middle."""
    yaw_rate_rad_s: float
    steer_rad: float
    """Angle of the inner front wheel; left is positive."""
    lift_m: float
    """Height above collapsed."""
    currents_a: tuple[float, ...]
    """Motor currents, in the order of the robot's axes."""
    motor_speeds_rad_s: tuple[float, ...]
    """Motor shafts, in the order of the robot's axes."""
    demanded_speed_mps: float
    """What the bridge asks of the wheels, after its interlocks."""
    armed: bool
    odometry_x_m: float
    """Where the bridge believes it is, in the frame in which it began."""
    odometry_y_m: float
    odometry_heading_rad: float


@dataclass(frozen=True, slots=True)
class FaultRecord:
    """One fault from the instant at which it was put on to the instant at which it was taken off."""

    kind: str
    title: str
    nodes: tuple[str, ...]
    """Whom it could meet."""
    began: Nanoseconds
    ended: Nanoseconds | None = None
    """The same instant for a fault that has no length; None where it was still on when the run was over."""


@dataclass(frozen=True, slots=True)
class HoldRecord:
    """One interlock from the instant at which it held to the instant at which it let go."""

    name: str
    reason: str
    began: Nanoseconds
    ended: Nanoseconds | None = None
    """None where it still held when the run was over."""
