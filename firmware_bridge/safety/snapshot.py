"""Everything the bridge knows at one instant, fixed; what is judged, reported and recorded.

Both snapshots write out how they are made, as `firmware_bridge.packet` does: there are six in every cycle,
and a frozen dataclass takes four times as long to make, fifteen times where this module is compiled.
"""

from dataclasses import dataclass
from typing import Final

from firmware_bridge.intent import Intent
from firmware_bridge.motion.odometry import Pose
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.cia402 import State


@dataclass(init=False, slots=True, unsafe_hash=True)
class DriveSnapshot:
    """What is known of one drive."""

    axis: Final[str]
    """The axis's name in the robot file."""
    node: Final[int]
    state: Final[State | None]
    """None before the first statusword."""
    heard_at: Final[Nanoseconds]
    """When any frame of the drive last arrived; `firmware_bridge.intent.NEVER_HEARD` before the first."""
    position_qc: Final[int]
    speed_rad_s: Final[float]
    """Behind the gear; positive moves forward, to the left, or up."""
    current_ma: Final[int]
    fault: Final[int]
    """Code of the newest emergency; 0 where there is none."""

    def __init__(  # noqa: PLR0917 - in the order of its fields
        self,
        axis: str,
        node: int,
        state: State | None,
        heard_at: Nanoseconds,
        position_qc: int,
        speed_rad_s: float,
        current_ma: int,
        fault: int,
    ) -> None:
        self.axis = axis
        self.node = node
        self.state = state
        self.heard_at = heard_at
        self.position_qc = position_qc
        self.speed_rad_s = speed_rad_s
        self.current_ma = current_ma
        self.fault = fault


@dataclass(init=False, slots=True, unsafe_hash=True)
class Snapshot:
    """The whole robot at `now`. What an interlock decided is not in it: that is the gate's ruling."""

    now: Final[Nanoseconds]
    intent: Final[Intent]
    armed: Final[bool]
    emergency_stopped: Final[bool]
    """The latch of the emergency stop, set until it is cleared."""
    drives: Final[tuple[DriveSnapshot, ...]]
    steer_rad: Final[float | None]
    """Actual angle of the inner front wheel, left positive; None while it is unknown."""
    lift_m: Final[float | None]
    """Actual height above collapsed; None while it is unknown."""
    speed_mps: Final[float]
    """Actual speed of the rear axle's middle, forward positive."""
    yaw_rate_rad_s: Final[float]
    pose: Final[Pose]
    demanded_speed_mps: Final[float]
    """The base speed that the bridge's newest set-points ask for, behind the ramp."""
    battery_v: Final[float | None]
    link_lost: Final[str | None]
    """Why no drive can be reached; None while the link to them stands."""

    def __init__(
        self,
        *,
        now: Nanoseconds,
        intent: Intent,
        armed: bool,
        emergency_stopped: bool,
        drives: tuple[DriveSnapshot, ...],
        steer_rad: float | None,
        lift_m: float | None,
        speed_mps: float,
        yaw_rate_rad_s: float,
        pose: Pose,
        demanded_speed_mps: float,
        battery_v: float | None,
        link_lost: str | None = None,
    ) -> None:
        self.now = now
        self.intent = intent
        self.armed = armed
        self.emergency_stopped = emergency_stopped
        self.drives = drives
        self.steer_rad = steer_rad
        self.lift_m = lift_m
        self.speed_mps = speed_mps
        self.yaw_rate_rad_s = yaw_rate_rad_s
        self.pose = pose
        self.demanded_speed_mps = demanded_speed_mps
        self.battery_v = battery_v
        self.link_lost = link_lost


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
