"""What the operator wants, in the robot's words, before anything has judged it."""

from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.units import NEVER, Nanoseconds

NEVER_HEARD: Final[Nanoseconds] = -NEVER


@dataclass(frozen=True, slots=True)
class Intent:
    """The newest wish for motion, and when it came; forward and left are positive."""

    speed_mps: float = 0.0
    steer_rad: float = 0.0
    """Angle of the inner front wheel; its sign is the side of the turn."""
    lift_m: float | None = None
    """Height above collapsed to go to; None leaves it to `lift_rate_mps`."""
    lift_rate_mps: float = 0.0
    headlamp: bool = False
    detector: bool = False
    heard_at: Nanoseconds = NEVER_HEARD
    """When the newest motion command arrived; `NEVER_HEARD` before the first."""


@dataclass(frozen=True, slots=True)
class Arm:
    """Ask for leave to move."""


@dataclass(frozen=True, slots=True)
class Disarm:
    """Give up the leave to move; forced: take the power off the motors at once."""

    force: bool = False


@dataclass(frozen=True, slots=True)
class EmergencyStop:
    """Stop and latch; final: only a restart of the bridge clears it."""

    final: bool = False


@dataclass(frozen=True, slots=True)
class ClearEmergencyStop:
    """Let go of a latched emergency stop; the robot stays disarmed."""


@dataclass(frozen=True, slots=True)
class ResetOdometry:
    """Make the present place the origin."""


Request: TypeAlias = Arm | Disarm | EmergencyStop | ClearEmergencyStop | ResetOdometry


@dataclass(frozen=True, slots=True)
class Verdict:
    """The bridge's answer to a request, with the reason for people."""

    accepted: bool
    reason: str
    temporary: bool = False
    """A refusal that the same request may outlive, for instance while a drive is being enabled again."""
