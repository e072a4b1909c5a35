"""The interlocks that every robot has: operator, links, each axis; the times are this project's choice.

Whole-robot interlocks come first, then the robot's own, then these of each link and axis.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any, Final

from firmware_bridge.drivers.driver import Feedback, Homed, Position, Power, Reports, Speed
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import Axis
from firmware_bridge.robot.table import LinkTable
from firmware_bridge.safety.interlock import AnyInterlock, AnyView, AxisInterlock, Interlock
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.operator_interlocks import operator_interlocks
from firmware_bridge.safety.snapshot import Facts, Tracking
from firmware_bridge.safety.tracking import within
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

LINK_CLEARS_AFTER: Final[Nanoseconds] = 200 * MILLISECOND
"""Time after which an axis or a link counts as well again: four cycles, no stray packet."""
BATTERY_CLEARS_AFTER: Final[Nanoseconds] = 5000 * MILLISECOND
"""It recovers where nothing moves; what it gives for so long it gives to the next start, too."""
HALTS: Final[Nanoseconds] = 40 * MILLISECOND
"""An axis that turned as commanded cannot stand so long to the last bit, if nothing blocks it: its encoder
is off, and a board's own loop is at full power 0.1 s later."""
STRAINS: Final = 2
"""Factor on its permitted deviation time for which an axis may draw more current than holding takes."""


def whole_robot_interlocks(
    numbers: Mapping[str, Callable[[Any], float | None]], links: Mapping[str, LinkTable]
) -> tuple[AnyInterlock, ...]:
    """Return the interlocks that judge no axis; `numbers` is what in a motion must be finite, by title."""

    def command_unusable(view: AnyView) -> str | None:
        for title, read in numbers.items():
            value = read(view.seen.command)
            # min and max leave a NaN as it is, so no limit behind this would take it out of the command.
            if value is not None and not math.isfinite(value):
                return f"the {title} requested is {value}"
        return None

    return (
        Interlock(
            "emergency stop",
            _emergency_stop,
            "clear the emergency stop, then arm",
            severity=Severity.CRITICAL,
            disarms=True,
        ),
        # Whatever its devices, its operator and the robot did meanwhile, no one has watched it.
        Interlock(
            "bridge stalled",
            _bridge_stalled,
            "let the bridge's process run, then arm",
            severity=Severity.CRITICAL,
            disarms=True,
        ),
        *(_link_interlock(name, link) for name, link in links.items()),
        *(_second_controller(name, link) for name, link in links.items()),
        Interlock(
            "battery low",
            _battery_low,
            "charge the battery",
            clear_after=BATTERY_CLEARS_AFTER,
            severity=Severity.CRITICAL,
            disarms=True,
        ),
        Interlock("not armed", _not_armed, "arm the robot", severity=Severity.NOTICE, blocks_arming=False),
        *operator_interlocks(),
        Interlock("command unusable", command_unusable, "send finite numbers"),
    )


def _link_interlock(name: str, link: LinkTable) -> AnyInterlock:
    """Return the interlock that is active while no device on a link can be reached.

    A disarm would stop all groups, even where the link stops only some of them.
    """

    def lost(view: AnyView) -> str | None:
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


def _second_controller(name: str, link: LinkTable) -> AnyInterlock:
    """Return the interlock that is active while a second controller sends on a link."""

    def received(view: AnyView) -> str | None:
        return view.facts.masters.get(name)

    return Interlock(
        f"second controller: {name}",
        received,
        "end the other program, or take it off the bus, then arm",
        stops=None if link.stops is None else frozenset(link.stops),
        clear_after=LINK_CLEARS_AFTER,
        severity=Severity.CRITICAL,
        disarms=link.stops is None,
    )


def _emergency_stop(view: AnyView) -> str | None:
    return "the emergency stop is latched" if view.facts.emergency_stopped else None


def _bridge_stalled(view: AnyView) -> str | None:
    # It may look away for as long as its operator may be silent.
    stood, limit = view.facts.stood_still, view.robot.operator.silent_ms * MILLISECOND
    if stood < limit:
        return None
    return f"the bridge itself did nothing for {to_seconds(stood):.2f} s, limit {to_seconds(limit):.2f} s"


def _battery_low(view: AnyView) -> str | None:
    """Judge at once while disarmed, and while armed when the voltage has been low for its time."""
    battery, since = view.robot.battery, view.facts.battery_low_since
    if battery is None or since is None:
        return None
    low = to_seconds(view.facts.now - since)
    if view.facts.armed and low < battery.stops_after_s:
        return None
    return f"the battery has been below {battery.low_v:g} V for {low:.1f} s"


def _not_armed(view: AnyView) -> str | None:
    return None if view.facts.armed else "the robot is not armed"


def _axis_timeout(axis: Axis, feedback: Feedback, facts: Facts, limit: Nanoseconds) -> str | None:
    if feedback.received_at == NEVER_RECEIVED:
        return f"{axis.called} has not reported yet"
    # Counted from the arrival, not from the sample: this judges the link and the life of the device.
    silence = facts.now - feedback.received_at
    if silence < limit:
        return None
    return f"{axis.called} silent for {to_seconds(silence):.2f} s, limit {to_seconds(limit):.2f} s"


def _axis_fault(axis: Axis, feedback: Feedback, _facts: Facts, _limit: Nanoseconds) -> str | None:
    if feedback.fault:
        return f"{axis.called} reports fault {feedback.fault}"
    return f"{axis.called} is in fault, code unknown" if feedback.power is Power.FAULT else None


def _axis_reconfigured(axis: Axis, feedback: Feedback, _facts: Facts, _limit: Nanoseconds) -> str | None:
    if not feedback.rewritten:
        return None
    return f"{axis.called}: someone else has written to it, {feedback.rewritten}"


def _axis_not_enabled(axis: Axis, feedback: Feedback, _facts: Facts, _limit: Nanoseconds) -> str | None:
    # An axis never received has timed out, one in a fault state is faulted: one cause, one interlock event.
    if feedback.received_at == NEVER_RECEIVED or feedback.power in (Power.FAULT, Power.ON):
        return None
    return f"{axis.called} is not enabled: {feedback.text or 'state unknown'}"


def _reference_lost(axis: Axis, feedback: Feedback, facts: Facts, _limit: Nanoseconds) -> str | None:
    # An axis never received has timed out: one cause, one interlock event.
    if feedback.received_at == NEVER_RECEIVED or not (axis.needs_confirmation and feedback.reference_lost):
        return None
    return f"{axis.called}: its reference is lost, position unknown{_stood(axis, facts)}"


def _stood(axis: Axis, facts: Facts) -> str:
    known = facts.stood.get(axis.name)
    last = "" if known is None else f" (last known: {known})"
    return last if axis.zero.homing is None else f"{last}; home it (drive --home, or MAV_CMD_USER_1 with NaN)"


def _axis_restarted(axis: Axis, feedback: Feedback, facts: Facts, _limit: Nanoseconds) -> str | None:
    if feedback.received_at == NEVER_RECEIVED or not (axis.needs_confirmation and feedback.reference_lost):
        return None
    begun = f"{axis.called} has restarted, or was not confirmed since the bridge began"
    return f"{begun}: position unknown{_stood(axis, facts)}"


def _tracking_error(axis: Axis, _feedback: Feedback, facts: Facts, limit: Nanoseconds) -> str | None:
    known = facts.following.get(axis.name)
    if known is None or known.obeyed_at == known.sampled_at or known.uncommanded:
        return None
    return _deviation(axis, known, limit)


def _uncommanded_motion(axis: Axis, _feedback: Feedback, facts: Facts, limit: Nanoseconds) -> str | None:
    known = facts.following.get(axis.name)
    return None if known is None or not known.uncommanded else _deviation(axis, known, limit)


def _deviation(axis: Axis, known: Tracking, limit: Nanoseconds) -> str | None:
    strayed = known.sampled_at - known.obeyed_at
    if strayed < within(axis, limit):
        return None
    return f"{_did(axis, known)} for {to_seconds(strayed):.2f} s"


def _position_not_changing(axis: Axis, feedback: Feedback, facts: Facts, limit: Nanoseconds) -> str | None:
    """Judge a position that does not change by a bit although set-point or current indicates motion.

    The current may be older than the position: on a serial line it takes turns with others.
    """
    known = facts.following.get(axis.name)
    if known is None or known.place_at == known.sampled_at:
        return None
    bound = within(axis, limit)
    backlog = known.sampled_at - known.settled_at
    stands, pulls = known.sampled_at - known.place_at, abs(feedback.current_a or 0.0)
    if known.halted and stands >= HALTS:
        return f"{_did(axis, known)}: it turned, and {to_seconds(stands):.2f} s later has not moved by a bit"
    # One that does not follow is stopped at once: here it must not wait for a backlog of that time, too.
    if backlog >= bound or (stands >= bound // 2 and _tracking_error(axis, feedback, facts, limit)):
        return f"{_did(axis, known)}: its position has not changed by a bit for {to_seconds(stands):.2f} s"
    if stands >= STRAINS * bound and not pulls <= axis.holds_with:
        standing = to_seconds(stands)
        return f"{axis.called} pulls with {pulls:.1f} A, and has not moved by a bit for {standing:.2f} s"
    return None


def _did(axis: Axis, known: Tracking) -> str:
    """Return the text of an axis' set-point beside its measured motion."""
    unit, set_point = axis.unit, known.set_point
    if isinstance(set_point, Position):
        did = f"commanded to {set_point.value:.3f} {unit}, is at {known.position:.3f} {unit}"
    elif isinstance(set_point, Speed):
        did = f"commanded {set_point.value:.2f} {unit}/s, moves with {known.velocity:.2f} {unit}/s"
    elif isinstance(set_point, Homed):
        did = f"homing, moves with {known.velocity:.2f} {unit}/s"
    else:
        did = f"commanded to stop, moves with {known.velocity:.2f} {unit}/s"
    return f"{axis.called}, {did}"


def _late_answer(axis: Axis, feedback: Feedback, facts: Facts, limit: Nanoseconds) -> str | None:
    if feedback.received_at == NEVER_RECEIVED or facts.now - feedback.received_at < limit // 2:
        return None
    silence = to_seconds(facts.now - feedback.received_at)
    return f"{axis.called} reports no power state, and answered {silence:.2f} s ago"


def _axis_excluded(axis: Axis, feedback: Feedback, facts: Facts, limit: Nanoseconds) -> str | None:
    # A silent axis receives its power-off command, or is stopped by its own watchdog on the bridge.
    on = feedback.power is Power.ON and facts.now - feedback.received_at < limit
    return f"{axis.called} has power, but this mode excludes it" if on else None


LATE_ANSWER: Final = AxisInterlock(
    "late answer", _late_answer, "check its power and its cable", clear_after=LINK_CLEARS_AFTER
)
"""The replacement of "axis not enabled" where the device reports no power.

Each answer must be fresh then, not older than half the permitted silence.
"""


def _no_feedback(axis: Axis, feedback: Feedback, facts: Facts, limit: Nanoseconds) -> str | None:
    if feedback.received_at == NEVER_RECEIVED or facts.now - feedback.received_at < limit // 2:
        return None
    silence = to_seconds(facts.now - feedback.received_at)
    return f"{axis.called} reports no motion, and answered {silence:.2f} s ago"


NO_FEEDBACK: Final = AxisInterlock(
    "no feedback", _no_feedback, "check its power and its cable", clear_after=LINK_CLEARS_AFTER
)
"""The replacement of the interlocks on axis motion where the device measures none.

Each answer must still be fresh. A tracking error goes unnoticed.
"""

CONFIRM_POSITION: Final = "look where it stands, and confirm it (drive --zero, or MAV_CMD_USER_1)"

AXIS_RESTARTED: Final = AxisInterlock(
    "axis restarted", _axis_restarted, CONFIRM_POSITION, severity=Severity.CRITICAL
)
"""The replacement of "reference lost" where the device reports no reference.

The reference is lost when the bridge starts and when the device reports a restart. An unreported restart
passes unnoticed.
"""

MEASURED: Final = frozenset({Reports.POSITION, Reports.VELOCITY})

AXIS_INTERLOCKS: Final = (
    AxisInterlock(
        "axis timeout",
        _axis_timeout,
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
        "axis reconfigured",
        _axis_reconfigured,
        "end the other program, or take it off the bus, then arm: it is set up again",
        severity=Severity.CRITICAL,
        disables_power=True,
    ),
    AxisInterlock(
        "axis not enabled",
        _axis_not_enabled,
        "wait for it, or disarm and arm",
        needs=frozenset({Reports.POWER}),
        replacement=LATE_ANSWER,
    ),
    AxisInterlock(
        "reference lost",
        _reference_lost,
        CONFIRM_POSITION,
        needs=frozenset({Reports.ZERO}),
        replacement=AXIS_RESTARTED,
        severity=Severity.CRITICAL,
    ),
    AxisInterlock(
        "tracking error",
        _tracking_error,
        "look what holds it, or whether its drive obeys, then arm",
        needs=MEASURED,
        replacement=NO_FEEDBACK,
        clear_after=LINK_CLEARS_AFTER,
        severity=Severity.CRITICAL,
    ),
    AxisInterlock(
        "uncommanded motion",
        _uncommanded_motion,
        "cut its power, look who commands it, then arm",
        needs=MEASURED,
        replacement=NO_FEEDBACK,
        clear_after=LINK_CLEARS_AFTER,
        severity=Severity.CRITICAL,
        disables_power=True,
    ),
    AxisInterlock(
        "position not changing",
        _position_not_changing,
        "look what blocks it; check its encoder and the encoder's coupling, then arm",
        needs=MEASURED,
        replacement=NO_FEEDBACK,
        clear_after=LINK_CLEARS_AFTER,
        severity=Severity.CRITICAL,
        disables_power=True,
    ),
)
"""Of each axis that the robot's mode uses."""

EXCLUDED_AXIS: Final = AxisInterlock("axis excluded", _axis_excluded, "wait for it, or leave this mode")
"""Of each axis that the mode does without: it must be without power, or held."""
