"""The state of a recorded run's bridge, row by row: its recording played into it once more.

It has no plant: a plant's values on the bench are the devices' measurements here, or are missing.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from emulators.bench.columns import ODOMETRY, SAMPLE_EVERY, Column, Samples, columns_of, electric
from emulators.bench.records import InterlockEvent, InterlockLog
from emulators.replay.comparison import first, in_words
from emulators.replay.on_all_links import on_all_links
from emulators.replay.order import ReplayOrder
from emulators.replay.stage import ReplayStage
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import Nanoseconds, to_seconds

Known: TypeAlias = Snapshot[Any, Any]
Reads: TypeAlias = Callable[[Known], float]
Progress: TypeAlias = Callable[[Nanoseconds, Nanoseconds], None]
"""Callback with the progress, and the end."""


@dataclass(frozen=True, slots=True)
class Measured:
    """A run by what its devices have measured, its times from the begin of the recording."""

    samples: Samples
    interlock_events: Sequence[InterlockEvent]
    packets: int
    """Number of packets in the recording, on all links."""
    lasts: Nanoseconds
    difference: str = ""
    """The first packet that this bridge sends otherwise than is recorded, as text; empty without one."""
    differs_at: Nanoseconds | None = None


@dataclass(slots=True)
class _Moving:
    """Speeds from one pose to the next, in the frame of the robot: ahead, to the left, counter-clockwise."""

    pose: tuple[Reads, Reads, Reads]
    _at: Nanoseconds = -1
    _was: tuple[float, float, float] = (math.nan, math.nan, math.nan)
    speeds: tuple[float, float, float] = (math.nan, math.nan, math.nan)

    def look(self, seen: Known) -> None:
        """Take the newest pose, which is there once in a cycle."""
        now = seen.facts.now
        if now == self._at:
            return
        x, y, heading = (read(seen) for read in self.pose)
        (x_was, y_was, heading_was), before = self._was, self._at
        self._at, self._was = now, (x, y, heading)
        if before >= 0:
            # The remainder, as the heading jumps by a turn at pi.
            seconds, turned = to_seconds(now - before), math.remainder(heading - heading_was, math.tau)
            # The chord of an arc points to the mean of both headings.
            middle = heading_was + 0.5 * turned
            along, cosine, sine = (x - x_was, y - y_was), math.cos(middle), math.sin(middle)
            self.speeds = (
                (along[0] * cosine + along[1] * sine) / seconds,
                (along[1] * cosine - along[0] * sine) / seconds,
                turned / seconds,
            )


@dataclass(slots=True)
class _Table:
    """Values of a bridge for each row."""

    robot: AnyRobot
    moving: _Moving | None
    reads: list[tuple[Column, Reads]] = field(default_factory=list)

    def row(self, seen: Known) -> tuple[float, ...]:
        """Return the row of now."""
        if self.moving is not None:
            self.moving.look(seen)
        return tuple([read(seen) for _, read in self.reads])


def measured(order: ReplayOrder, own: tuple[Column, ...], progress: Progress) -> Measured:
    """Play a recording into the bridge of its robot; `own` are the robot's columns. RecordingFileError.

    It goes on behind a difference: the devices have measured what they have.
    """
    stage, table = on_all_links(order), _table(order.robot, own)
    assert stage.bridge is not None  # noqa: S101 - the bridge is what all links end at
    samples, active_events = Samples(tuple(column for column, _ in table.reads), truth=False), InterlockLog()
    try:
        differs = None
        for now in range(stage.lead, stage.end, SAMPLE_EVERY):
            stage.run(now)
            samples.add(now - stage.lead, table.row(stage.bridge.seen))
            active_events.note(stage.bridge.interlock_events, now)
            progress(now, stage.end)
            # Only the first one: whatever follows may be its consequence.
            differs = differs or first(stage.comparisons, now)
    finally:
        stage.finish()
    samples = samples.without_empty({column.name for column, _ in table.reads if column.seen is None})
    events = [_since(record, stage) for record in active_events.records]
    lasts = stage.end - stage.lead
    if differs is None:
        return Measured(samples, events, len(stage.recorded), lasts)
    words = in_words(differs, stage.recorded, stage.lead, stage.kinds)
    return Measured(samples, events, len(stage.recorded), lasts, words, differs.at - stage.lead)


def _since(record: InterlockEvent, stage: ReplayStage) -> InterlockEvent:
    ended = None if record.ended is None else record.ended - stage.lead
    return InterlockEvent(
        record.name, record.reason, max(0, record.began - stage.lead), ended, remedy=record.remedy
    )


def _table(robot: AnyRobot, own: tuple[Column, ...]) -> _Table:
    names = {column.name: column.seen for column in own}
    pose = [seen for name in ODOMETRY if (seen := names.get(name)) is not None]
    moving = _Moving((pose[0], pose[1], pose[2])) if len(pose) == len(ODOMETRY) else None
    table = _Table(robot, moving)
    for column in columns_of(electric(robot), own):
        read = column.seen or _read(robot, column, moving)
        if read is not None:
            table.reads.append((column, read))
    return table


def _read(robot: AnyRobot, column: Column, moving: _Moving | None) -> Reads | None:
    """Return what was measured in the place of a plant's output; None where nothing was."""
    speeds = {"speed": 0, "speed_sideways": 1, "yaw_rate": 2}
    if moving is not None and column.plant in speeds:
        place = speeds[column.plant]
        return lambda _: moving.speeds[place]
    if column.plant == "battery_voltage" and robot.battery is not None:
        return _sensor(robot.battery.sensor)
    what, _, name = column.plant.partition("_")
    axis = next((axis for axis in robot.axes if axis.name == name), None)
    return None if axis is None else _of_axis(robot, what, axis)


def _sensor(name: str) -> Reads:
    def read(seen: Known) -> float:
        reading = seen.facts.sensors.get(name)
        return math.nan if reading is None else reading.value

    return read


def _of_axis(robot: AnyRobot, what: str, axis: Axis) -> Reads | None:
    def current(seen: Known) -> float:
        events = seen.facts.axes[axis.name].current_a
        return math.nan if events is None else events

    if what == "current":
        return current
    # The plant's speed is the motor's: the axis' one by its gear ratio and mounting direction.
    if what == "speed" and axis.name in electric(robot):
        return lambda seen: seen.facts.axes[axis.name].velocity * axis.direction * axis.ratio
    return (lambda seen: seen.facts.axes[axis.name].position) if what == "angle" else None
