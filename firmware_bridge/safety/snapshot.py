"""Everything the bridge knows at one instant, frozen; what is judged, reported and recorded."""

from dataclasses import dataclass

from firmware_bridge.intent import Intent
from firmware_bridge.motion.odometry import Pose
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.cia402 import State


@dataclass(frozen=True, slots=True)
class DriveSnapshot:
    """What is known of one drive."""

    axis: str
    """The axis's name in the robot file."""
    node: int
    state: State | None
    """None before the first statusword."""
    heard_at: Nanoseconds
    """When any frame of the drive last arrived; `firmware_bridge.intent.NEVER_HEARD` before the first."""
    position_qc: int
    speed_rad_s: float
    """Behind the gear; positive moves forward, to the left, or up."""
    current_ma: int
    fault: int
    """Code of the newest emergency; 0 where there is none."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The whole robot at `now`. What an interlock decided is not in it: that is the gate's ruling."""

    now: Nanoseconds
    intent: Intent
    armed: bool
    emergency_stopped: bool
    """The latch of the emergency stop, set until it is cleared."""
    drives: tuple[DriveSnapshot, ...]
    steer_rad: float | None
    """Actual angle of the inner front wheel, left positive; None while it is unknown."""
    lift_m: float | None
    """Actual height above collapsed; None while it is unknown."""
    speed_mps: float
    """Actual speed of the rear axle's middle, forward positive."""
    yaw_rate_rad_s: float
    pose: Pose
    demanded_speed_mps: float
    """The base speed that the bridge's newest set-points ask for, behind the ramp."""
    battery_v: float | None
    link_lost: str | None = None
    """Why no drive can be reached; None while the link to them stands."""


@dataclass(frozen=True, slots=True)
class Hold:
    """One interlock that holds the robot back now, in words for people."""

    name: str
    """Stable key, for instance "lift extended"."""
    reason: str
    """What holds, with the numbers at the time it began."""
    remedy: str
    """What to do so that it lets go."""
    since: Nanoseconds
