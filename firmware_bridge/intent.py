"""The operator's command, in the robot's terms, before its evaluation."""

import math
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds
from firmware_bridge.value import valueclass

NEVER_RECEIVED: Final[Nanoseconds] = -NEVER
"""The instant of what has not come yet."""


@dataclass(frozen=True, slots=True)
class AgeLimit:
    """Age limit of a motion command."""

    most: Nanoseconds = 500 * MILLISECOND
    """Limit since its sending; the operator's side owns it: an order may change it while the bridge runs."""
    needed: bool = False
    """True where a command of unknown age is refused."""
    usual: Nanoseconds = 500 * MILLISECOND
    """Limit at the robot's top speed; an order for a session lets `most` be more."""


USUAL_AGE_LIMIT: Final = AgeLimit()


@valueclass(frozen=True, slots=True)
class Intent:
    """The newest command for motion, and when it came."""

    command: Any
    received_at: Nanoseconds = NEVER_RECEIVED
    """Arrival of the newest motion command; `NEVER_RECEIVED` before the first."""
    sent_at: Nanoseconds | None = None
    """Time of its sending, by the robot's clock, or later; None where it is unknown."""
    timestamped: bool = False
    """True where that time is exact to within half a round trip; else it may be older."""
    deflected: str = ""
    """The operator's controls that are not neutral, as text; empty if none, or at velocity zero."""

    @property
    def neutral(self) -> bool:
        """Return whether every stick is neutral, or the velocity commanded is zero."""
        return not self.deflected


@dataclass(frozen=True, slots=True)
class Arm:
    """Request motion permission."""


@dataclass(frozen=True, slots=True)
class Disarm:
    """Give up motion permission: what moves ramps down; forced: disable the motors' power at once."""

    force: bool = False


@dataclass(frozen=True, slots=True)
class EmergencyStop:
    """Stop and latch; final: only a restart of the bridge clears it."""

    final: bool = False


@dataclass(frozen=True, slots=True)
class ClearEmergencyStop:
    """Reset a latched emergency stop; the robot stays disarmed."""


@dataclass(frozen=True, slots=True)
class Pause:
    """Come to standstill at the ramp, and stay until the operator lets the robot go on; it stays armed."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Go on after a pause."""


@dataclass(frozen=True, slots=True)
class ResetOdometry:
    """Make the present place the origin."""


@dataclass(frozen=True, slots=True)
class ConfirmPosition:
    """Say where an axis stands, in the unit in which it is read off the robot, disarmed and at standstill."""

    axis: str
    value: float = math.nan
    """NaN: no one has looked, it is to find out by itself."""


@dataclass(frozen=True, slots=True)
class EnterMode:
    """Go on in another mode, at standstill and disarmed; empty for the whole robot's."""

    mode: str


@dataclass(frozen=True, slots=True)
class Follow:
    """Let a path follower of this name give the commands, until a stick is deflected; empty for none."""

    path_follower: str


@dataclass(frozen=True, slots=True)
class ChangeDriver:
    """Another operator drives from now on: nothing moves before he has let his controls go."""


Request: TypeAlias = (
    Arm
    | Disarm
    | EmergencyStop
    | ClearEmergencyStop
    | Pause
    | Resume
    | ResetOdometry
    | ConfirmPosition
    | EnterMode
    | Follow
    | ChangeDriver
)


FORCED_DISARM: Final = "forced disarm"
OF_ANYONE: Final = frozenset({EmergencyStop, FORCED_DISARM})
"""Kinds of requests that are obeyed of a station that is not in control: each is an emergency stop there."""


def kind_of(request: Request) -> Any:
    """Return what a request is, in tables of requests: its class, or `FORCED_DISARM`."""
    return FORCED_DISARM if isinstance(request, Disarm) and request.force else type(request)


@dataclass(frozen=True, slots=True)
class Answer:
    """The bridge's answer to a request, with the reason for people."""

    accepted: bool
    reason: str
    temporary: bool = False
    """A refusal that the same request may outlive, for instance while a drive is being enabled again."""
