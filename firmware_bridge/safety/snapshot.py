"""Everything the bridge knows at one instant, fixed; what is judged, reported and recorded.

The generic ones are plain classes that write out how they are made: translated to C, a generic dataclass dies
at its import, and these are made six times in every cycle.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Generic, TypeAlias, TypeVar

from firmware_bridge import renamed
from firmware_bridge.drivers.driver import Feedback, Reading, SetPoint, Stop
from firmware_bridge.immutable import Immutable
from firmware_bridge.intent import NEVER_RECEIVED, USUAL_AGE_LIMIT, AgeLimit
from firmware_bridge.motion.captured import Located
from firmware_bridge.motion.pose import Pose
from firmware_bridge.renamed import warn
from firmware_bridge.safety.interlock_base import InterlockBase
from firmware_bridge.units import Nanoseconds
from firmware_bridge.value import valueclass

M = TypeVar("M")
S_co = TypeVar("S_co", covariant=True)

Group: TypeAlias = str
"""Axes that stop together, by their name in the robot's kind."""


@valueclass(frozen=True, slots=True)
class Tracking:
    """Tracking of one axis up to its newest sample; in its unit."""

    set_point: SetPoint = Stop.STANDSTILL
    """The set-point sent to it last."""
    changed_at: Nanoseconds = NEVER_RECEIVED
    """Time of the last change of that set-point."""
    sampled_at: Nanoseconds = NEVER_RECEIVED
    obeyed_at: Nanoseconds = NEVER_RECEIVED
    """The newest sample at which it was where its set-points let it be, or had no torque."""
    settled_at: Nanoseconds = NEVER_RECEIVED
    """The newest one at which it had another position than before, or need not have had."""
    place_at: Nanoseconds = NEVER_RECEIVED
    """The newest one whose position was not, to the last bit, that of the one before."""
    position: float = 0.0
    velocity: float = 0.0
    low: float = 0.0
    high: float = 0.0
    """Between these its set-points let it be: its position where that is commanded, else its speed."""
    uncommanded: bool = False
    """True where it moves further, faster or in another direction than commanded; else it stays behind."""
    backlog: float = 0.0
    """Least distance that it should have gone since its position stopped changing."""
    idle: int = 2
    """So many samples ago it turned as commanded."""
    halted: bool = False
    """It turned as commanded, and then a sample shows not one bit of its backlog."""


@valueclass(frozen=True, slots=True)
class Facts:
    """The facts known of any robot."""

    now: Nanoseconds
    armed: bool
    emergency_stopped: bool
    """The latch of the emergency stop, set until it is cleared."""
    received_at: Nanoseconds
    """Arrival of the newest motion command; `firmware_bridge.intent.NEVER_RECEIVED` before the first."""
    neutral: bool
    """The operator's controls are neutral."""
    axes: Mapping[str, Feedback]
    """Feedback of the axes, in the robot file's order."""
    sensors: Mapping[str, Reading]
    """Readings by the sensors' names, without those never received or silent for too long."""
    links_lost: Mapping[str, str]
    """Reasons why no device on a link can be reached, by the link's name; empty while all links work."""
    masters: Mapping[str, str] = field(default_factory=dict)
    """Recent traffic of a second controller on a link, by the link's name."""
    paused: bool = False
    """The operator has commanded a pause."""
    deflected: str = ""
    """The operator's controls that are not neutral, as text."""
    neutral_required: bool = False
    """The operator was away, and has not let his controls go since."""
    mode: str = ""
    """The robot's mode after a failed actuator; empty while it is whole."""
    without: frozenset[str] = frozenset()
    """The axes that this mode does without."""
    battery_low_since: Nanoseconds | None = None
    """Since which sample the battery has been low; None where it is not, or is not known to be."""
    stood: Mapping[str, str] = field(default_factory=dict)
    """Last known positions of axes without a reference, as text, by their names: no certainty."""
    following: Mapping[str, Tracking] = field(default_factory=dict)
    """Tracking by the axes' names; an axis without an entry is not judged by its set-points."""
    sent_at: Nanoseconds | None = None
    """Time of the newest motion command's sending, or later; None where it is unknown."""
    timestamped: bool = False
    """True where that time is exact to within half a round trip; else the command may be older."""
    age_limit: AgeLimit = USUAL_AGE_LIMIT
    stood_still: Nanoseconds = 0
    """Time without any activity of the bridge itself before this cycle."""

    @property
    def age(self) -> Nanoseconds | None:
        """Age of the newest motion command at its arrival; a lower bound where it is not `timestamped`."""
        return None if self.sent_at is None else self.received_at - self.sent_at

    def lives_for(self, silent_after: Nanoseconds) -> Nanoseconds:
        """Return how long the newest motion command counts from its arrival on.

        As long as silence may last, and no longer than until it is as old as a command may be.
        """
        if self.age is None or not self.timestamped or self.age >= self.age_limit.most:
            return silent_after
        return min(silent_after, self.age_limit.most - self.age)


class Snapshot(Immutable, Generic[M, S_co]):
    """The whole robot at `facts.now`, without the interlocks' decision, which follows from it."""

    __slots__ = ("body", "command", "commanded", "facts", "located", "pose")

    def __init__(
        self,
        *,
        facts: Facts,
        command: M,
        commanded: M,
        body: S_co,
        pose: Pose,
        located: Located | None = None,
    ) -> None:
        self.facts: Final = facts
        self.command: Final = command
        """The command of the operator or a path follower."""
        self.commanded: Final = commanded
        """The motion of the bridge's newest set-points, behind the ramp."""
        self.body: Final = body
        """State of the body by axes and sensors."""
        self.pose: Final = pose
        """The pose at the samples before these."""
        self.located: Final = located
        """Uncertainty of the pose where a sensor sees the robot; None where only odometry gives it."""

    @property
    def wish(self) -> M:
        """The old name of `command`."""
        warn("wish", "command", "Snapshot")
        return self.command

    @property
    def demanded(self) -> M:
        """The same as `commanded`, by its name of the release before."""
        warn("demanded", "commanded", "Snapshot")
        return self.commanded


@dataclass(frozen=True, slots=True)
class ActiveInterlock:
    """One interlock event that restricts the robot now, as text for people."""

    name: str
    """Stable key, for instance "operator link timeout"; an axis's ends with the axis's name."""
    reason: str
    """The cause, with the numbers at the time it began."""
    interlock: InterlockBase
    """Its definition: stopped groups, severity and remedy."""
    since: Nanoseconds
    axis: str = field(default="", compare=False)
    """The name of its axis; empty where it is the robot's."""
    stage: str = field(default="", compare=False)
    """The stop stage that was not acknowledged; each stage is reported by a text of its own."""

    @property
    def text_key(self) -> tuple[str, str]:
        """The name and the stage, by which an operator's texts are distinguished."""
        return self.name, self.stage

    @property
    def remedy(self) -> str:
        """The operator's action that clears it."""
        return self.interlock.remedy


class Decision(Immutable, Generic[M]):
    """The motion permitted now, with the reasons for its restriction."""

    __slots__ = ("allowed", "interlock_events", "requested", "stopped")

    def __init__(
        self,
        events: tuple[ActiveInterlock, ...],
        stopped: frozenset[Group],
        allowed: M,
        requested: frozenset[Group],
    ) -> None:
        self.interlock_events: Final = events
        self.stopped: Final = stopped
        """The groups that an active interlock stops."""
        self.allowed: Final = allowed
        """The permitted motion, at the pace of the body's ramp; a stopped group rests in it."""
        self.requested: Final = requested
        """The groups that `allowed` commands to move."""


AnySnapshot: TypeAlias = Snapshot[Any, Any]
AnyDecision: TypeAlias = Decision[Any]
"""Of whichever robot; what knows its types takes the generic ones."""


__getattr__ = renamed.module(
    __name__, __name__, Hold="ActiveInterlock", Ruling="Decision", Following="Tracking"
)
