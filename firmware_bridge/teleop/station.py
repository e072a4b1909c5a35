"""A robot's place on MAVLink as rows of its own words; nothing of the protocol is in them.

Signs are the robot's: forward, left, up and counter-clockwise positive; `firmware_bridge.teleop` turns them
into MAVLink's, and only there.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Generic, TypeVar

from firmware_bridge.robot import AnyRobot, Robot
from firmware_bridge.robot.table import Table
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import Nanoseconds

G = TypeVar("G", bound=Table)
M = TypeVar("M")
S = TypeVar("S")


@dataclass(frozen=True, slots=True)
class Stick:
    """The axes of MANUAL_CONTROL as shares of full stick, -1 to 1; None where an axis is not used."""

    forward: float | None
    """x, forward positive."""
    left: float | None
    """r, or y where r is not used; to the left positive."""
    up: float | None
    """z, while the button that the station's row names is held, and beyond its dead band."""


@dataclass(frozen=True, slots=True)
class Velocity:
    """A velocity set-point along and across the robot, and how fast it shall turn; SI, left positive."""

    forward_mps: float
    left_mps: float
    yaw_rate_rad_s: float | None
    """None where the message leaves it out."""


@dataclass(frozen=True, slots=True)
class Twist:
    """How the robot's reference point moves; SI, left and counter-clockwise positive."""

    forward_mps: float
    left_mps: float
    yaw_rate_rad_s: float


@dataclass(frozen=True, slots=True)
class Unusable:
    """Why a message is no wish; `key` is the same for the same kind of fault."""

    key: str
    reason: str


class Switch(Generic[M]):
    """Something that the operator switches: by a button, a relay's number, or the headlamp's own command."""

    __slots__ = ("button", "illuminates", "name", "read", "relay", "telemetry", "write")

    def __init__(
        self,
        name: str,
        *,
        read: Callable[[M], bool],
        write: Callable[[M, bool], M],
        relay: int,
        button: int | None = None,
        illuminates: bool = False,
        telemetry: str = "",
    ) -> None:
        self.name: Final = name
        self.read: Final = read
        self.write: Final = write
        self.relay: Final = relay
        """Its number in DO_SET_RELAY."""
        self.button: Final = button
        """The button of MANUAL_CONTROL that switches it over, counted from 0; None for none."""
        self.illuminates: Final = illuminates
        """Whether ILLUMINATOR_ON_OFF switches it."""
        self.telemetry: Final = telemetry
        """The NAMED_VALUE_INT that tells of it, at most 10 letters; empty for none."""


class Actuator(Generic[G, M]):
    """Something that goes to a share of its travel by DO_SET_ACTUATOR: -1 at its lowest end, 1 at its highest."""

    __slots__ = ("name", "send")

    def __init__(self, name: str, send: Callable[[M, float, Robot[G]], M]) -> None:
        self.name: Final = name
        self.send: Final = send
        """Return the wish with this share, 0 to 1, of the travel."""


class Value(Generic[M, S]):
    """A NAMED_VALUE_FLOAT that is sent by the clock."""

    __slots__ = ("name", "period", "read", "tells")

    def __init__(
        self, name: str, period: Nanoseconds, read: Callable[[Snapshot[M, S]], float | None], tells: str
    ) -> None:
        self.name: Final = name
        """At most 10 letters."""
        self.period: Final = period
        self.read: Final = read
        """Return the value, or None while it is not known."""
        self.tells: Final = tells
        """What it is, with its unit."""


@dataclass(frozen=True, slots=True)
class Fixed:
    """A read-only parameter: a number of the robot file."""

    name: str
    """At most 16 letters."""
    value: Callable[[AnyRobot], float]
    unit: str


class Station(Generic[G, M, S]):
    """One kind of robot's rows."""

    __slots__ = (
        "actuators", "dead_band", "forgotten", "largest", "lift_button", "parameters", "stick", "stop_button",
        "switches", "target", "twist", "values",
    )  # fmt: skip

    def __init__(
        self,
        *,
        stick: Callable[[Stick, M, Robot[G]], M],
        target: Callable[[Velocity, M, Robot[G]], M | Unusable],
        twist: Callable[[S], Twist],
        forgotten: Callable[[M], M],
        largest: Callable[[Robot[G]], Velocity],
        stop_button: int | None = None,
        lift_button: int | None = None,
        dead_band: float = 0.05,
        switches: tuple[Switch[M], ...] = (),
        actuators: tuple[Actuator[G, M], ...] = (),
        values: tuple[Value[M, S], ...] = (),
        parameters: tuple[Fixed, ...] = (),
    ) -> None:
        self.stick: Final = stick
        """Return the wish after the one before, for these axes."""
        self.target: Final = target
        """Return the wish for a velocity, or why this robot cannot mean it."""
        self.twist: Final = twist
        self.forgotten: Final = forgotten
        """Return what of a wish outlives a change of state: a target that was kept would act unasked later."""
        self.largest: Final = largest
        """The robot's limits as a velocity: ten times more is absurd, and refused as no wish at all."""
        self.stop_button: Final = stop_button
        """The button of MANUAL_CONTROL that is the emergency stop, counted from 0; None for none."""
        self.lift_button: Final = lift_button
        """The button without which z counts for nothing; None: z counts always."""
        self.dead_band: Final = dead_band
        """Of z; a hand that rests on a stick does not hold it at zero."""
        self.switches: Final = switches
        self.actuators: Final = actuators
        """By DO_SET_ACTUATOR's parameters 1, 2, ... of set 0."""
        self.values: Final = values
        self.parameters: Final = parameters
