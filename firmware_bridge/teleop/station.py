"""A robot's MAVLink rows in its own terms; nothing of the protocol is in them.

Signs are the robot's: forward, left, up and counter-clockwise positive; `firmware_bridge.teleop` turns them
into MAVLink's, and only there. Rows that the protocol cannot carry are refused where they are made.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import KW_ONLY, dataclass
from enum import Enum
from typing import Any, Final, Generic, TypeAlias, TypeVar

from firmware_bridge import renamed
from firmware_bridge.robot import Robot
from firmware_bridge.robot.table import Table
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.value import valueclass

G = TypeVar("G", bound=Table)
M = TypeVar("M")
S = TypeVar("S")

BUTTONS: Final = 16
"""Number of buttons in MANUAL_CONTROL's first field."""
CHANNELS: Final = 18
"""Number of channels in RC_CHANNELS_OVERRIDE."""
ACTUATORS: Final = 6
"""Number of actuators of one DO_SET_ACTUATOR."""
VALUE_NAME: Final = 10
"""Letters of a NAMED_VALUE_FLOAT or NAMED_VALUE_INT."""
PARAMETER_NAME: Final = 16
FASTEST: Final[Nanoseconds] = 20 * MILLISECOND
"""Shortest period of a message, whatever a row or a ground station requests."""


@valueclass(frozen=True, slots=True)
class Stick:
    """The axes of MANUAL_CONTROL as shares of full stick, -1 to 1; None where an axis is not used."""

    forward: float | None
    """x, forward positive."""
    left: float | None
    """y, to the left positive."""
    turn: float | None
    """r, counter-clockwise positive."""
    up: float | None
    """z, where the station reads it, beyond its dead band; with an `up_button` from where it was pressed."""


@valueclass(frozen=True, slots=True)
class Velocity:
    """A velocity set-point along and across the robot, and how fast it shall turn; SI, left positive."""

    forward_mps: float
    left_mps: float
    yaw_rate_rad_s: float | None
    """None where the message leaves it out."""

    @property
    def deflected(self) -> str:
        """Its command, and the message to send first where it does not count yet; empty at standstill."""
        if self.forward_mps == self.left_mps == 0.0 and not self.yaw_rate_rad_s:
            return ""
        speed = math.hypot(self.forward_mps, self.left_mps)
        turn = f", {self.yaw_rate_rad_s:.2f} rad/s" if self.yaw_rate_rad_s else ""
        return f"a velocity of {speed:.2f} m/s{turn} is commanded: send zero first"


@valueclass(frozen=True, slots=True)
class Place:
    """A place to go to, of a robot with one axis; in the axis's unit."""

    x: float

    @property
    def deflected(self) -> str:
        """Its command, and the message to send first where it does not count yet."""
        return f"the place {self.x:.4g} is commanded: send a velocity of zero first"


Motion: TypeAlias = Stick | Velocity | Place


@valueclass(frozen=True, slots=True)
class Twist:
    """Motion of the robot's reference point; SI, left and counter-clockwise positive."""

    forward_mps: float
    left_mps: float
    yaw_rate_rad_s: float


@dataclass(frozen=True, slots=True)
class Unusable:
    """The reason why a message gives no command; `key` is the same for the same fault."""

    key: str
    reason: str


class StickAxis(Enum):
    """An axis of `Stick`."""

    FORWARD = 1
    LEFT = 2
    TURN = 3
    UP = 4


@dataclass(frozen=True, slots=True)
class Channel:
    """One channel of a radio control, which RC_CHANNELS_OVERRIDE carries: 1000 to 2000 us, 1500 neutral."""

    number: int
    """Counted from 1."""
    axis: StickAxis
    sign: int
    """1 where more microseconds are forward, left or counter-clockwise."""


USUAL_AXES: Final = (StickAxis.FORWARD, StickAxis.LEFT, StickAxis.TURN)
"""Neutral at 0, as a stick is that springs back."""
USUAL_CHANNELS: Final = (
    Channel(1, StickAxis.TURN, -1),
    Channel(3, StickAxis.FORWARD, 1),
    Channel(4, StickAxis.LEFT, -1),
)
"""As ArduPilot's Rover has them: 1 steers to the right, 3 is the throttle, 4 goes to the right."""


@dataclass(frozen=True)
class Switch(Generic[M]):
    """Something that the operator switches: by a button, a relay's number, or ILLUMINATOR_ON_OFF."""

    name: str
    _: KW_ONLY
    read: Callable[[M], bool]
    write: Callable[[M, bool], M]
    relay: int
    """Its number in DO_SET_RELAY."""
    button: int | None = None
    """The button of MANUAL_CONTROL that switches it over, counted from 0; None for none."""
    illuminates: bool = False
    """True where ILLUMINATOR_ON_OFF switches it."""
    telemetry: str = ""
    """The NAMED_VALUE_INT of its state, at most 10 letters; empty for none."""


@dataclass(frozen=True)
class Actuator(Generic[G, M]):
    """Something that goes to a share of its travel by DO_SET_ACTUATOR: -1 is its lower end, 1 its upper."""

    name: str
    send: Callable[[M, float, Robot[G]], M]
    """Return the command with this share, 0 to 1, of the travel."""


@renamed.arguments(tells="title")
@dataclass(frozen=True)
class Value(Generic[M, S]):
    """A NAMED_VALUE_FLOAT that is sent by the clock."""

    name: str
    """At most 10 letters."""
    period: Nanoseconds
    read: Callable[[Snapshot[M, S]], float | None]
    """Return the value, or None while it is not known."""
    title: str
    """Its name, with its unit."""


@dataclass(frozen=True)
class Margin(Generic[G, M, S]):
    """What a robot's stand or hold has to spare; its interlocks and limits keep the least of it.

    It is sent as MARGIN, and shown with its least.
    """

    read: Callable[[Robot[G], Snapshot[M, S]], float | None]
    """Return it, or None while it is not known."""
    least: Callable[[Robot[G]], float | None]
    """Return the least that is kept; None for a robot whose file has no data for it."""
    unit: str
    title: str


@dataclass(frozen=True)
class Fixed(Generic[G]):
    """A read-only parameter: a number of the robot file."""

    name: str
    """At most 16 letters."""
    value: Callable[[Robot[G]], float]
    unit: str


@dataclass(frozen=True)
class Gauge(Generic[G]):
    """Position of an axis as a person reads it off the robot; it grows or falls with the axis' position."""

    role: str
    unit: str
    reading: Callable[[float, Robot[G]], float]
    """Return it for a position of the axis."""
    position: Callable[[float, Robot[G]], float]
    """Return the axis's position for it."""


@renamed.arguments(metres_rolled="meters_rolled")
@dataclass(frozen=True, kw_only=True)
class StationRows(Generic[G, M, S]):
    """One robot type's rows; ValueError where MAVLink could not carry them."""

    stick: Callable[[Stick, M, Robot[G]], M]
    """Return the command after the one before, for these axes."""
    target: Callable[[Velocity, M, Robot[G]], M | Unusable]
    """Return the command for a velocity, or why this robot cannot mean it."""
    place: Callable[[Place, M, Robot[G]], M | Unusable] | None = None
    """Return the command for a place, or why this robot cannot mean it; None: it goes to no place."""
    twist: Callable[[S], Twist]
    forgotten: Callable[[M], M]
    """Return what of a command outlives a change of state: a target that is kept would act later."""
    largest: Callable[[Robot[G]], Twist]
    """The robot's limits: what is ten times faster is absurd, and refused altogether."""
    meters_rolled: Callable[[Robot[G]], float] | None = None
    """Meters rolled for each radian of a rolling axis, its radius; None: no distances are reported."""
    stop_button: int | None = None
    """The button of MANUAL_CONTROL that is the emergency stop, counted from 0; None for none."""
    up_button: int | None = None
    """The button without which z counts for nothing; while it is held, z counts from where it stood when it
    was pressed. None: z is neutral at 0, where it is among `axes`."""
    axes: tuple[StickAxis, ...] = USUAL_AXES
    """The axes of MANUAL_CONTROL that the robot reads: the others count for nothing, wherever they stand."""
    dead_band: float = 0.05
    """Largest z that counts as zero: a hand on a stick does not hold it there.

    A stick is neutral where no axis passes it.
    """
    channels: tuple[Channel, ...] = USUAL_CHANNELS
    """The channels of RC_CHANNELS_OVERRIDE in use; z, which needs a button, is not among them."""
    helm: bool = False
    """True where its operator has a helm, two pedals and a button that reverses; the live page shows them."""
    switches: tuple[Switch[M], ...] = ()
    actuators: tuple[Actuator[G, M], ...] = ()
    """In the order of DO_SET_ACTUATOR's parameters 1, 2, ... of set 0."""
    values: tuple[Value[M, S], ...] = ()
    margin: Margin[G, M, S] | None = None
    lifted: str = ""
    """Name of the value with the height in m to which it lifts a load; empty where it lifts none."""
    parameters: tuple[Fixed[G], ...] = ()
    gauges: tuple[Gauge[G], ...] = ()
    """Of axes whose place is read off in another way than the axis's own unit; others need no row."""

    def margin_of(self, robot: Robot[G]) -> Margin[G, M, S] | None:
        """Return the row of a robot's margin; None where its file has no data for it."""
        return None if self.margin is None or self.margin.least(robot) is None else self.margin

    def applied(self, motion: Motion, command: M, robot: Robot[G]) -> M | Unusable:
        """Return what a motion makes of the command before it; `Unusable` where it is none."""
        if isinstance(motion, Stick):
            return self.stick(motion, command, robot)
        if isinstance(motion, Velocity):
            return self.target(motion, command, robot)
        return (
            Unusable("place", "it goes to no place")
            if self.place is None
            else self.place(motion, command, robot)
        )

    def __post_init__(self) -> None:
        buttons = [button for button in (self.stop_button, self.up_button) if button is not None]
        buttons += [switch.button for switch in self.switches if switch.button is not None]
        named = [value.name for value in self.values] + [
            row.telemetry for row in self.switches if row.telemetry
        ]
        if self.lifted and self.lifted not in named:
            raise ValueError(f"station: lifted '{self.lifted}' is none of its values")
        _need_distinct("gauges", [gauge.role for gauge in self.gauges])
        _need_distinct("buttons", buttons)
        _need_distinct("relays", [switch.relay for switch in self.switches])
        _need_names("values", named, VALUE_NAME)
        _need_names("parameters", [row.name for row in self.parameters], PARAMETER_NAME)
        if not all(0 <= button < BUTTONS for button in buttons):
            raise ValueError(f"station: buttons are counted from 0 to {BUTTONS - 1}, not {buttons}")
        if self.up_button is not None and StickAxis.UP not in self.axes:
            raise ValueError("station: there is an up button, and StickAxis.UP is not among the axes")
        _need_distinct("channels", [channel.number for channel in self.channels])
        if any(row.axis is StickAxis.UP for row in self.channels):
            raise ValueError("station: StickAxis.UP is no channel's: only MANUAL_CONTROL has a button for it")
        if not all(1 <= row.number <= CHANNELS and row.sign in (1, -1) for row in self.channels):
            raise ValueError(f"station: channels are 1 to {CHANNELS}, with sign 1 or -1")
        if len(self.actuators) > ACTUATORS:
            raise ValueError(f"station: {len(self.actuators)} actuators, MAVLink moves at most {ACTUATORS}")
        hasty = [value.name for value in self.values if value.period < FASTEST]
        if hasty:
            raise ValueError(
                f"station: {', '.join(hasty)} sent more often than each {FASTEST // MILLISECOND} ms"
            )


AnyStation: TypeAlias = StationRows[Any, Any, Any]


def _need_distinct(what: str, keys: Iterable[object]) -> None:
    listed = list(keys)
    twice = sorted({str(key) for key in listed if listed.count(key) > 1})
    if twice:
        raise ValueError(f"station: {what} stand twice: {', '.join(twice)}")


def _need_names(what: str, names: list[str], longest: int) -> None:
    _need_distinct(what, names)
    wrong = [name for name in names if not (name.isascii() and 1 <= len(name) <= longest)]
    if wrong:
        raise ValueError(f"station: names of {what} are 1 to {longest} letters of ASCII, not {wrong}")


AnyValue: TypeAlias = Value[Any, Any]
AnyGauge: TypeAlias = Gauge[Any]
__getattr__ = renamed.module(__name__, __name__, Station="StationRows")
