"""The operator's actions and the received reports, in order; and the odometry as the operator received it."""

import math
from dataclasses import dataclass, field
from enum import StrEnum

from firmware_bridge.mavlink.frames import Message
from firmware_bridge.units import Nanoseconds


class Subject(StrEnum):
    """Subject of an entry."""

    STEP = "step"
    """The mission's step of this title began."""
    REPORTED = "reported"
    """A STATUSTEXT."""
    ANSWERED = "answered"
    """A COMMAND_ACK."""
    UNANSWERED = "unanswered"
    """A command that was given up."""
    STATUS = "status"
    """Armed or disarmed, by the robot's heartbeat."""


@dataclass(frozen=True, slots=True)
class LogEntry:
    """One line of the diary."""

    at: Nanoseconds
    kind: Subject
    text: str
    severity: int | None = None
    """MAV_SEVERITY of a text."""


@dataclass(frozen=True, slots=True)
class OdometryEntry:
    """One ODOMETRY, turned back into the robot's words: left and counter-clockwise positive."""

    received_at: Nanoseconds
    measured_at: Nanoseconds
    x_m: float
    y_m: float
    heading_rad: float
    speed_mps: float
    yaw_rate_rad_s: float


def place_of(message: Message, now: Nanoseconds) -> OdometryEntry:
    """Read an ODOMETRY message."""
    # MAVLink's frame is NED: y to the right, turns clockwise. The quaternion is that of a level robot.
    w, _, _, z = message.q
    return OdometryEntry(
        received_at=now,
        measured_at=message.time_usec * 1000,
        x_m=message.x,
        y_m=-message.y,
        heading_rad=-2.0 * math.atan2(z, w),
        speed_mps=message.vx,
        yaw_rate_rad_s=-message.yawspeed,
    )


@dataclass(slots=True)
class Diary:
    """Record of one operator's whole run."""

    entries: list[LogEntry] = field(default_factory=list)
    odometry: list[OdometryEntry] = field(default_factory=list)
    values: dict[str, float] = field(default_factory=dict)
    """The newest of each named value and parameter."""
    parameters: dict[str, float] = field(default_factory=dict)
    armed: bool | None = None
    """Armed state; None before the robot's first heartbeat."""
    status: int = 0
    """MAV_STATE."""

    def note(self, at: Nanoseconds, kind: Subject, text: str, severity: int | None = None) -> None:
        """Add a line."""
        self.entries.append(LogEntry(at, kind, text, severity))

    def texts(self, kind: Subject) -> list[str]:
        """Return the texts of one kind, in order."""
        return [entry.text for entry in self.entries if entry.kind is kind]
