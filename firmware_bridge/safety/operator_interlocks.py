"""The interlocks on the station in control: its timeout, its commands' age, its controls' neutral.

They belong to every robot; `firmware_bridge.safety.common` puts them into their place.
"""

from typing import Final

from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.safety.interlock import AnyInterlock, AnyView, Interlock
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

OPERATOR_CLEARS_AFTER: Final[Nanoseconds] = 200 * MILLISECOND
"""Time of punctual reception before the operator link counts as back: four cycles, no stray packet."""


def operator_interlocks() -> tuple[AnyInterlock, ...]:
    """Return the interlocks in the order in which they are judged."""
    return (
        # Many stations arm first and speak of motion then; until they do, the silence holds the robot itself.
        Interlock(
            "operator link timeout",
            _link_timeout,
            "send motion commands",
            clear_after=OPERATOR_CLEARS_AFTER,
            blocks_arming=False,
            parts=True,
        ),
        # The operator's view is as old, and the command was right long ago. The stick may be neutral by now.
        Interlock(
            "command stale",
            _command_stale,
            "return the stick to neutral, wait for a better link; if a clock was set, take control again",
            clear_after=OPERATOR_CLEARS_AFTER,
            parts=True,
        ),
        # The clock of a station is requested once it is in control, and so after arming.
        Interlock(
            "command not timestamped",
            _not_timestamped,
            "send set-points with their time and answer TIMESYNC, or see operator.unknown_age",
            clear_after=OPERATOR_CLEARS_AFTER,
            blocks_arming=False,
            parts=True,
        ),
        Interlock(
            "operator link lost",
            _link_lost,
            "send motion commands, then arm",
            disarms=True,
        ),
        Interlock(
            "stick not neutral",
            _not_neutral,
            "return the stick to neutral, or send zero velocity",
            blocks_arming=False,
        ),
        Interlock(
            "operation paused", _paused, "continue, or arm", severity=Severity.NOTICE, blocks_arming=False
        ),
    )


def _link_timeout(view: AnyView) -> str | None:
    limit = view.facts.lives_for(view.robot.operator.silent_ms * MILLISECOND)
    if view.facts.received_at == NEVER_RECEIVED:
        return "no motion command has come yet"
    silence = view.facts.now - view.facts.received_at
    if silence < limit:
        return None
    return f"no motion command for {to_seconds(silence):.2f} s, limit {to_seconds(limit):.2f} s"


def _command_stale(view: AnyView) -> str | None:
    age, limit = view.facts.age, view.facts.age_limit.most
    if age is None or age < limit or _is_silent(view):
        return None
    least = "" if view.facts.timestamped else "at least "
    old = f"{least}{to_seconds(age):.2f} s"
    return f"the newest motion command was {old} old when it came, limit {to_seconds(limit):.2f} s"


def _not_timestamped(view: AnyView) -> str | None:
    if view.facts.timestamped or not view.facts.age_limit.needed or _is_silent(view):
        return None
    return "the age of the motion commands is unknown"


def _is_silent(view: AnyView) -> bool:
    """Return whether the operator link has timed out: one cause, one interlock event."""
    return view.facts.now - view.facts.received_at >= view.robot.operator.silent_ms * MILLISECOND


def _link_lost(view: AnyView) -> str | None:
    limit = view.robot.operator.lost_ms * MILLISECOND
    if view.facts.received_at == NEVER_RECEIVED or view.facts.now - view.facts.received_at < limit:
        return None
    return f"no motion command for {to_seconds(limit):g} s: no station in control"


def _not_neutral(view: AnyView) -> str | None:
    # A stick that is still deflected after a timeout would drive off by itself when the link is back.
    if view.facts.neutral or not view.facts.neutral_required:
        return None
    return f"not neutral since the timeout: {view.facts.deflected or 'the stick'}"


def _paused(view: AnyView) -> str | None:
    return "the operator has paused the robot" if view.facts.paused else None
