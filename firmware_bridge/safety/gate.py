"""The interlock evaluation: one snapshot in, one decision out.

It keeps which interlocks are active and since when, nothing else. None is active until a snapshot trips it,
so there is nothing to unlock at boot; latches belong to the component that clears them and come in with the
snapshot. An interlock event ends when its interlock has been clear at every evaluation for its release delay;
the first clear one starts that time, and a trip in between starts it again.
"""

from collections.abc import Mapping
from typing import Any, Final

from firmware_bridge.drivers.driver import Feedback, Reports
from firmware_bridge.immutable import Immutable
from firmware_bridge.robot import AnyRobot, Axis, Problem, RobotFileError
from firmware_bridge.safety.common import AXIS_INTERLOCKS, EXCLUDED_AXIS, whole_robot_interlocks
from firmware_bridge.safety.interlock import (
    AnyInterlock,
    AnyLimit,
    AnyView,
    AxisInterlock,
    View,
)
from firmware_bridge.safety.interlock_base import InterlockBase
from firmware_bridge.safety.rules import Rules
from firmware_bridge.safety.snapshot import (
    ActiveInterlock,
    AnyDecision,
    AnySnapshot,
    Decision,
    Facts,
    Group,
)
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

NO_GROUP: Final[frozenset[Group]] = frozenset()


class _Memory:
    """The hold of each interlock, and since when it has been clear."""

    __slots__ = ("_clear_since", "_holds")

    def __init__(self) -> None:
        self._holds: dict[str, ActiveInterlock] = {}
        self._clear_since: dict[str, Nanoseconds] = {}

    def interlock_events(self, name: str) -> bool:
        return name in self._holds

    @property
    def clearing(self) -> frozenset[str]:
        """The holds whose rows do not judge so any more, and have not been clear for long enough."""
        return frozenset(self._clear_since)

    def look(
        self, name: str, reason: str | None, row: InterlockBase, now: Nanoseconds, axis: str = ""
    ) -> ActiveInterlock | None:
        """Take one look's outcome; return the hold where there is one."""
        if reason is not None:
            # A trip within the release delay starts it again; the reason stays that of the first trip.
            self._clear_since.pop(name, None)
            return self._holds.setdefault(name, ActiveInterlock(name, reason, row, now, axis))
        event = self._holds.get(name)
        if event is not None and now - self._clear_since.setdefault(name, now) >= row.clear_after:
            del self._holds[name], self._clear_since[name]
            return None
        return event


class AxisRows(Immutable):
    """One axis, its rows with the names of their holds, and the silence that its link allows."""

    __slots__ = ("axis", "excluded", "rows", "silent_after")

    def __init__(self, axis: Axis, silent_after: Nanoseconds, rows: tuple[AxisInterlock, ...]) -> None:
        self.axis: Final = axis
        self.silent_after: Final = silent_after
        self.rows: Final = tuple((f"{row.name}: {axis.name}", row) for row in rows)
        self.excluded: Final = ((f"{EXCLUDED_AXIS.name}: {axis.name}", EXCLUDED_AXIS),)
        """In a mode that does without the axis."""


def axis_rows(robot: AnyRobot, reports: Mapping[str, frozenset[Reports]]) -> tuple[AxisRows, ...]:
    """Return each axis' interlocks by its driver's reports; RobotFileError where a report is missing."""
    found = []
    for axis in robot.axes:
        rows = [(row, row.fitting(reports[axis.name])) for row in AXIS_INTERLOCKS]
        missing = [row.name for row, fitting in rows if fitting is None]
        if missing:
            problem = f"the devices on this link report too little for: {', '.join(missing)}"
            raise RobotFileError(robot.name, Problem(f"links.{axis.link}.driver", problem))
        link = robot.links[axis.link]
        stops = None if link.stops is None else frozenset(link.stops)
        # One weaker row may stand in for several.
        kept = dict.fromkeys(row for _, row in rows if row is not None)
        fitting = tuple(row if stops is None else row.confined(stops) for row in kept)
        found.append(AxisRows(axis, link.silent_ms * MILLISECOND, fitting))
    return tuple(found)


class Gate:
    """The interlocks of one robot."""

    __slots__ = ("_axes", "_before", "_common", "_memory", "_robot", "_rules", "_silent_after")

    def __init__(
        self, robot: AnyRobot, rules: Mapping[str, Rules], reports: Mapping[str, frozenset[Reports]]
    ) -> None:
        """Take the robot's own rules for each of its modes, and the reports of each axis' driver."""
        self._robot = robot
        self._rules = rules
        self._axes = axis_rows(robot, reports)
        self._common: tuple[AnyInterlock, ...] = whole_robot_interlocks(rules[""].numbers, robot.links)
        self._silent_after = robot.operator.silent_ms * MILLISECOND
        self._memory = _Memory()
        self._before: AnyDecision | None = None

    def rule(self, seen: AnySnapshot) -> AnyDecision:
        """Judge the command in this snapshot; `seen.facts.now` never runs backwards."""
        rules = self._rules[seen.facts.mode]
        view = View(self._robot, seen, seen.command, NO_GROUP, self._before)
        events = self._held(self._common, view) + self._held(rules.interlocks, view)
        events += self._held_axes(seen.facts)
        stopped = _stopped(events, rules.groups)
        clipped = self._clipped(rules.limits, view, events, reported=not stopped)
        allowed = rules.body.rested(clipped, stopped) if stopped else clipped
        if rules.after_limits:
            requested = rules.body.requested(clipped, seen.body)
            # Groups that may each move alone may be forbidden to move together, so this is judged behind the
            # limits.
            late = self._held(rules.after_limits, View(self._robot, seen, allowed, requested, self._before))
            events += late
            stopped_late = _stopped(late, rules.groups)
            allowed = rules.body.rested(allowed, stopped_late) if stopped_late else allowed
            stopped |= stopped_late
        decision = Decision(tuple(events), stopped, allowed, rules.body.requested(allowed, seen.body))
        self._before = decision
        return decision

    @property
    def clearing(self) -> frozenset[str]:
        """The newest decision's interlock events that stay for their release delay after their cause."""
        return self._memory.clearing

    def next_deadline(self, facts: Facts) -> Nanoseconds:
        """Return the next instant at which a timeout trips if nothing more is received; NEVER without one.

        It lies after `facts.now`: a timeout that has already tripped needs no wake-up.
        """
        first = NEVER
        operator = facts.received_at + facts.lives_for(self._silent_after)
        if operator > facts.now:
            first = operator
        for one in self._axes:
            feedback = facts.axes.get(one.axis.name)
            if feedback is not None and feedback.received_at + one.silent_after > facts.now:
                first = min(first, feedback.received_at + one.silent_after)
        return first

    def _held(self, rows: tuple[AnyInterlock, ...], view: AnyView) -> list[ActiveInterlock]:
        memory, now = self._memory, view.seen.facts.now
        events = []
        for row in rows:
            held = memory.interlock_events(row.name)
            # An active interlock is judged by its release threshold: a value at the limit must not flicker.
            reason = row.judge(view.held() if held else view)
            event = memory.look(row.name, reason, row, now) if held or reason is not None else None
            if event is not None:
                events.append(event)
        return events

    def _held_axes(self, facts: Facts) -> list[ActiveInterlock]:
        events, memory = [], self._memory
        for one in self._axes:
            axis = one.axis
            feedback = facts.axes.get(axis.name) or Feedback(axis.name)
            for name, row in one.excluded if axis.name in facts.without else one.rows:
                reason = row.judge(axis, feedback, facts, one.silent_after)
                held = reason is not None or memory.interlock_events(name)
                event = memory.look(name, reason, row, facts.now, axis.name) if held else None
                if event is not None:
                    events.append(event)
        return events

    def _clipped(
        self,
        limits: tuple[AnyLimit, ...],
        view: AnyView,
        events: list[ActiveInterlock],
        *,
        reported: bool,
    ) -> Any:
        """Return the command within all limits; while something is stopped, not they hold it back."""
        for row in limits:
            allowed, reason = row.clip(view)
            event = self._memory.look(row.name, reason if reported else None, row, view.seen.facts.now)
            if event is not None:
                events.append(event)
            # Each limit judges the command as the one before has left it: the order of the rows counts.
            if allowed is not view.allowed:
                view = View(view.robot, view.seen, allowed, NO_GROUP, view.before)
        return view.allowed


def _stopped(events: list[ActiveInterlock], groups: frozenset[Group]) -> frozenset[Group]:
    stopped = NO_GROUP
    for event in events:
        stopped |= groups if event.row.stops is None else event.row.stops
    return stopped
