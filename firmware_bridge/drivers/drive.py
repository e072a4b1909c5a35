"""A drive as the bridge sees it, whatever protocol it speaks: demands in, what it told out.

No base class: a driver is anything that has these methods. It refuses to know why a demand is made.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Protocol, TypeAlias

from firmware_bridge.intent import NEVER_HEARD
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.cia402 import State


@dataclass(frozen=True, slots=True)
class Speed:
    """Turn at this speed; for velocity axes."""

    rad_s: float
    """Behind the gear; positive moves forward."""


@dataclass(frozen=True, slots=True)
class Position:
    """Go to this position; for position axes."""

    quadcounts: int


class Stop(Enum):
    """Demands that end motion, from the gentlest on."""

    REST = "rest"
    """Ramp down with the profile's deceleration and hold still with power on: the safe demand."""
    QUICK_STOP = "quick stop"
    """Ramp down with the quick stop's deceleration and hold still until enabled again."""
    POWER_OFF = "power off"
    """No torque from now on: the shaft coasts."""


Demand: TypeAlias = Speed | Position | Stop


class Task(Enum):
    """A step of the drive's way to power and back; all drives take one before any takes the next."""

    FIND = "find"
    """Make the drive listen, and wait until it answers."""
    IDENTIFY = "check identity"
    CONFIGURE = "configure"
    """Bring it to rest without power, write the set-up, and read back what safety hangs on."""
    START = "start"
    """Let process data flow, and wait until the drive tells its state and position."""
    ENABLE = "enable"
    """Reset a fault if there is one, and put power on."""
    LEAVE = "leave"
    """Take the power off, and end the watch over the bridge's heartbeat. This task never fails."""


BRING_UP = (Task.FIND, Task.IDENTIFY, Task.CONFIGURE, Task.START, Task.ENABLE)


class StartupError(Exception):
    """A drive that is missing, or refuses: which, what was expected, what came."""

    def __init__(self, axis: Axis, problem: str) -> None:
        super().__init__(axis.name, problem)
        self.axis = axis
        self.problem = problem

    def __str__(self) -> str:
        """Say it in one line."""
        return f"drive {self.axis.node} ({self.axis.title}): {self.problem}"


@dataclass(slots=True)
class Heard:
    """What a drive has told, newest first thing only."""

    state: State | None = None
    """None while it is unknown, or the drive does not listen to set-points."""
    statusword: int = 0
    heard_at: Nanoseconds = NEVER_HEARD
    """When the newest sample of state and position arrived; a heartbeat alone proves no position."""
    sampled_at: Nanoseconds = NEVER_HEARD
    """The begin of the cycle, on CAN the SYNC, at which that sample was taken."""
    position_qc: int = 0
    speed_rad_s: float = 0.0
    """Behind the gear, the mean between the last two samples."""
    current_ma: int = 0
    fault: int = 0
    """Code of the newest emergency; 0 where there is none, or it was reset."""
    operational: bool = False
    """Whether the drive listens to set-points."""
    restarted: bool = False
    """Whether it booted since it was found: its set-up is lost."""
    analogue_mv: int | None = None
    """The newest analogue reading that was asked for."""


class Drive(Protocol):
    """One drive; what a method returns is to be sent."""

    @property
    def axis(self) -> Axis:
        """The axis that it moves."""

    @property
    def heard(self) -> Heard:
        """What it has told."""

    @property
    def busy(self) -> bool:
        """Whether tasks are under way."""

    @property
    def failure(self) -> StartupError | None:
        """Why the last tasks failed; None where they did not."""

    @property
    def configured(self) -> bool:
        """Whether its set-up is in force; not after it restarted."""

    @property
    def wake_at(self) -> Nanoseconds:
        """When it wants to be woken."""

    def begin(self, tasks: tuple[Task, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Do these tasks in order, in place of those under way."""

    def command(self, demand: Demand) -> tuple[Packet, ...]:
        """Send a demand; while tasks are under way only one that ends them: quick stop or power off."""

    def release(self) -> tuple[Packet, ...]:
        """End a set-point's handshake, where the drive has one; due half a cycle after `command`."""

    def synchronised(self, now: Nanoseconds) -> None:
        """Learn that a cycle begins now: the next sample is of this instant."""

    def measure(self, analogue_input: int, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask for an analogue reading when nothing else is under way; it comes in `heard.analogue_mv`."""

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
