"""The interlocks that every robot has: operator, links, each axis; the times are this project's choice.

Whole-robot rows come first, then the robot's own, then these of each link and axis.
"""

import math
from collections.abc import Callable, Mapping
from typing import Final, TypeVar

from firmware_bridge.drivers.driver import Feedback, Power, Tells
from firmware_bridge.intent import NEVER_HEARD
from firmware_bridge.robot import Axis
from firmware_bridge.robot.table import LinkTable, Table
from firmware_bridge.safety.interlock import AxisInterlock, Interlock, View
from firmware_bridge.safety.row import Severity
from firmware_bridge.safety.snapshot import Facts
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

G = TypeVar("G", bound=Table)
M = TypeVar("M")
S = TypeVar("S")

LINK_CLEARS_AFTER: Final[Nanoseconds] = 200 * MILLISECOND
"""A silent operator or axis is back when it has been heard for this long: four cycles, no stray packet."""


def whole_robot_rows(
    numbers: Mapping[str, Callable[[M], float | None]], links: Mapping[str, LinkTable]
) -> tuple[Interlock[G, M, S], ...]:
    """Return the rows that judge no axis; `numbers` is what in a motion must be finite, by its title."""

    def wish_unusable(view: View[G, M, S]) -> str | None:
        for title, read in numbers.items():
            value = read(view.seen.wish)
            if value is not None and not math.isfinite(value):
                return f"the {title} asked for is {value}"
        return None

    return (
        Interlock(
            "emergency stop",
            _emergency_stop,
            "clear the emergency stop, then arm",
            severity=Severity.CRITICAL,
            disarms=True,
        ),
        *(_link_row(name, link) for name, link in links.items()),
        Interlock("not armed", _not_armed, "arm the robot", severity=Severity.NOTICE, blocks_arming=False),
        # Many stations arm first and speak of motion then; until they do, the silence holds the robot itself.
        Interlock(
            "operator silent",
            _operator_silent,
            "send motion commands",
            clear_after=LINK_CLEARS_AFTER,
            blocks_arming=False,
            parts=True,
        ),
        Interlock(
            "operator gone",
            _operator_gone,
            "send motion commands, then arm",
            clear_after=LINK_CLEARS_AFTER,
            disarms=True,
            blocks_arming=False,
        ),
        Interlock("controls deflected", _deflected, "let the stick go", blocks_arming=False),
        Interlock("paused", _paused, "continue, or arm", severity=Severity.NOTICE, blocks_arming=False),
        Interlock("wish unusable", wish_unusable, "send finite numbers"),
    )


def _link_row(name: str, link: LinkTable) -> Interlock[G, M, S]:
    """Return the row that holds while no device on a link can be reached.

    To disarm would stop all groups, whatever the link says that it stops.
    """

    def lost(view: View[G, M, S]) -> str | None:
        return view.facts.links_lost.get(name)

    return Interlock(
        f"link lost: {name}",
        lost,
        "plug the adapter in again, then arm",
        stops=None if link.stops is None else frozenset(link.stops),
        clear_after=LINK_CLEARS_AFTER,
        severity=Severity.CRITICAL,
        disarms=link.stops is None,
    )


def _emergency_stop(view: View[G, M, S]) -> str | None:
    return "the emergency stop is latched" if view.facts.emergency_stopped else None


def _not_armed(view: View[G, M, S]) -> str | None:
    return None if view.facts.armed else "the robot is not armed"


def _operator_silent(view: View[G, M, S]) -> str | None:
    limit = view.robot.operator.silent_ms * MILLISECOND
    if view.facts.heard_at == NEVER_HEARD:
        return "no motion command has come yet"
    silence = view.facts.now - view.facts.heard_at
    if silence < limit:
        return None
    return f"no motion command for {to_seconds(silence):.2f} s, limit {to_seconds(limit):.2f} s"


def _operator_gone(view: View[G, M, S]) -> str | None:
    limit = view.robot.operator.gone_ms * MILLISECOND
    if view.facts.heard_at == NEVER_HEARD or view.facts.now - view.facts.heard_at < limit:
        return None
    return f"no motion command for {to_seconds(limit):g} s: nobody drives"


def _deflected(view: View[G, M, S]) -> str | None:
    if view.facts.neutral or not view.facts.parted:
        return None
    return "the stick was not let go after the silence"


def _paused(view: View[G, M, S]) -> str | None:
    return "the operator has paused the robot" if view.facts.paused else None


def _axis_silent(axis: Axis, feedback: Feedback, facts: Facts, limit: Nanoseconds) -> str | None:
    if feedback.heard_at == NEVER_HEARD:
        return f"{axis.called} has never been heard"
    silence = facts.now - feedback.heard_at
    if silence < limit:
        return None
    return f"{axis.called} silent for {to_seconds(silence):.2f} s, limit {to_seconds(limit):.2f} s"


def _axis_fault(axis: Axis, feedback: Feedback, _facts: Facts, _limit: Nanoseconds) -> str | None:
    if feedback.fault:
        return f"{axis.called} reports fault {feedback.fault}"
    return f"{axis.called} is in fault, code unknown" if feedback.power is Power.FAULT else None


def _axis_not_enabled(axis: Axis, feedback: Feedback, _facts: Facts, _limit: Nanoseconds) -> str | None:
    # One that was never heard is silent, one in a fault state is faulted: one cause, one hold.
    if feedback.heard_at == NEVER_HEARD or feedback.power in {Power.FAULT, Power.ON}:
        return None
    return f"{axis.called} is not enabled: {feedback.says or 'state unknown'}"


def _axis_late(axis: Axis, feedback: Feedback, facts: Facts, limit: Nanoseconds) -> str | None:
    if feedback.heard_at == NEVER_HEARD or facts.now - feedback.heard_at < limit // 2:
        return None
    silence = to_seconds(facts.now - feedback.heard_at)
    return f"{axis.called} does not tell its power and was last heard {silence:.2f} s ago"


def _axis_left_out(axis: Axis, feedback: Feedback, facts: Facts, limit: Nanoseconds) -> str | None:
    # One that is silent hears that its power goes off, or is stopped by its own watch over the bridge.
    on = feedback.power is Power.ON and facts.now - feedback.heard_at < limit
    return f"{axis.called} has power, and this mode does without it" if on else None


AXIS_ANSWERS: Final = AxisInterlock(
    "axis answers late", _axis_late, "check its power and its cable", clear_after=LINK_CLEARS_AFTER
)
"""Stands in for "axis not enabled" where the device has no word for its power: then each answer must be
fresh, not older than half the silence that is allowed."""

AXIS_ROWS: Final = (
    AxisInterlock(
        "axis silent",
        _axis_silent,
        "check its power and its cable",
        clear_after=LINK_CLEARS_AFTER,
        severity=Severity.CRITICAL,
    ),
    AxisInterlock(
        "axis fault",
        _axis_fault,
        "remove the cause, then disarm and arm to reset the fault",
        severity=Severity.CRITICAL,
    ),
    AxisInterlock(
        "axis not enabled",
        _axis_not_enabled,
        "wait for it, or disarm and arm",
        needs=frozenset({Tells.POWER}),
        instead=AXIS_ANSWERS,
    ),
)
"""Of each axis that the robot's mode uses."""

LEFT_OUT_ROW: Final = AxisInterlock("axis left out", _axis_left_out, "wait for it, or leave this mode")
"""Of each axis that the mode does without: it must be without power, or held."""
