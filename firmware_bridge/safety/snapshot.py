"""Everything the bridge knows at one instant, fixed; what is judged, reported and recorded.

The generic ones are plain classes that write out how they are made: translated to C, a generic dataclass dies
at its import, and these are made six times in every cycle.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Generic, TypeAlias, TypeVar

from firmware_bridge.drivers.driver import Demand, Feedback, Reading, Stop
from firmware_bridge.immutable import Immutable
from firmware_bridge.intent import NEVER_RECEIVED, USUAL_AGE_LIMIT, AgeLimit
from firmware_bridge.motion.captured import Located
from firmware_bridge.motion.pose import Pose
from firmware_bridge.renamed import warn
from firmware_bridge.safety.row import Row
from firmware_bridge.units import Nanoseconds
from firmware_bridge.value import valueclass

M = TypeVar("M")
S_co = TypeVar("S_co", covariant=True)

Group: TypeAlias = str
"""Axes that stop together, by their name in the robot's kind."""


@valueclass(frozen=True, slots=True)
class Following:
    """How one axis has done what it was told, up to its newest sample; in its unit."""

    demand: Demand = Stop.REST
    """What was sent to it last."""
    changed_at: Nanoseconds = NEVER_RECEIVED
    """When that differed from what was sent before."""
    sampled_at: Nanoseconds = NEVER_RECEIVED
    obeyed_at: Nanoseconds = NEVER_RECEIVED
    """The newest sample at which it was where its demands let it be, or had no torque."""
    settled_at: Nanoseconds = NEVER_RECEIVED
    """The newest one at which it had another position than before, or need not have had."""
    place_at: Nanoseconds = NEVER_RECEIVED
    """The newest one whose position was not, to the last bit, that of the one before."""
    position: float = 0.0
    velocity: float = 0.0
    low: float = 0.0
    high: float = 0.0
    """Between these its demands let it be: its position where that is demanded, else its speed."""
    uncommanded: bool = False
    """How it deviates: it moves further, faster or another way than commanded; else it stays behind."""
    backlog: float = 0.0
    """How far it should have gone at least since its position began to repeat."""
    idle: int = 2
    """So many samples ago it turned as commanded."""
    halted: bool = False
    """It turned as commanded, and then a sample shows not one bit of its backlog."""


@valueclass(frozen=True, slots=True)
class Facts:
    """What is known of any robot."""

    now: Nanoseconds
    armed: bool
    emergency_stopped: bool
    """The latch of the emergency stop, set until it is cleared."""
    received_at: Nanoseconds
    """When the newest motion command arrived; `firmware_bridge.intent.NEVER_RECEIVED` before the first."""
    neutral: bool
    """The operator's controls are let go."""
    axes: Mapping[str, Feedback]
    """By the axes' names, in the robot file's order."""
    sensors: Mapping[str, Reading]
    """By the sensors' names; one that was never heard, or is silent for too long, is left out."""
    links_lost: Mapping[str, str]
    """Why no device on a link can be reached, by the link's name; empty while all links stand."""
    masters: Mapping[str, str] = field(default_factory=dict)
    """What only another master sends, heard lately on a link, by the link's name."""
    paused: bool = False
    """The operator has asked the robot to wait."""
    deflected: str = ""
    """What of the operator's controls is not let go, in words."""
    neutral_required: bool = False
    """The operator was away, and has not let his controls go since."""
    mode: str = ""
    """The robot's mode after a failed actuator; empty while it is whole."""
    without: frozenset[str] = frozenset()
    """The axes that this mode does without."""
    battery_low_since: Nanoseconds | None = None
    """Since which sample the battery has been low; None where it is not, or is not known to be."""
    stood: Mapping[str, str] = field(default_factory=dict)
    """Where axes without a zero were when it was known last, in words, by their names: no certainty."""
    following: Mapping[str, Following] = field(default_factory=dict)
    """By the axes' names; one without is not judged by what it was told."""
    sent_at: Nanoseconds | None = None
    """When the newest motion command was said, or later; None where nothing tells."""
    dated: bool = False
    """Whether it was said then, to within half a round trip; else it may be older."""
    age_limit: AgeLimit = USUAL_AGE_LIMIT
    stood_still: Nanoseconds = 0
    """How long the bridge itself did nothing before this cycle."""

    @property
    def age(self) -> Nanoseconds | None:
        """How old the newest motion command was when it arrived; at least so old where it is not `dated`."""
        return None if self.sent_at is None else self.received_at - self.sent_at

    def lives_for(self, silent_after: Nanoseconds) -> Nanoseconds:
        """Return how long the newest motion command counts from its arrival on.

        As long as silence may last, and no longer than until it is as old as a command may be.
        """
        if self.age is None or not self.dated or self.age >= self.age_limit.most:
            return silent_after
        return min(silent_after, self.age_limit.most - self.age)


class Snapshot(Immutable, Generic[M, S_co]):
    """The whole robot at `facts.now`. What an interlock decided is not in it: that is the gate's ruling."""

    __slots__ = ("body", "command", "demanded", "facts", "located", "pose")

    def __init__(
        self, *, facts: Facts, command: M, demanded: M, body: S_co, pose: Pose, located: Located | None = None
    ) -> None:
        self.facts: Final = facts
        self.command: Final = command
        """What the operator, or a guide, wants."""
        self.demanded: Final = demanded
        """What the bridge's newest set-points ask for, behind the ramp."""
        self.body: Final = body
        """What axes and sensors tell of the body."""
        self.pose: Final = pose
        """Where it is, at the samples before these."""
        self.located: Final = located
        """How far that is known where a sensor sees the robot; None where only odometry tells it."""

    @property
    def wish(self) -> M:
        """The old name of `command`."""
        warn("wish", "command", "Snapshot")
        return self.command


@dataclass(frozen=True, slots=True)
class Hold:
    """One interlock that holds the robot back now, in words for people."""

    name: str
    """Stable key, for instance "operator link timeout"; an axis's ends with the axis's name."""
    reason: str
    """What holds, with the numbers at the time it began."""
    row: Row
    """What follows from it."""
    since: Nanoseconds
    axis: str = field(default="", compare=False)
    """Whose it is; empty where it is the robot's."""
    stage: str = field(default="", compare=False)
    """The stop stage that was not acknowledged; each stage is reported by a text of its own."""

    @property
    def text_key(self) -> tuple[str, str]:
        """What tells one text of an operator from another: the name and the stage."""
        return self.name, self.stage

    @property
    def remedy(self) -> str:
        """What to do so that it lets go."""
        return self.row.remedy


class Ruling(Immutable, Generic[M]):
    """What may be done now, and why not more."""

    __slots__ = ("allowed", "holds", "requested", "stopped")

    def __init__(
        self, holds: tuple[Hold, ...], stopped: frozenset[Group], allowed: M, requested: frozenset[Group]
    ) -> None:
        self.holds: Final = holds
        self.stopped: Final = stopped
        """The groups that a hold stops."""
        self.allowed: Final = allowed
        """Where to go, at the pace of the body's ramp; a stopped group rests in it."""
        self.requested: Final = requested
        """The groups that `allowed` asks to move."""
