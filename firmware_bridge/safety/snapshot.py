"""Everything the bridge knows at one instant, fixed; what is judged, reported and recorded.

The generic ones are plain classes that write out how they are made: translated to C, a generic dataclass dies
at its import, and these are made six times in every cycle.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Generic, TypeAlias, TypeVar

from firmware_bridge.drivers.driver import Feedback, Reading
from firmware_bridge.motion.pose import Pose
from firmware_bridge.safety.row import Row
from firmware_bridge.units import Nanoseconds

M = TypeVar("M")
S_co = TypeVar("S_co", covariant=True)

Group: TypeAlias = str
"""Axes that stop together, by their name in the robot's kind."""


@dataclass(frozen=True, slots=True)
class Facts:
    """What is known of any robot."""

    now: Nanoseconds
    armed: bool
    emergency_stopped: bool
    """The latch of the emergency stop, set until it is cleared."""
    heard_at: Nanoseconds
    """When the newest motion command arrived; `firmware_bridge.intent.NEVER_HEARD` before the first."""
    axes: Mapping[str, Feedback]
    """By the axes' names, in the robot file's order."""
    sensors: Mapping[str, Reading]
    """By the sensors' names; one that was never heard, or is silent for too long, is left out."""
    links_lost: Mapping[str, str]
    """Why no device on a link can be reached, by the link's name; empty while all links stand."""
    mode: str = ""
    """The robot's mode after a failed actuator; empty while it is whole."""
    without: frozenset[str] = frozenset()
    """The axes that this mode does without."""


class Snapshot(Generic[M, S_co]):
    """The whole robot at `facts.now`. What an interlock decided is not in it: that is the gate's ruling."""

    __slots__ = ("body", "demanded", "facts", "pose", "wish")

    def __init__(self, *, facts: Facts, wish: M, demanded: M, body: S_co, pose: Pose) -> None:
        self.facts: Final = facts
        self.wish: Final = wish
        """What the operator, or a guide, wants."""
        self.demanded: Final = demanded
        """What the bridge's newest set-points ask for, behind the ramp."""
        self.body: Final = body
        """What axes and sensors tell of the body."""
        self.pose: Final = pose


@dataclass(frozen=True, slots=True)
class Hold:
    """One interlock that holds the robot back now, in words for people."""

    name: str
    """Stable key, for instance "operator silent"; an axis's ends with the axis's name."""
    reason: str
    """What holds, with the numbers at the time it began."""
    row: Row
    """What follows from it."""
    since: Nanoseconds

    @property
    def remedy(self) -> str:
        """What to do so that it lets go."""
        return self.row.remedy


class Ruling(Generic[M]):
    """What may be done now, and why not more."""

    __slots__ = ("allowed", "asked", "holds", "stopped")

    def __init__(
        self, holds: tuple[Hold, ...], stopped: frozenset[Group], allowed: M, asked: frozenset[Group]
    ) -> None:
        self.holds: Final = holds
        self.stopped: Final = stopped
        """The groups that a hold stops."""
        self.allowed: Final = allowed
        """Where to go, at the pace of the body's ramp; a stopped group rests in it."""
        self.asked: Final = asked
        """The groups that `allowed` asks to move."""
