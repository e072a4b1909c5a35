"""MAV_CMD by MAV_CMD: what the bridge does about it, and with which MAV_RESULT it answers.

A command that has no row is UNSUPPORTED. Sources: common.xml, MAV_CMD; MAVLink command protocol.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Final, Protocol, TypeAlias

from firmware_bridge.intent import (
    Arm,
    ClearEmergencyStop,
    Disarm,
    EmergencyStop,
    EnterMode,
    Follow,
    Request,
    ResetOdometry,
    Verdict,
)
from firmware_bridge.teleop.mavlink import dialect
from firmware_bridge.teleop.station import FASTEST
from firmware_bridge.units import NEVER, Nanoseconds

FORCE: Final = 21196
"""The second parameter of COMPONENT_ARM_DISARM that means: without checks (common.xml)."""
_LARGEST_NUMBER: Final = 0xFFFF
"""MESSAGE_INTERVAL carries 16 bits of a message's number."""


class Result(IntEnum):
    """MAV_RESULT."""

    ACCEPTED = 0
    TEMPORARILY_REJECTED = 1
    DENIED = 2
    UNSUPPORTED = 3


@dataclass(frozen=True, slots=True)
class Order:
    """One command with its seven parameters, whichever message carried it."""

    command: int
    params: tuple[float, float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Answer:
    """The result, and where it is a refusal the reason for people."""

    result: Result
    reason: str = ""


ACCEPTED: Final = Answer(Result.ACCEPTED)


class CommandContext(Protocol):
    """What a command can bring about; the robot's part of it comes from its station's rows."""

    @property
    def armed(self) -> bool:
        """Whether the robot may move, as of the newest snapshot."""

    @property
    def relays(self) -> Mapping[int, str]:
        """What each relay's number switches."""

    @property
    def illuminators(self) -> tuple[str, ...]:
        """What ILLUMINATOR_ON_OFF switches."""

    @property
    def actuators(self) -> tuple[str, ...]:
        """The actuators of set 0."""

    @property
    def modes(self) -> tuple[str, ...]:
        """The robot's modes by their custom mode; the first, "", is the whole robot's."""

    @property
    def guides(self) -> tuple[str, ...]:
        """Who makes the wishes, by the custom submode; the first, "", is the operator."""

    def request(self, request: Request) -> Verdict:
        """Ask the bridge."""

    def switch(self, relay: int, *, on: bool) -> None:
        """Switch what is behind a relay's number."""

    def illuminate(self, *, on: bool) -> None:
        """Switch everything that illuminates."""

    def actuate(self, place: int, share: float) -> None:
        """Send an actuator of set 0 to a share of its travel, 0 to 1."""

    def send(self, number: int) -> bool:
        """Send a message once; False where the bridge has none with this number."""

    def period(self, number: int) -> Nanoseconds | None:
        """Return how often a message is sent; `NEVER` for not at all, None where it is no stream."""

    def change_period(self, number: int, period: Nanoseconds | None) -> None:
        """Change how often a message is sent; `NEVER` for not at all, None for the default."""

    def send_period(self, number: int, period: Nanoseconds | None) -> None:
        """Send the MESSAGE_INTERVAL."""


Action: TypeAlias = Callable[[Order, CommandContext], Answer]


def _denied(reason: str) -> Answer:
    return Answer(Result.DENIED, reason)


def _judged(verdict: Verdict) -> Answer:
    if verdict.accepted:
        return ACCEPTED
    return Answer(Result.TEMPORARILY_REJECTED if verdict.temporary else Result.DENIED, verdict.reason)


def _arm_or_disarm(order: Order, context: CommandContext) -> Answer:
    force = order.params[1] == FORCE
    match order.params[0]:
        case 0.0:
            return _judged(context.request(Disarm(force=force)))
        case 1.0 if force:
            return _denied("arming cannot be forced: the interlocks stay")
        case 1.0:
            return _judged(context.request(Arm()))
    return _denied("arm: parameter 1 must be 0 or 1")


def _terminate(order: Order, context: CommandContext) -> Answer:
    if order.params[0] > 0.5:  # noqa: PLR2004 - the threshold of common.xml
        return _judged(context.request(EmergencyStop(final=True)))
    return _denied("termination is undone by a restart of the bridge only")


def _safety_switch(order: Order, context: CommandContext) -> Answer:
    match order.params[0]:
        case dialect.SAFETY_SWITCH_STATE_SAFE:
            return _judged(context.request(EmergencyStop()))
        case dialect.SAFETY_SWITCH_STATE_DANGEROUS:
            return _judged(context.request(ClearEmergencyStop()))
    return _denied("safety switch: parameter 1 must be 0 (stop) or 1 (clear)")


def _relay(order: Order, context: CommandContext) -> Answer:
    relay, on = order.params[:2]
    if not context.relays:
        return Answer(Result.UNSUPPORTED)
    number = _number(relay)
    if number is None or number not in context.relays:
        known = ", ".join(f"{number} {name}" for number, name in context.relays.items())
        return _denied(f"relay: {known}; there are no others")
    if on not in (0.0, 1.0):
        return _denied("relay: parameter 2 must be 0 or 1")
    context.switch(number, on=bool(on))
    return ACCEPTED


def _illuminate(order: Order, context: CommandContext) -> Answer:
    if not context.illuminators:
        return Answer(Result.UNSUPPORTED)
    if order.params[0] not in (0.0, 1.0):
        return _denied(f"{', '.join(context.illuminators)}: parameter 1 must be 0 or 1")
    context.illuminate(on=bool(order.params[0]))
    return ACCEPTED


def _actuator(order: Order, context: CommandContext) -> Answer:
    """Set actuators: NaN leaves one where it is (common.xml), and 0 one that is not there."""
    names = context.actuators
    if not names:
        return Answer(Result.UNSUPPORTED)
    shares, others = order.params[: len(names)], order.params[len(names) : 6]
    if order.params[6] != 0.0 or not all(math.isnan(other) or other == 0.0 for other in others):
        return _denied(f"actuator: set 0 has {', '.join(names)}; there are no others")
    named = [(place, share) for place, share in enumerate(shares) if not math.isnan(share)]
    beyond = [place for place, share in named if not -1.0 <= share <= 1.0]
    if not named or beyond:
        place = beyond[0] if beyond else 0
        return _denied(f"{names[place]}: parameter {place + 1} must be within -1 (lowest) and 1 (highest)")
    if not context.armed:
        return _denied(f"{names[named[0][0]]}: arm first; a target is not kept for later")
    for place, share in named:
        context.actuate(place, (share + 1.0) / 2.0)
    return ACCEPTED


def _request_message(order: Order, context: CommandContext) -> Answer:
    number = _number(order.params[0])
    sent = number is not None and context.send(number)
    return ACCEPTED if sent else Answer(Result.UNSUPPORTED)


def _capabilities(order: Order, context: CommandContext) -> Answer:
    if order.params[0] == 1.0:
        context.send(dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    return ACCEPTED


def _change_interval(order: Order, context: CommandContext) -> Answer:
    number, wish = _number(order.params[0]), order.params[1]
    if number is None or context.period(number) is None:
        return Answer(Result.UNSUPPORTED)
    if not math.isfinite(wish) or wish < -1.0:
        return _denied("message interval: parameter 2 is in microseconds, 0 for the default, -1 for off")
    if number == dialect.MAVLINK_MSG_ID_HEARTBEAT and wish != 0.0:
        return _denied("message interval: the heartbeat keeps its rate")
    if wish == 0.0:
        context.change_period(number, None)
    else:
        context.change_period(number, NEVER if wish < 0.0 else max(round(wish) * 1000, FASTEST))
    return ACCEPTED


def _send_interval(order: Order, context: CommandContext) -> Answer:
    number = _number(order.params[0])
    if number is None or number > _LARGEST_NUMBER:
        return _denied("message interval: parameter 1 must be a message number up to 65535")
    context.send_period(number, context.period(number))
    return ACCEPTED


def _set_mode(order: Order, context: CommandContext) -> Answer:
    number = _number(order.params[1])
    modes = context.modes
    if number is None or number >= len(modes):
        if len(modes) == 1:
            return _denied("this robot has one mode, 0: an operator drives it")
        known = ", ".join(f"{place} {mode or 'whole'}" for place, mode in enumerate(modes))
        return _denied(f"mode: {known}; there are no others")
    guide = _number(order.params[2]) or 0
    if guide >= len(context.guides):
        known = ", ".join(f"{place} {name or 'the operator'}" for place, name in enumerate(context.guides))
        return _denied(f"submode: {known}; there are no others")
    entered = ACCEPTED if len(modes) == 1 else _judged(context.request(EnterMode(modes[number])))
    if entered.result is not Result.ACCEPTED or len(context.guides) == 1:
        return entered
    return _judged(context.request(Follow(context.guides[guide])))


def _home(order: Order, context: CommandContext) -> Answer:
    if order.params[0] != 1.0:
        return _denied("home: only the present place (parameter 1 = 1) can be the origin")
    return _judged(context.request(ResetOdometry()))


def _reboot(_: Order, context: CommandContext) -> Answer:
    if context.armed:
        return _denied("reboot: disarm first")
    return Answer(Result.UNSUPPORTED, "reboot: restart the bridge's program where it runs")


@dataclass(frozen=True, slots=True)
class Row:
    """One command that the bridge knows."""

    command: int
    act: Action
    does: str


ROWS: Final = (
    Row(dialect.MAV_CMD_COMPONENT_ARM_DISARM, _arm_or_disarm, "arm; disarm, forced with p2 = 21196"),
    Row(dialect.MAV_CMD_DO_FLIGHTTERMINATION, _terminate, "emergency stop until the bridge is restarted"),
    Row(dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, _safety_switch, "p1 0: emergency stop; 1: clear it"),
    Row(dialect.MAV_CMD_DO_SET_ACTUATOR, _actuator, "actuators of set 0: -1 lowest to 1 highest, NaN stays"),
    Row(dialect.MAV_CMD_DO_SET_RELAY, _relay, "p1: its number; p2 0 or 1"),
    Row(dialect.MAV_CMD_ILLUMINATOR_ON_OFF, _illuminate, "p1 0 or 1"),
    Row(dialect.MAV_CMD_REQUEST_MESSAGE, _request_message, "send a message once"),
    Row(dialect.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, _capabilities, "send AUTOPILOT_VERSION"),
    Row(dialect.MAV_CMD_SET_MESSAGE_INTERVAL, _change_interval, "how often a message is sent"),
    Row(dialect.MAV_CMD_GET_MESSAGE_INTERVAL, _send_interval, "send how often a message is sent"),
    Row(
        dialect.MAV_CMD_DO_SET_MODE,
        _set_mode,
        "custom mode 0: the whole robot; others after a failed actuator; submode: the guide, 0 none",
    ),
    Row(dialect.MAV_CMD_DO_SET_HOME, _home, "p1 = 1: the present place is the origin"),
    Row(dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, _reboot, "never from afar"),
)

_BY_NUMBER: Final = {row.command: row for row in ROWS}


def obey(order: Order, context: CommandContext) -> Answer:
    """Do what an order asks, where it can be done."""
    row = _BY_NUMBER.get(order.command)
    return row.act(order, context) if row else Answer(Result.UNSUPPORTED)


def _number(parameter: float) -> int | None:
    if math.isfinite(parameter) and parameter >= 0.0 and parameter == int(parameter):
        return int(parameter)
    return None
