"""The driver at a station: received view and sent commands, each in the robot's own directions."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Final, NamedTuple, Protocol, TypeAlias, runtime_checkable

from firmware_bridge.motion.model import Moving
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.units import Nanoseconds


class Sight(NamedTuple):
    """One pose as it came."""

    moving: Moving
    measured_at: Nanoseconds | None
    """Time of it on the station's clock; None while the robot's is not known."""
    received_at: Nanoseconds


@dataclass(frozen=True, slots=True)
class Target:
    """A speed and a yaw rate, left positive: SET_POSITION_TARGET_LOCAL_NED."""

    speed_mps: float = 0.0
    yaw_rate_rad_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Stick:
    """Shares of full stick, -1 to 1, forward and left positive: MANUAL_CONTROL."""

    forward: float = 0.0
    left: float = 0.0
    up: float = 0.0
    buttons: int = 0


DriveCommand: TypeAlias = Target | Stick
NEUTRAL: Final = Target()


class Driver(Protocol):
    """An operator's controls, or a replacement for them."""

    def sees(self, sight: Sight) -> None:
        """Take a pose that has come."""

    def command(self, link: PilotLink, now: Nanoseconds, *, armed: bool) -> DriveCommand:
        """Return the robot's next command; called once in each period, and sent at once."""


class ButtonRequest(Enum):
    """Request of a button of the operator."""

    ARM = "arm"
    STOP = "emergency stop"


@dataclass(frozen=True, slots=True)
class Extras:
    """Further controls of a robot beside driving: buttons of MANUAL_CONTROL, by their numbers."""

    switches: tuple[int, ...] = ()
    up_button: int | None = None
    """The one without which up counts for nothing."""

    def encoded(self, up: float, switched: Collection[int]) -> tuple[float, int]:
        """Return the stick's `up` and `buttons`, for the switches that are pressed, counted from 0."""
        buttons = sum(1 << button for number, button in enumerate(self.switches) if number in switched)
        # The lift's stick counts only while its button is pressed, which the operator does not have to do
        # here.
        if up and self.up_button is not None:
            buttons |= 1 << self.up_button
        return up, buttons


NO_EXTRAS: Final = Extras()


@runtime_checkable
class AtHand(Driver, Protocol):
    """A driver with a device that sends bytes."""

    def handle(self, chunk: bytes, now: Nanoseconds) -> Iterator[ButtonRequest]:
        """Take the device's bytes, cut anywhere; yield the requests to carry out at once."""
