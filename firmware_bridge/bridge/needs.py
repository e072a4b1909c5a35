"""What requests need: predicates over an instant, each with its refusal for people.

A predicate changes nothing; what begins what is missing (`Need.helps`) is called by the table alone.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from firmware_bridge.bridge.guide import Guide
from firmware_bridge.bridge.locating import Locating
from firmware_bridge.bridge.permission import Permission
from firmware_bridge.bridge.zeros import Zeros
from firmware_bridge.drivers.driver import Driver
from firmware_bridge.safety.rules import Rules
from firmware_bridge.safety.snapshot import ActiveInterlock, AnySnapshot


@dataclass(frozen=True, slots=True)
class Instant:
    """What a request is judged by."""

    title: str
    """Of the request."""
    request: Any
    seen: AnySnapshot
    events: tuple[ActiveInterlock, ...]
    """The active interlocks; of a request for one axis those that stop it."""
    permission: Permission
    zeros: Zeros
    guide: Guide
    locating: Locating

    @property
    def driver(self) -> Driver:
        """The device of the axis that a request names, which has passed `AXIS_MAY_STAND_THERE`."""
        return self.zeros.place(self.request)[0]

    @property
    def entered(self) -> Rules | None:
        """The rules of the mode that a request names; None where it is unknown, or the present one."""
        mode = self.request.mode
        return None if mode == self.permission.mode else self.permission.modes.get(mode)


Refused: TypeAlias = Callable[[Instant], str | None]


@dataclass(frozen=True, slots=True)
class Need:
    """What has to be so for a request, and its refusal where it is not."""

    text: str
    refused: Refused
    temporary: bool = False
    """True where waiting may fulfil it; else an action is needed."""
    helps: Callable[[Instant], str] | None = None
    """Begin what fulfils it, where no other need comes first, and return the refusal."""


def _no_stop_latched(it: Instant) -> str | None:
    return "the emergency stop is latched; clear it first" if it.permission.emergency_stopped else None


def _no_stop_escalates(it: Instant) -> str | None:
    stops = it.permission.stops
    return stops.interlock_events[0].reason if stops.escalating else None


def _no_axis_homes(it: Instant) -> str | None:
    return next((f"{event.reason}; {event.remedy}" for event in it.permission.homing.under_way), None)


def _links_are_there(it: Instant) -> str | None:
    return next((f"{lost}; plug it in again" for lost in it.seen.facts.links_lost.values()), None)


def _at_standstill(it: Instant) -> str | None:
    return None if it.permission.rules.at_standstill(it.seen) else "the robot still moves"


def _controls_are_neutral(it: Instant) -> str | None:
    facts = it.seen.facts
    return None if facts.neutral else facts.deflected or "the stick is not neutral"


def _nothing_would_move(it: Instant) -> str | None:
    """Refuse where something would move as soon as the robot is _armed."""
    requested = it.permission.rules.kinematics.requested(it.seen.command, it.seen.body)
    moved = " and ".join(sorted(requested))
    return f"the {moved} would move at once; return the stick to neutral, or disarm" if requested else None


def _asleep(it: Instant) -> list[Driver]:
    """Return the devices that are to be enabled: all of them, where their power was ordered off."""
    permission = it.permission
    return [
        driver
        for driver in permission.used
        if permission.powered_off or not permission.ready(driver, it.seen.facts.now)
    ]


def _drives_are_ready(it: Instant) -> str | None:
    return "a drive is not ready" if _asleep(it) else None


def _enable_all(it: Instant) -> str:
    # Enabling is all that this request does: motion needs another one, made when the drives are ready.
    return it.permission.awaken(_asleep(it), it.seen.facts.now)


def _no_interlock_blocks(it: Instant) -> str | None:
    blocking = (event for event in it.events if event.interlock.blocks_arming)
    return next((f"{event.reason}; {event.remedy}" for event in blocking), None)


def _can_be_reset(it: Instant) -> str | None:
    return "this emergency stop is cleared by a restart of the bridge only" if it.permission.final else None


def _goes_on_neutral(it: Instant) -> str | None:
    return _controls_are_neutral(it) if it.permission.paused else None


def _mode_is_known(it: Instant) -> str | None:
    modes = it.permission.modes
    if it.request.mode in modes:
        return None
    known = ", ".join(name for name in modes if name) or "none"
    return f"this robot has no '{it.request.mode}'; it has {known}"


def _mode_stays_paused(it: Instant) -> str | None:
    # A request for the present mode is one to go on.
    return _goes_on_neutral(it) if it.request.mode == it.permission.mode else None


def _mode_begins_disarmed(it: Instant) -> str | None:
    return "stop and disarm first" if it.entered is not None and it.permission.armed else None


def _mode_begins_at_standstill(it: Instant) -> str | None:
    rules = it.entered
    # By the mode's own body: an axis that it does without, and that is silent, is not known to be still.
    moves = rules is not None and not rules.at_standstill(rules.sensed(it.seen))
    return "stop and disarm first" if moves else None


def _no_position_is_written(it: Instant) -> str | None:
    # An axis that the mode does without loses its power, and with it the position that is being written.
    waiting = it.permission.under_confirmation(it.seen.facts.now) if it.entered is not None else ()
    return next(
        (f"the position of {driver.axis.called} is being confirmed; wait" for driver in waiting), None
    )


def _mode_interrupts_no_homing(it: Instant) -> str | None:
    return _no_axis_homes(it) if it.entered is not None else None


def _mode_keeps_the_robot(it: Instant) -> str | None:
    rules = it.entered
    return None if rules is None else it.permission.keeps_power(rules, it.seen.facts.now)


def _path_follower_is_known(it: Instant) -> str | None:
    return it.guide.unknown(it.request.path_follower)


def _armed(it: Instant) -> str | None:
    return "arm the robot first" if it.request.path_follower and not it.permission.armed else None


def _axis_may_stand_there(it: Instant) -> str | None:
    return it.zeros.refuses(it.request)


def _disarmed(it: Instant) -> str | None:
    return "disarm first" if it.permission.armed else None


def _power_was_not_ordered_off(it: Instant) -> str | None:
    return "the power was disabled by force; arm once, that enables it" if it.permission.powered_off else None


def _mode_has_the_axis(it: Instant) -> str | None:
    axis = it.driver.axis
    if axis.name not in it.permission.rules.without:
        return None
    return f"this mode excludes {axis.called}; leave it, confirm, then enter it again"


def _axis_is_trusted(it: Instant) -> str | None:
    axis = it.driver.axis
    if axis.name not in it.permission.untrusted:
        return None
    return f"the power of {axis.called} was disabled; arm once, that enables it"


def _drive_is_ready(it: Instant) -> str | None:
    return None if it.permission.ready(it.driver, it.seen.facts.now) else "the drive is not ready"


def _enable_one(it: Instant) -> str:
    return f"{it.title}: {it.permission.prepare(it.driver, it.seen.facts.now)}"


def _axis_stands(it: Instant) -> str | None:
    driver = it.driver
    moves = abs(driver.feedback.velocity) > driver.axis.standstill_below
    return f"{driver.axis.called} moves" if moves else None


def _no_interlock_keeps_it(it: Instant) -> str | None:
    event = it.permission.homing.kept_by(it.driver.axis, it.events)
    return None if event is None else f"{event.reason}; {event.remedy}"


STOP_RESET: Final = Need("the emergency stop is reset", _no_stop_latched)
STOP_CAN_BE_RESET: Final = Need("the stop can be reset", _can_be_reset)
STOPS_DONE: Final = Need("no stop escalates", _no_stop_escalates, temporary=True)
NO_HOMING: Final = Need("no axis is homing", _no_axis_homes, temporary=True)
LINKS: Final = Need("every link is there", _links_are_there, temporary=True)
STANDSTILL: Final = Need("the robot is at standstill", _at_standstill, temporary=True)
NEUTRAL: Final = Need("the controls are neutral", _controls_are_neutral)
NEUTRAL_AFTER_PAUSE: Final = Need("the controls are neutral after a pause", _goes_on_neutral)
NOTHING_MOVES: Final = Need("nothing would move at once", _nothing_would_move)
DRIVES_READY: Final = Need("every drive is ready", _drives_are_ready, temporary=True, helps=_enable_all)
NOT_BLOCKED: Final = Need("no interlock blocks arming", _no_interlock_blocks, temporary=True)
MODE_KNOWN: Final = Need("the robot has the mode", _mode_is_known)
MODE_GOES_ON: Final = Need("the present mode goes on with neutral controls", _mode_stays_paused)
MODE_DISARMED: Final = Need("the robot is disarmed, for another mode", _mode_begins_disarmed)
MODE_AT_STANDSTILL: Final = Need(
    "it is at standstill by the mode's axes", _mode_begins_at_standstill, temporary=True
)
MODE_NO_CONFIRMATION: Final = Need("no position is being confirmed", _no_position_is_written, temporary=True)
MODE_NO_HOMING: Final = Need("no axis is homing", _mode_interrupts_no_homing, temporary=True)
MODE_KEEPS_THE_ROBOT: Final = Need(
    "no axis that loses its power holds the robot", _mode_keeps_the_robot, temporary=True
)
PATH_FOLLOWER_KNOWN: Final = Need("the robot has the path follower", _path_follower_is_known)
ARMED: Final = Need("the robot is armed", _armed)
AXIS_MAY_STAND_THERE: Final = Need("the axis may stand there", _axis_may_stand_there)
DISARMED: Final = Need("the robot is disarmed", _disarmed)
POWER_NOT_ORDERED_OFF: Final = Need("the power was not ordered off", _power_was_not_ordered_off)
MODE_HAS_THE_AXIS: Final = Need("the mode has the axis", _mode_has_the_axis)
AXIS_TRUSTED: Final = Need("no interlock has taken the axis' power", _axis_is_trusted)
DRIVE_READY: Final = Need("its drive is ready", _drive_is_ready, temporary=True, helps=_enable_one)
AXIS_STANDS: Final = Need("the axis stands still", _axis_stands, temporary=True)
NO_INTERLOCK_KEEPS_IT: Final = Need("no interlock keeps the axis", _no_interlock_keeps_it, temporary=True)
