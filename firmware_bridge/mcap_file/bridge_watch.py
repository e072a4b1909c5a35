"""What a recording has of a bridge: drives, joints, odometry, interlock events, arming.

Looking costs two comparisons a packet; a look is written later, by another thread where one writes.
"""

from collections.abc import Callable, Mapping
from contextlib import suppress
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple, Protocol, TypeAlias

from firmware_bridge.canopen.cia402 import Mode
from firmware_bridge.drivers.driver import Feedback
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.mcap_file.channels import ODOMETRY, drive_topics
from firmware_bridge.mcap_file.rows import DriveRow, EventKind, EventRow, Joint
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.snapshot import ActiveInterlock, AnySnapshot
from firmware_bridge.units import Nanoseconds

if TYPE_CHECKING:
    from firmware_bridge.mcap_file.writer import RecordingWriter

ODOMETRY_FRAME: Final = "odometry"
"""Axes in which the bridge counts: x forward and y left where it was started."""


class DriveWords(NamedTuple):
    """A drive's own objects 0x6041 and 0x6061."""

    statusword: int
    mode: int


WordsOf: TypeAlias = Callable[[], Mapping[str, DriveWords]]
"""By the names of axes; without those that have no such objects."""


def _no_words() -> Mapping[str, DriveWords]:
    return MappingProxyType({})


class Bridged(Protocol):
    """A bridge, as far as it is recorded."""

    @property
    def seen(self) -> AnySnapshot:
        """The snapshot of the newest cycle."""

    @property
    def interlock_events(self) -> tuple[ActiveInterlock, ...]:
        """The interlocks that are active."""


class Look(NamedTuple):
    """A bridge at one instant."""

    at: Nanoseconds
    seen: AnySnapshot
    events: tuple[ActiveInterlock, ...]
    words: Mapping[str, DriveWords]


class BridgeWatch:
    """One bridge after the other, where one is restarted."""

    def __init__(
        self,
        robot: AnyRobot,
        bridge: Callable[[], Bridged],
        words: WordsOf = _no_words,
        *,
        odometry: bool = True,
    ) -> None:
        """Take the robot, what returns its bridge, and the drives' own words where they are at hand.

        Without `odometry` the bridge's pose is not written: another column has it.
        """
        self._bridge: Final = bridge
        self._words: Final = words
        self._odometry: Final = odometry
        self._topics: Final = drive_topics(robot)
        self._units: Final = {axis.name: axis.unit.value for axis in robot.axes}
        self._seen: AnySnapshot | None = None
        self._events: tuple[ActiveInterlock, ...] = ()
        self._written_at: Nanoseconds = NEVER_RECEIVED
        self._active: dict[str, ActiveInterlock] = {}
        self._armed = False

    def look(self, now: Nanoseconds) -> Look | None:
        """Return the bridge's new state; None where nothing is new since the last look."""
        bridge = self._bridge()
        seen, events = bridge.seen, bridge.interlock_events
        if seen is self._seen and events is self._events:
            return None
        self._seen, self._events = seen, events
        return Look(now, seen, events, self._words())

    def write(self, look: Look, writer: "RecordingWriter") -> None:
        """Write the differences from the look before."""
        self._write_events(look, writer)
        facts = look.seen.facts
        # One row for each cycle, whatever else has made a look new.
        if facts.now == self._written_at:
            return
        self._written_at = facts.now
        joints = []
        for name, feedback in facts.axes.items():
            writer.drive(look.at, self._topics[name], self._row(feedback, look.words.get(name)))
            if feedback.sampled_at != NEVER_RECEIVED:
                joints.append(Joint(name, feedback.position, feedback.velocity))
        if joints:
            writer.joints(look.at, joints)
        if joints and self._odometry:
            pose = look.seen.pose
            writer.pose(look.at, ODOMETRY, ODOMETRY_FRAME, (pose.x_m, pose.y_m, pose.heading_rad))

    def _row(self, feedback: Feedback, words: DriveWords | None) -> DriveRow:
        sampled = feedback.sampled_at != NEVER_RECEIVED
        return DriveRow(
            axis=feedback.axis,
            power=feedback.power.value,
            state=feedback.text,
            unit=self._units[feedback.axis],
            statusword=None if words is None else words.statusword,
            mode=None if words is None else words.mode,
            mode_name="" if words is None else _mode_name(words.mode),
            position=feedback.position if sampled else None,
            velocity=feedback.velocity if sampled else None,
            current_a=feedback.current_a if feedback.current_at != NEVER_RECEIVED else None,
            fault=feedback.fault,
        )

    def _write_events(self, look: Look, writer: "RecordingWriter") -> None:
        active = {event.name: event for event in look.events}
        for name, event in self._active.items():
            # Cleared and active again between two looks: two events, not one.
            if name not in active or active[name].since != event.since:
                row = EventRow(EventKind.INTERLOCK_CLEARED, name, event.reason, since=event.since)
                writer.event(look.at, row)
        for name, event in active.items():
            if name not in self._active or self._active[name].since != event.since:
                kind = EventKind.INTERLOCK_ACTIVE
                writer.event(look.at, EventRow(kind, name, event.reason, event.remedy, event.since))
        self._active = active
        armed = look.seen.facts.armed
        if armed != self._armed:
            self._armed = armed
            writer.event(look.at, EventRow(EventKind.ARMED if armed else EventKind.DISARMED))


def _mode_name(mode: int) -> str:
    """Return a mode by its name in CiA 402; empty for a maker's own."""
    with suppress(ValueError):
        return Mode(mode).name.lower().replace("_", " ")
    return ""
