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

    __slots__ = ("_active", "_clear_since")

    def __init__(self) -> None:
        self._active: dict[str, ActiveInterlock] = {}
        self._clear_since: dict[str, Nanoseconds] = {}

    def interlock_events(self, name: str) -> bool:
        return name in self._active

    @property
    def clearing(self) -> frozenset[str]:
        """The events whose interlocks no longer trip, and have not been clear for long enough."""
        return frozenset(self._clear_since)

    def look(
        self, name: str, reason: str | None, interlock: InterlockBase, now: Nanoseconds, axis: str = ""
    ) -> ActiveInterlock | None:
        """Take one look's outcome; return the hold where there is one."""
        if reason is not None:
            # A trip within the release delay starts it again; the reason stays that of the first trip.
            self._clear_since.pop(name, None)
            return self._active.setdefault(name, ActiveInterlock(name, reason, interlock, now, axis))
        event = self._active.get(name)
        if event is not None and now - self._clear_since.setdefault(name, now) >= interlock.clear_after:
            del self._active[name], self._clear_since[name]
            return None
        return event


class AxisInterlocks(Immutable):
    """One axis, its interlocks with the names of their events, and the silence that its link allows."""

    __slots__ = ("axis", "excluded", "interlocks", "silent_after")

    def __init__(self, axis: Axis, silent_after: Nanoseconds, interlocks: tuple[AxisInterlock, ...]) -> None:
        self.axis: Final = axis
        self.silent_after: Final = silent_after
        self.interlocks: Final = tuple(
            (f"{interlock.name}: {axis.name}", interlock) for interlock in interlocks
        )
        self.excluded: Final = ((f"{EXCLUDED_AXIS.name}: {axis.name}", EXCLUDED_AXIS),)
        """In a mode that does without the axis."""


def axis_interlocks(robot: AnyRobot, reports: Mapping[str, frozenset[Reports]]) -> tuple[AxisInterlocks, ...]:
    """Return each axis' interlocks by its driver's reports; RobotFileError where a report is missing."""
    found = []
    for axis in robot.axes:
        interlocks = [(interlock, interlock.fitting(reports[axis.name])) for interlock in AXIS_INTERLOCKS]
        missing = [interlock.name for interlock, fitting in interlocks if fitting is None]
        if missing:
            problem = f"the devices on this link report too little for: {', '.join(missing)}"
            raise RobotFileError(robot.name, Problem(f"links.{axis.link}.driver", problem))
        link = robot.links[axis.link]
        stops = None if link.stops is None else frozenset(link.stops)
        # One weaker interlock may stand in for several.
        kept = dict.fromkeys(interlock for _, interlock in interlocks if interlock is not None)
        fitting = tuple(interlock if stops is None else interlock.confined(stops) for interlock in kept)
        found.append(AxisInterlocks(axis, link.silent_ms * MILLISECOND, fitting))
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
        self._axes = axis_interlocks(robot, reports)
        self._common: tuple[AnyInterlock, ...] = whole_robot_interlocks(rules[""].numbers, robot.links)
        self._silent_after = robot.operator.silent_ms * MILLISECOND
        self._memory = _Memory()
        self._before: AnyDecision | None = None

    def rule(self, seen: AnySnapshot) -> AnyDecision:
        """Judge the command in this snapshot; `seen.facts.now` never runs backwards."""
        rules = self._rules[seen.facts.mode]
        view = View(self._robot, seen, seen.command, NO_GROUP, self._before)
        events = self._tripped(self._common, view) + self._tripped(rules.interlocks, view)
        events += self._held_axes(seen.facts)
        stopped = _stopped(events, rules.groups)
        clipped = self._clipped(rules.limits, view, events, reported=not stopped)
        allowed = rules.kinematics.at_standstill(clipped, stopped) if stopped else clipped
        if rules.after_limits:
            requested = rules.kinematics.requested(clipped, seen.body)
            # Groups that may each move alone may be forbidden to move together, so this is judged behind the
            # limits.
            late = self._tripped(
                rules.after_limits, View(self._robot, seen, allowed, requested, self._before)
            )
            events += late
            stopped_late = _stopped(late, rules.groups)
            allowed = rules.kinematics.at_standstill(allowed, stopped_late) if stopped_late else allowed
            stopped |= stopped_late
        decision = Decision(tuple(events), stopped, allowed, rules.kinematics.requested(allowed, seen.body))
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

    def _tripped(self, interlocks: tuple[AnyInterlock, ...], view: AnyView) -> list[ActiveInterlock]:
        memory, now = self._memory, view.seen.facts.now
        events = []
        for interlock in interlocks:
            active = memory.interlock_events(interlock.name)
            # An active interlock is judged by its release threshold: a value at the limit must not flicker.
            reason = interlock.judge(view.active() if active else view)
            event = (
                memory.look(interlock.name, reason, interlock, now) if active or reason is not None else None
            )
            if event is not None:
                events.append(event)
        return events

    def _held_axes(self, facts: Facts) -> list[ActiveInterlock]:
        events, memory = [], self._memory
        for one in self._axes:
            axis = one.axis
            feedback = facts.axes.get(axis.name) or Feedback(axis.name)
            for name, interlock in one.excluded if axis.name in facts.without else one.interlocks:
                reason = interlock.judge(axis, feedback, facts, one.silent_after)
                active = reason is not None or memory.interlock_events(name)
                event = memory.look(name, reason, interlock, facts.now, axis.name) if active else None
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
        for interlock in limits:
            allowed, reason = interlock.clip(view)
            event = self._memory.look(
                interlock.name, reason if reported else None, interlock, view.seen.facts.now
            )
            if event is not None:
                events.append(event)
            # Each limit judges the command as the one before has left it: the order of the limits counts.
            if allowed is not view.allowed:
                view = View(view.robot, view.seen, allowed, NO_GROUP, view.before)
        return view.allowed


def _stopped(events: list[ActiveInterlock], groups: frozenset[Group]) -> frozenset[Group]:
    stopped = NO_GROUP
    for event in events:
        stopped |= groups if event.interlock.stops is None else event.interlock.stops
    return stopped
