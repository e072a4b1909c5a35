"""Who may request what, what it needs, and what it does: one row for each request.

A request is refused by the first of its needs that only someone's action fulfils, else by the first that time
may fulfil; the refusal names what to do. What is accepted is true at the next cycle. Every request is
idempotent. A motion is no request: interlocks and limits judge it in every cycle (`firmware_bridge.safety`).
Which states there are is in `firmware_bridge.bridge.joint_state`.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final

from firmware_bridge.bridge import needs
from firmware_bridge.bridge.joint_state import Event, Life
from firmware_bridge.bridge.needs import Instant, Need, Refused
from firmware_bridge.drivers.driver import Stop
from firmware_bridge.intent import (
    FORCED_DISARM,
    Answer,
    Arm,
    ChangeDriver,
    ClearEmergencyStop,
    ConfirmPosition,
    Disarm,
    EmergencyStop,
    EnterMode,
    Follow,
    Pause,
    Request,
    ResetOdometry,
    Resume,
    kind_of,
)

ALWAYS: Final = frozenset(Life) - {Life.FINISHED}
RUNNING: Final = frozenset({Life.RUNNING})
GOING_OFF: Final = frozenset({Life.FAILED, Life.LEAVING})
"""The drives are on their way to no power, and a set-point would end it."""
ALREADY_OFF: Final = Answer(accepted=True, reason="disarmed by force: the power is being disabled already")


@dataclass(frozen=True, slots=True, kw_only=True)
class Order:
    """One kind of request."""

    title: str
    lives: frozenset[Life] = RUNNING
    """Phases of the bridge in which it is obeyed."""
    going_off: frozenset[Life] = frozenset()
    """Those of them in which it is so already."""
    judged: bool = True
    """True where the active interlocks are looked at."""
    needs: tuple[Need, ...] = ()
    settled: Refused = lambda _: None
    """Return the answer where it is so already."""
    act: Callable[[Instant], Answer]
    does: str


# Effects


def _arm(it: Instant) -> Answer:
    it.permission.arm()
    return _done("armed")


def _disarm(it: Instant) -> Answer:
    # EN 60204-1, stop category 2: the drives keep their power at standstill, on a slope too.
    it.permission.happens(Event.DISARM)
    moves = "" if it.permission.rules.at_standstill(it.seen) else "the robot comes to rest, "
    return _done(f"disarmed: {moves}the drives hold still")


def _power_off(it: Instant) -> Answer:
    stop = it.permission.power_off(it.seen)
    off = stop is Stop.POWER_OFF
    return _done(
        "disarmed by force: "
        + ("the drives are without power" if off else "it brakes, then the power is disabled")
    )


def _stop(it: Instant) -> Answer:
    # EN 60204-1, stop category 1: the axes keep their power until the robot is at standstill.
    it.permission.happens(Event.TERMINATE if it.request.final else Event.STOP)
    return _done("emergency stop: it stays until it is cleared")


def _reset(it: Instant) -> Answer:
    # ISO 13850: the reset starts nothing; the robot moves only after it was armed again.
    it.permission.happens(Event.RESET)
    return _done("emergency stop cleared; arm to move")


def _pause(it: Instant) -> Answer:
    it.permission.paused = True
    return _done("paused: the robot comes to rest, and waits")


def _resume(it: Instant) -> Answer:
    it.permission.paused = False
    return _done("the robot goes on")


def _enter(it: Instant) -> Answer:
    if it.entered is None:
        return _resume(it)
    it.permission.mode = it.request.mode
    return _done(f"mode: {it.request.mode or 'the whole robot'}; arm to move")


def _follow(it: Instant) -> Answer:
    return _done(it.guide.follow(it.request.path_follower))


def _change_driver(it: Instant) -> Answer:
    it.guide.leave()
    it.permission.neutral_required = True
    return _done("")


def _reset_odometry(it: Instant) -> Answer:
    return _done(it.locating.begin_again())


def _confirm(it: Instant) -> Answer:
    driver, position = it.zeros.place(it.request)
    it.permission.set_zero(driver, position or 0.0, it.seen.facts.now)
    return _done(f"zero: {driver.axis.called} counts from there")


def _home(it: Instant) -> Answer:
    it.permission.home(it.driver, it.seen.facts.now)
    return _done(f"home: {it.driver.axis.called} is homing")


def _done(reason: str) -> Answer:
    return Answer(accepted=True, reason=reason)


# The table

REFERENCE: Final = (
    needs.AXIS_MAY_STAND_THERE,
    needs.DISARMED,
    needs.STOP_RESET,
    needs.POWER_NOT_ORDERED_OFF,
    needs.MODE_HAS_THE_AXIS,
    needs.AXIS_TRUSTED,
    needs.NO_HOMING,
    needs.STANDSTILL,
    needs.STOPS_DONE,
    needs.DRIVE_READY,
    needs.AXIS_STANDS,
)
"""Of a position that an axis is to count from."""
HOME: Final = "home"
ORDERS: Final[Mapping[Any, Order]] = MappingProxyType(
    {
        EmergencyStop: Order(title="emergency stop", lives=ALWAYS, act=_stop, does="brake, power off, latch"),
        FORCED_DISARM: Order(
            title=FORCED_DISARM,
            lives=ALWAYS,
            going_off=GOING_OFF,
            act=_power_off,
            does="brake, then disable all power",
        ),
        Disarm: Order(title="disarm", act=_disarm, does="ramp to standstill, hold with power"),
        Pause: Order(title="pause", act=_pause, does="ramp to standstill, and wait"),
        Arm: Order(
            title="arm",
            settled=lambda it: "armed already" if it.permission.armed else None,
            needs=(
                needs.STOP_RESET,
                needs.STOPS_DONE,
                needs.NO_HOMING,
                needs.LINKS,
                needs.STANDSTILL,
                needs.NEUTRAL,
                needs.NOTHING_MOVES,
                needs.DRIVES_READY,
                needs.NOT_BLOCKED,
            ),
            act=_arm,
            does="motion commands count from now on",
        ),
        ClearEmergencyStop: Order(
            title="clear",
            settled=lambda it: None if it.permission.emergency_stopped else "no emergency stop is latched",
            needs=(needs.STOP_CAN_BE_RESET, needs.STANDSTILL),
            act=_reset,
            does="disarmed; nothing starts",
        ),
        Resume: Order(
            title="continue",
            needs=(needs.NEUTRAL_AFTER_PAUSE,),
            act=_resume,
            does="go on after a pause",
        ),
        EnterMode: Order(
            title="mode",
            needs=(
                needs.MODE_KNOWN,
                needs.MODE_GOES_ON,
                needs.MODE_DISARMED,
                needs.MODE_AT_STANDSTILL,
                needs.MODE_NO_CONFIRMATION,
                needs.MODE_NO_HOMING,
                needs.MODE_KEEPS_THE_ROBOT,
            ),
            act=_enter,
            does="other axes, interlocks and limits",
        ),
        Follow: Order(
            title="path follower",
            judged=False,
            needs=(
                needs.PATH_FOLLOWER_KNOWN,
                needs.ARMED,
            ),
            act=_follow,
            does="it commands until a stick is deflected",
        ),
        ConfirmPosition: Order(
            title="zero", needs=REFERENCE, act=_confirm, does="the axis counts from there"
        ),
        HOME: Order(
            title=HOME,
            needs=(*REFERENCE, needs.NO_INTERLOCK_KEEPS_IT),
            act=_home,
            does="the axis finds its position by motion",
        ),
        ResetOdometry: Order(
            title="odometry", judged=False, act=_reset_odometry, does="the present place is the origin"
        ),
        ChangeDriver: Order(
            title="change of control", judged=False, act=_change_driver, does="neutral controls are required"
        ),
    }
)


def order_of(request: Request) -> Order:
    """Return the row of a request."""
    if isinstance(request, ConfirmPosition) and math.isnan(request.value):
        return ORDERS[HOME]
    return ORDERS[kind_of(request)]


def carry_out(order: Order, it: Instant) -> Answer:
    """Carry a request out, or say why not."""
    settled = order.settled(it)
    if settled is not None:
        return _done(settled)
    temporary: tuple[Need, str] | None = None
    for need in order.needs:
        refused = need.refused(it)
        if refused is not None and not need.temporary:
            return Answer(accepted=False, reason=_called(order, refused))
        if refused is not None and temporary is None:
            temporary = need, refused
    if temporary is None:
        return order.act(it)
    need, refused = temporary
    reason = _called(order, refused) if need.helps is None else need.helps(it)
    return Answer(accepted=False, reason=reason, temporary=True)


def _called(order: Order, refused: str) -> str:
    # What names the request itself is not named once more.
    return refused if refused.startswith(f"{order.title}: ") else f"{order.title}: {refused}"
