"""What the operator wants, in the robot's words, before anything has judged it."""

import math
from dataclasses import dataclass
from typing import Final, Generic, TypeAlias, TypeVar

from firmware_bridge.immutable import Immutable
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

NEVER_RECEIVED: Final[Nanoseconds] = -NEVER
"""The instant of what has not come yet."""

M_co = TypeVar("M_co", covariant=True)


@dataclass(frozen=True, slots=True)
class AgeLimit:
    """How old a motion command may be that is still obeyed."""

    most: Nanoseconds = 500 * MILLISECOND
    """Since it was said. It belongs to the operator's side: an order may change it while the bridge runs."""
    needed: bool = False
    """Whether one whose age no one knows is not obeyed."""
    usual: Nanoseconds = 500 * MILLISECOND
    """How old it may be at the robot's top speed; an order for a session lets `most` be more."""


USUAL_AGE_LIMIT: Final = AgeLimit()


class Intent(Immutable, Generic[M_co]):
    """The newest command for motion, and when it came."""

    __slots__ = ("command", "dated", "deflected", "received_at", "sent_at")

    def __init__(
        self,
        command: M_co,
        received_at: Nanoseconds = NEVER_RECEIVED,
        sent_at: Nanoseconds | None = None,
        *,
        dated: bool = False,
        deflected: str = "",
    ) -> None:
        self.command: Final = command
        self.received_at: Final = received_at
        """When the newest motion command arrived; `NEVER_RECEIVED` before the first."""
        self.sent_at: Final = sent_at
        """When it was said, by the robot's clock, or later; None where nothing tells."""
        self.dated: Final = dated
        """Whether it was said then, to within half a round trip; else it may be older."""
        self.deflected: Final = deflected
        """What of the operator's controls is not let go, in words; empty where all is, or a velocity of zero
        is asked for."""

    @property
    def neutral(self) -> bool:
        """Every stick is let go, or the velocity asked for is zero."""
        return not self.deflected


@dataclass(frozen=True, slots=True)
class Arm:
    """Ask for leave to move."""


@dataclass(frozen=True, slots=True)
class Disarm:
    """Give up the leave to move: what moves ramps down; forced: take the power off the motors at once."""

    force: bool = False


@dataclass(frozen=True, slots=True)
class EmergencyStop:
    """Stop and latch; final: only a restart of the bridge clears it."""

    final: bool = False


@dataclass(frozen=True, slots=True)
class ClearEmergencyStop:
    """Let go of a latched emergency stop; the robot stays disarmed."""


@dataclass(frozen=True, slots=True)
class Pause:
    """Come to rest at the ramp, and stay until the operator lets the robot go on; it stays armed."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Go on after a pause."""


@dataclass(frozen=True, slots=True)
class ResetOdometry:
    """Make the present place the origin."""


@dataclass(frozen=True, slots=True)
class ConfirmZero:
    """Say where an axis stands, in the unit in which it is read off the robot, disarmed and at rest."""

    axis: str
    value: float = math.nan
    """NaN: no one has looked, it is to find out by itself."""


@dataclass(frozen=True, slots=True)
class EnterMode:
    """Go on in another mode, at rest and disarmed; empty for the whole robot's."""

    mode: str


@dataclass(frozen=True, slots=True)
class Follow:
    """Let a guide of this name give the commands, until the operator moves a stick; empty for none."""

    guide: str


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
    | ConfirmZero
    | EnterMode
    | Follow
    | ChangeDriver
)


@dataclass(frozen=True, slots=True)
class Verdict:
    """The bridge's answer to a request, with the reason for people."""

    accepted: bool
    reason: str
    temporary: bool = False
    """A refusal that the same request may outlive, for instance while a drive is being enabled again."""
