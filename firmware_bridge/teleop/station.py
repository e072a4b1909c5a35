"""A robot's place on MAVLink as rows of its own words; nothing of the protocol is in them.

Signs are the robot's: forward, left, up and counter-clockwise positive; `firmware_bridge.teleop` turns them
into MAVLink's, and only there. Rows that the protocol cannot carry are refused where they are made.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final, Generic, TypeVar

from firmware_bridge.immutable import Immutable
from firmware_bridge.robot import Robot
from firmware_bridge.robot.table import Table
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import MILLISECOND, Nanoseconds

G = TypeVar("G", bound=Table)
M = TypeVar("M")
S = TypeVar("S")

BUTTONS: Final = 16
"""How many buttons MANUAL_CONTROL has in its first field."""
ACTUATORS: Final = 6
"""How many actuators one DO_SET_ACTUATOR moves."""
VALUE_NAME: Final = 10
"""Letters of a NAMED_VALUE_FLOAT or NAMED_VALUE_INT."""
PARAMETER_NAME: Final = 16
FASTEST: Final[Nanoseconds] = 20 * MILLISECOND
"""No message is sent more often, whatever a row or a ground station asks for."""


@dataclass(frozen=True, slots=True)
class Stick:
    """The axes of MANUAL_CONTROL as shares of full stick, -1 to 1; None where an axis is not used."""

    forward: float | None
    """x, forward positive."""
    left: float | None
    """y, to the left positive."""
    turn: float | None
    """r, counter-clockwise positive."""
    up: float | None
    """z, while the station's `up_button` is held, and beyond its dead band."""


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


class Switch(Immutable, Generic[M]):
    """Something that the operator switches: by a button, a relay's number, or ILLUMINATOR_ON_OFF."""

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


class Actuator(Immutable, Generic[G, M]):
    """Something that goes to a share of its travel by DO_SET_ACTUATOR: -1 is its lower end, 1 its upper."""

    __slots__ = ("name", "send")

    def __init__(self, name: str, send: Callable[[M, float, Robot[G]], M]) -> None:
        self.name: Final = name
        self.send: Final = send
        """Return the wish with this share, 0 to 1, of the travel."""


class Value(Immutable, Generic[M, S]):
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


class Fixed(Immutable, Generic[G]):
    """A read-only parameter: a number of the robot file."""

    __slots__ = ("name", "unit", "value")

    def __init__(self, name: str, value: Callable[[Robot[G]], float], unit: str) -> None:
        self.name: Final = name
        """At most 16 letters."""
        self.value: Final = value
        self.unit: Final = unit


class Station(Generic[G, M, S]):
    """One kind of robot's rows; ValueError where MAVLink could not carry them."""

    __slots__ = (
        "actuators", "dead_band", "forgotten", "largest", "metres_rolled", "parameters", "stick",
        "stop_button", "switches", "target", "twist", "up_button", "values",
    )  # fmt: skip

    def __init__(
        self,
        *,
        stick: Callable[[Stick, M, Robot[G]], M],
        target: Callable[[Velocity, M, Robot[G]], M | Unusable],
        twist: Callable[[S], Twist],
        forgotten: Callable[[M], M],
        largest: Callable[[Robot[G]], Twist],
        metres_rolled: Callable[[Robot[G]], float] | None = None,
        stop_button: int | None = None,
        up_button: int | None = None,
        dead_band: float = 0.05,
        switches: tuple[Switch[M], ...] = (),
        actuators: tuple[Actuator[G, M], ...] = (),
        values: tuple[Value[M, S], ...] = (),
        parameters: tuple[Fixed[G], ...] = (),
    ) -> None:
        self.stick: Final = stick
        """Return the wish after the one before, for these axes."""
        self.target: Final = target
        """Return the wish for a velocity, or why this robot cannot mean it."""
        self.twist: Final = twist
        self.forgotten: Final = forgotten
        """Return what of a wish outlives a change of state: a target that is kept would act unasked later."""
        self.largest: Final = largest
        """The robot's limits: what is ten times faster is absurd, and refused as no wish at all."""
        self.metres_rolled: Final = metres_rolled
        """Metres rolled for each radian of a rolling axis, its radius; None: no distances are told."""
        self.stop_button: Final = stop_button
        """The button of MANUAL_CONTROL that is the emergency stop, counted from 0; None for none."""
        self.up_button: Final = up_button
        """The button without which z counts for nothing; None: z counts always."""
        self.dead_band: Final = dead_band
        """Of z; a hand that rests on a stick does not hold it at zero."""
        self.switches: Final = switches
        self.actuators: Final = actuators
        """By DO_SET_ACTUATOR's parameters 1, 2, ... of set 0."""
        self.values: Final = values
        self.parameters: Final = parameters
        buttons = [button for button in (stop_button, up_button) if button is not None]
        buttons += [switch.button for switch in switches if switch.button is not None]
        named = [value.name for value in values] + [row.telemetry for row in switches if row.telemetry]
        _need_distinct("buttons", buttons)
        _need_distinct("relays", [switch.relay for switch in switches])
        _need_names("values", named, VALUE_NAME)
        _need_names("parameters", [row.name for row in parameters], PARAMETER_NAME)
        if not all(0 <= button < BUTTONS for button in buttons):
            raise ValueError(f"station: buttons are counted from 0 to {BUTTONS - 1}, not {buttons}")
        if len(actuators) > ACTUATORS:
            raise ValueError(f"station: {len(actuators)} actuators, MAVLink moves at most {ACTUATORS}")
        hasty = [value.name for value in values if value.period < FASTEST]
        if hasty:
            raise ValueError(
                f"station: {', '.join(hasty)} sent more often than each {FASTEST // MILLISECOND} ms"
            )


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
