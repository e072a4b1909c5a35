"""MAV_CMD by MAV_CMD: what the bridge does about it, and with which MAV_RESULT it answers.

A command that has no row is UNSUPPORTED. Sources: common.xml, MAV_CMD; MAVLink command protocol.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import Final, Protocol, TypeAlias

from firmware_bridge.intent import (
    Arm,
    ClearEmergencyStop,
    Disarm,
    EmergencyStop,
    Request,
    ResetOdometry,
    Verdict,
)
from firmware_bridge.teleop.mavlink import dialect
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

FORCE: Final = 21196
"""The second parameter of COMPONENT_ARM_DISARM that means: without checks (common.xml)."""
FASTEST: Final[Nanoseconds] = 20 * MILLISECOND
"""No message is sent more often, whatever a station asks for."""
_LARGEST_TOLD: Final = 0xFFFF
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


class Desk(Protocol):
    """What a command can bring about."""

    @property
    def armed(self) -> bool:
        """Whether the robot may move, as of the newest snapshot."""

    def request(self, request: Request) -> Verdict:
        """Ask the bridge."""

    def switch(self, *, headlamp: bool | None = None, detector: bool | None = None) -> None:
        """Switch a device; None leaves it as it is."""

    def lift_to(self, share: float) -> None:
        """Send the platform to a share of its travel, 0 to 1."""

    def send(self, number: int) -> bool:
        """Send a message once; False where the bridge has none with this number."""

    def period(self, number: int) -> Nanoseconds | None:
        """Return how often a message is sent; `NEVER` for not at all, None where it is no stream."""

    def change_period(self, number: int, period: Nanoseconds | None) -> None:
        """Change how often a message is sent; `NEVER` for not at all, None for the default."""

    def tell_period(self, number: int, period: Nanoseconds | None) -> None:
        """Send the MESSAGE_INTERVAL."""


Action: TypeAlias = Callable[[Order, Desk], Answer]


def _denied(reason: str) -> Answer:
    return Answer(Result.DENIED, reason)


def _judged(verdict: Verdict) -> Answer:
    if verdict.accepted:
        return ACCEPTED
    return Answer(Result.TEMPORARILY_REJECTED if verdict.temporary else Result.DENIED, verdict.reason)


def _arm_or_disarm(order: Order, desk: Desk) -> Answer:
    force = order.params[1] == FORCE
    match order.params[0]:
        case 0.0:
            return _judged(desk.request(Disarm(force=force)))
        case 1.0 if force:
            return _denied("arming cannot be forced: the interlocks stay")
        case 1.0:
            return _judged(desk.request(Arm()))
    return _denied("arm: parameter 1 must be 0 or 1")


def _terminate(order: Order, desk: Desk) -> Answer:
    if order.params[0] > 0.5:  # noqa: PLR2004 - the threshold of common.xml
        return _judged(desk.request(EmergencyStop(final=True)))
    return _denied("termination is undone by a restart of the bridge only")


def _safety_switch(order: Order, desk: Desk) -> Answer:
    match order.params[0]:
        case dialect.SAFETY_SWITCH_STATE_SAFE:
            return _judged(desk.request(EmergencyStop()))
        case dialect.SAFETY_SWITCH_STATE_DANGEROUS:
            return _judged(desk.request(ClearEmergencyStop()))
    return _denied("safety switch: parameter 1 must be 0 (stop) or 1 (clear)")


def _relay(order: Order, desk: Desk) -> Answer:
    on = order.params[1]
    if on not in (0.0, 1.0):
        return _denied("relay: parameter 2 must be 0 or 1")
    match order.params[0]:
        case 0.0:
            desk.switch(detector=bool(on))
        case 1.0:
            desk.switch(headlamp=bool(on))
        case _:
            return _denied("relay: 0 is the detector, 1 the headlamp; there are no others")
    return ACCEPTED


def _illuminate(order: Order, desk: Desk) -> Answer:
    if order.params[0] not in (0.0, 1.0):
        return _denied("headlamp: parameter 1 must be 0 or 1")
    desk.switch(headlamp=bool(order.params[0]))
    return ACCEPTED


def _actuator(order: Order, desk: Desk) -> Answer:
    share = order.params[0]
    if order.params[6] != 0.0:
        return _denied("actuator: the lift is the first actuator of set 0; there are no others")
    if not -1.0 <= share <= 1.0:
        return _denied("lift: parameter 1 must be within -1 (collapsed) and 1 (extended)")
    if not desk.armed:
        return _denied("lift: arm first; a target is not kept for later")
    desk.lift_to((share + 1.0) / 2.0)
    return ACCEPTED


def _request_message(order: Order, desk: Desk) -> Answer:
    number = _number(order.params[0])
    sent = number is not None and desk.send(number)
    return ACCEPTED if sent else Answer(Result.UNSUPPORTED)


def _capabilities(order: Order, desk: Desk) -> Answer:
    if order.params[0] == 1.0:
        desk.send(dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    return ACCEPTED


def _change_interval(order: Order, desk: Desk) -> Answer:
    number, wish = _number(order.params[0]), order.params[1]
    if number is None or desk.period(number) is None:
        return Answer(Result.UNSUPPORTED)
    if not math.isfinite(wish) or wish < -1.0:
        return _denied("message interval: parameter 2 is in microseconds, 0 for the default, -1 for off")
    if number == dialect.MAVLINK_MSG_ID_HEARTBEAT and wish != 0.0:
        return _denied("message interval: the heartbeat keeps its rate")
    if wish == 0.0:
        desk.change_period(number, None)
    else:
        desk.change_period(number, NEVER if wish < 0.0 else max(round(wish) * 1000, FASTEST))
    return ACCEPTED


def _tell_interval(order: Order, desk: Desk) -> Answer:
    number = _number(order.params[0])
    if number is None or number > _LARGEST_TOLD:
        return _denied("message interval: parameter 1 must be a message number up to 65535")
    desk.tell_period(number, desk.period(number))
    return ACCEPTED


def _set_mode(order: Order, _: Desk) -> Answer:
    if order.params[1] == 0.0:
        return ACCEPTED
    return _denied("this robot has one mode, 0: an operator drives it")


def _home(order: Order, desk: Desk) -> Answer:
    if order.params[0] != 1.0:
        return _denied("home: only the present place (parameter 1 = 1) can be the origin")
    return _judged(desk.request(ResetOdometry()))


def _reboot(_: Order, desk: Desk) -> Answer:
    if desk.armed:
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
    Row(dialect.MAV_CMD_DO_SET_ACTUATOR, _actuator, "lift: p1 from -1 collapsed to 1 extended"),
    Row(dialect.MAV_CMD_DO_SET_RELAY, _relay, "p1 0: detector, 1: headlamp; p2 0 or 1"),
    Row(dialect.MAV_CMD_ILLUMINATOR_ON_OFF, _illuminate, "headlamp"),
    Row(dialect.MAV_CMD_REQUEST_MESSAGE, _request_message, "send a message once"),
    Row(dialect.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, _capabilities, "send AUTOPILOT_VERSION"),
    Row(dialect.MAV_CMD_SET_MESSAGE_INTERVAL, _change_interval, "how often a message is sent"),
    Row(dialect.MAV_CMD_GET_MESSAGE_INTERVAL, _tell_interval, "tell how often a message is sent"),
    Row(dialect.MAV_CMD_DO_SET_MODE, _set_mode, "custom mode 0, the only one"),
    Row(dialect.MAV_CMD_DO_SET_HOME, _home, "p1 = 1: the present place is the origin"),
    Row(dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, _reboot, "never from afar"),
)

_BY_NUMBER: Final = {row.command: row for row in ROWS}


def obey(order: Order, desk: Desk) -> Answer:
    """Do what an order asks, where it can be done."""
    row = _BY_NUMBER.get(order.command)
    return row.act(order, desk) if row else Answer(Result.UNSUPPORTED)


def _number(parameter: float) -> int | None:
    if math.isfinite(parameter) and parameter >= 0.0 and parameter == int(parameter):
        return int(parameter)
    return None
