"""A device as the bridge sees it, by any protocol: set-points in, feedback out; SI units behind the gear.

No base class: a driver is anything that has these methods. The reason of a set-point is not known here.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, Protocol, TypeAlias

from firmware_bridge import renamed
from firmware_bridge.drivers.life_cycle import DriverState, Task, Transition
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis, Output, Sensor
from firmware_bridge.units import Nanoseconds
from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class Speed:
    """Move at this speed, in the axis's unit a second; for axes that are commanded by speed."""

    value: float
    braking: float = 1.0
    """Share of its quick stop's deceleration, above 0 to 1, with which its device brakes by itself then.

    Only where the robot file lets it be lowered; elsewhere it counts for nothing.
    """


@valueclass(frozen=True, slots=True)
class Position:
    """Go to this position, in the axis's unit; for axes that are commanded by position."""

    value: float


@valueclass(frozen=True, slots=True)
class Level:
    """Switch an output."""

    on: bool


@dataclass(frozen=True, slots=True)
class Homed:
    """Go on homing: the device moves by itself, and is sent nothing."""


class Stop(Enum):
    """Set-points that end motion, from the gentlest on."""

    STANDSTILL = "standstill"
    """Ramp down with the profile's deceleration and hold still with power on: the safe set-point."""
    QUICK_STOP = "quick stop"
    """Ramp down with the quick stop's deceleration and hold still until enabled again."""
    POWER_OFF = "power off"
    """No torque from now on: the shaft coasts."""


SetPoint: TypeAlias = Speed | Position | Homed | Stop


class StartupError(Exception):
    """A device that is missing, or refuses: which, what was expected, what came."""

    def __init__(self, axis: Axis, problem: str) -> None:
        super().__init__(axis.name, problem)
        self.axis = axis
        self.problem = problem

    def __str__(self) -> str:
        """Say it in one line."""
        return f"{self.axis.called}: {self.problem}"


class Power(Enum):
    """Power state of a device, one of five that every device has."""

    UNKNOWN = "unknown"
    """It has reported nothing, or receives no set-points."""
    OFF = "off"
    STOPPED = "stopped"
    """It has stopped by itself, or by a quick stop, and needs to be enabled again."""
    ON = "on"
    """It follows set-points."""
    FAULT = "fault"


class Reports(Enum):
    """Reports of a driver's devices; an interlock that needs a missing one is replaced by a weaker one."""

    POWER = "power"
    POSITION = "position"
    VELOCITY = "velocity"
    CURRENT = "current"
    STOP = "stop"
    """Their standstill after a stop command."""
    ZERO = "zero"
    """Validity of the reference from which they count."""


@valueclass(frozen=True, slots=True)
class Feedback:
    """Known state of one axis, behind its gear; positive as the robot file's `direction` makes it."""

    axis: str
    power: Power = Power.UNKNOWN
    received_at: Nanoseconds = NEVER_RECEIVED
    """Arrival of the newest sample of state and position; a heartbeat alone proves no position."""
    sampled_at: Nanoseconds = NEVER_RECEIVED
    """The begin of the cycle, on CAN the SYNC, at which that sample was taken."""
    position: float = 0.0
    """In the axis's unit, counted on across the wrap of the device's own counter."""
    velocity: float = 0.0
    """In the axis's unit a second, the mean between the last two samples."""
    current_a: float | None = None
    """None where the device does not measure it."""
    current_at: Nanoseconds = NEVER_RECEIVED
    """Arrival of the newest current; it may come less often than samples do."""
    fault: str = ""
    """The device's code of its newest fault; empty where there is none, or it was reset."""
    text: str = ""
    """The device's own name of its state; empty while it is unknown."""
    reference_lost: bool = False
    """True where it reported this or a restart, and was not referenced since.

    A driver whose device does not report it begins with True.
    """
    rewritten: str = ""
    """Foreign writes to its objects since it was set up; empty where none was received."""


class Between(NamedTuple):
    """A position that an axis has sent with a sample, or between two."""

    at: Nanoseconds
    """Its arrival."""
    position: float
    """In the axis's unit."""
    ahead: float
    """Where the axis will be when the axes that it leads have followed, by the robot file's lead."""


@valueclass(frozen=True, slots=True)
class SeenPose:
    """Pose of the robot as seen by a sensor, in axes of its own with z upwards."""

    position: tuple[float, float, float]
    """m."""
    attitude: tuple[float, float, float, float]
    """The quaternion x, y, z, w."""
    heading_rad: float
    """Counter-clockwise from x, from -pi to pi."""
    jumps: int
    """Count of sightings at places that the robot cannot have reached."""


@valueclass(frozen=True, slots=True)
class Reading:
    """A sensor's report."""

    value: float
    """The value; of a pose, its error in m as reported by its sensor."""
    sampled_at: Nanoseconds
    """The instant that it shows."""
    received_at: Nanoseconds
    pose: SeenPose | None = None
    """Of a sensor that sees where the robot is."""


class Driver(Protocol):
    """One device that moves an axis; what a method returns is to be sent."""

    @property
    def axis(self) -> Axis:
        """The axis that it moves."""

    @property
    def reports(self) -> frozenset[Reports]:
        """Reports of its device."""

    @property
    def feedback(self) -> Feedback:
        """The state that it has reported."""

    @property
    def sampled_at(self) -> Nanoseconds:
        """The same as in `feedback`; read after every packet."""

    @property
    def between(self) -> Between | None:
        """Its newest position where it sends some between samples; None where it sends none."""

    @property
    def state(self) -> DriverState:
        """Its place in the life cycle: `firmware_bridge.drivers.life_cycle.TABLE`."""

    @property
    def failure(self) -> StartupError | None:
        """The failure, or the refusal, of the last transition; None without one."""

    @property
    def unpowered(self) -> bool:
        """True where its newest report shows no torque; not once power was requested."""

    @property
    def wake_at(self) -> Nanoseconds:
        """Time of its next wake-up."""

    def begin(self, transition: Transition, now: Nanoseconds, task: Task | None = None) -> tuple[Packet, ...]:
        """Begin a transition, or only that one of its tasks, in place of what is under way."""

    def set_zero(self, position: float, now: Nanoseconds) -> tuple[Packet, ...]:
        """Begin `Transition.SET_ZERO`: the axis stands at this position, in its unit."""

    def command(self, set_point: SetPoint) -> tuple[Packet, ...]:
        """Send a set-point; one that moves an axis which was not activated, or failed since, is standstill.

        While tasks run only quick stop or power off is sent, and rest to one that homes. Those end the
        tasks, unless they stop the device themselves.
        """

    def release(self) -> tuple[Packet, ...]:
        """End a set-point's handshake, where the device has one; due half a cycle after `command`."""

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""


class SensorDriver(Protocol):
    """A sensor beside the axes."""

    @property
    def sensor(self) -> Sensor:
        """Its table in the robot file."""

    @property
    def reading(self) -> Reading | None:
        """Its last report; None where there is none, or where it reports that it has no value."""

    def measure(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask it."""


class OutputDriver(Protocol):
    """Outputs of one device, which are switched together."""

    @property
    def outputs(self) -> tuple[Output, ...]:
        """Their tables in the robot file."""

    def switch(self, levels: Mapping[str, Level], now: Nanoseconds) -> tuple[Packet, ...]:
        """Bring each named output to its level, unless the device has confirmed it already."""


__getattr__ = renamed.module(__name__, __name__, Demand="SetPoint", Tells="Reports")
