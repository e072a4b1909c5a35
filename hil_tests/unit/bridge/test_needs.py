"""The table of requests, stated once more: which needs each has, and how it goes through them."""

from dataclasses import replace
from itertools import product
from types import SimpleNamespace
from typing import Any, Final

import pytest

from firmware_bridge.bridge import needs
from firmware_bridge.bridge.joint_state import Life
from firmware_bridge.bridge.needs import Instant, Need
from firmware_bridge.bridge.orders import ORDERS, Order, carry_out
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.intent import OF_ANYONE, Answer, Arm, EmergencyStop, EnterMode
from hil_tests.unit.bridge.bench import ACCEPTED, ARM, DENIED, LIFT, STANDS, TEMPORARILY_REJECTED, Bench

pytestmark = pytest.mark.interpreted

PLACE: Final = (
    "the axis may stand there",
    "the robot is disarmed",
    "the emergency stop is reset",
    "the power was not ordered off",
    "the mode has the axis",
    "no interlock has taken the axis' power",
    "no axis is homing ...",
    "the robot is at standstill ...",
    "no stop escalates ...",
    "its drive is ready ...",
    "the axis stands still ...",
)
NEEDS: Final[dict[str, tuple[str, ...]]] = {
    "emergency stop": (),
    "forced disarm": (),
    "disarm": (),
    "pause": (),
    "arm": (
        "the emergency stop is reset",
        "no stop escalates ...",
        "no axis is homing ...",
        "every link is there ...",
        "the robot is at standstill ...",
        "the controls are neutral",
        "nothing would move at once",
        "every drive is ready ...",
        "no interlock blocks arming ...",
    ),
    "clear": ("the stop can be reset", "the robot is at standstill ..."),
    "continue": ("the controls are neutral after a pause",),
    "mode": (
        "the robot has the mode",
        "the present mode goes on with neutral controls",
        "the robot is disarmed, for another mode",
        "it is at standstill by the mode's axes ...",
        "no position is being confirmed ...",
        "no axis is homing ...",
        "no axis that loses its power holds the robot ...",
    ),
    "path follower": ("the robot has the path follower", "the robot is armed"),
    "zero": PLACE,
    "home": (*PLACE, "no interlock keeps the axis ..."),
    "odometry": (),
    "change of control": (),
}
"""By request; one with dots waits."""


def test_no_need_of_a_request_is_lost() -> None:
    found = {
        order.title: tuple(f"{need.text}{' ...' if need.temporary else ''}" for need in order.needs)
        for order in ORDERS.values()
    }
    assert found == NEEDS


def test_a_stop_and_a_forced_disarm_are_obeyed_of_anyone_in_every_phase_and_nothing_else_is() -> None:
    always = frozenset(Life) - {Life.FINISHED}
    stops = {key for key, order in ORDERS.items() if order.lives == always}
    assert stops == OF_ANYONE
    assert {key for key, order in ORDERS.items() if order.lives == {Life.RUNNING}} == ORDERS.keys() - stops


def made(*wanted: Need) -> tuple[Order, list[str]]:
    """Return an order with these needs, and what it has done."""
    done: list[str] = []

    def act(_: Instant) -> Answer:
        done.append("acted")
        return Answer(accepted=True, reason="done")

    return replace(ORDERS[Arm], settled=lambda _: None, needs=wanted, act=act), done


@pytest.mark.parametrize("refused", [*product((False, True), repeat=3)])
def test_the_first_that_lasts_is_the_reason_else_the_first_that_waits(refused: tuple[bool, ...]) -> None:
    waits, lasts, later = refused
    order, done = made(
        Need("a", lambda _: "waits" if waits else None, temporary=True),
        Need("b", lambda _: "lasts" if lasts else None),
        Need("c", lambda _: "waits, too" if later else None, temporary=True),
    )
    it: Any = None
    answer = carry_out(order, it)
    expected = "arm: lasts" if lasts else "arm: waits" if waits else "arm: waits, too" if later else "done"
    assert (answer.reason, answer.accepted, answer.temporary) == (
        expected,
        not any(refused),
        any(refused) and not lasts,
    )
    assert done == ([] if any(refused) else ["acted"])


@pytest.mark.parametrize("before", ["nothing", "what waits", "what lasts"])
def test_what_is_missing_is_begun_where_no_other_need_comes_first(before: str) -> None:
    begun: list[str] = []

    def helps(_: Instant) -> str:
        begun.append("begun")
        return "enabling, repeat it then"

    order, done = made(
        Need("a", lambda _: "waits" if before == "what waits" else None, temporary=True),
        Need("b", lambda _: "missing", temporary=True, helps=helps),
        Need("c", lambda _: "lasts" if before == "what lasts" else None),
    )
    it: Any = None
    answer = carry_out(order, it)
    assert not answer.accepted
    assert (begun, done) == (["begun"] if before == "nothing" else [], [])


def test_what_is_so_already_needs_nothing() -> None:
    order, done = made(Need("a", lambda _: "lasts"))
    it: Any = None
    answer = carry_out(replace(order, settled=lambda _: "it is so"), it)
    assert (answer, done) == (Answer(accepted=True, reason="it is so"), [])


def test_an_axis_whose_power_was_taken_is_given_no_position(started: Bench) -> None:
    permission: Any = started.bridge._permission  # noqa: SLF001 - what an interlock does
    permission.untrusted.add("lift")
    assert started.commands(STANDS, LIFT, 0.1) == DENIED
    assert "zero: the power of node 4 (scissor lift) was disabled; arm once" in started.reported()


def test_while_a_stop_escalates_nothing_is_armed_and_no_axis_is_given_a_position(
    started: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    stops: Any = started.bridge._permission.stops  # noqa: SLF001 - as above
    event = started.bridge.interlock_events[0]
    monkeypatch.setattr(type(stops), "escalating", property(lambda _: True))
    stops.interlock_events = (replace(event, reason="its stop escalates"),)
    assert started.arms() == TEMPORARILY_REJECTED
    assert "arm: its stop escalates" in started.reported()
    stops.interlock_events = (replace(event, reason="its stop escalates"),)
    assert started.commands(STANDS, LIFT, 0.1) == TEMPORARILY_REJECTED
    assert "zero: its stop escalates" in started.reported()


def test_an_emergency_stop_needs_nothing() -> None:
    assert ORDERS[EmergencyStop].needs == ()


def instant(**permission: Any) -> Any:
    """Return an instant of a request for another mode, with this of the permission's."""
    rules = SimpleNamespace(
        kinematics=SimpleNamespace(requested=lambda *_: frozenset(permission.pop("requested", ()))),
        at_standstill=lambda _: True,
        sensed=lambda seen: seen,
        carriers=frozenset({"left"}),
    )
    facts = SimpleNamespace(now=5, neutral=True, deflected="")
    seen = SimpleNamespace(command=None, body=None, facts=facts)
    found = SimpleNamespace(
        rules=rules, modes={"": rules, "other": rules}, mode="", armed=False, **permission
    )
    return SimpleNamespace(permission=found, seen=seen, events=(), request=EnterMode("other"), entered=rules)


def test_what_would_move_at_once_is_named() -> None:
    assert needs.NOTHING_MOVES.refused(instant()) is None
    reason = needs.NOTHING_MOVES.refused(instant(requested=("lift", "base")))
    assert reason == "the base and lift would move at once; return the stick to neutral, or disarm"


def test_another_mode_interrupts_no_homing_and_the_present_one_may_go_on() -> None:
    event = SimpleNamespace(reason="the lift is homing", remedy="wait")
    homing = SimpleNamespace(under_way=(event,))
    it = instant(homing=homing)
    assert needs.MODE_NO_HOMING.refused(it) == "the lift is homing; wait"
    it.entered = None
    assert needs.MODE_NO_HOMING.refused(it) is None
    assert needs.MODE_NO_HOMING.refused(instant(homing=SimpleNamespace(under_way=()))) is None


def test_a_mode_takes_no_power_that_holds_the_robot() -> None:
    seen: list[Any] = []

    def keeps_power(rules: Any, now: int) -> str:
        seen.append((rules.carriers, now))
        return "the left wheel holds it"

    it = instant(keeps_power=keeps_power)
    assert needs.MODE_KEEPS_THE_ROBOT.refused(it) == "the left wheel holds it"
    assert seen == [(frozenset({"left"}), 5)]
    it.entered = None
    assert needs.MODE_KEEPS_THE_ROBOT.refused(it) is None


def test_the_power_of_the_axes_that_a_mode_does_without_is_looked_at(started: Bench) -> None:
    permission: Any = started.bridge._permission  # noqa: SLF001 - what a mode change looks at
    looked: list[Any] = []

    def kept_by(axes: frozenset[str], now: int) -> str:
        looked.append((axes, now))
        return "held with power"

    permission.power_down = SimpleNamespace(kept_by=kept_by)
    rules: Any = SimpleNamespace(carriers=frozenset({"left"}))
    assert permission.keeps_power(rules, 7) == "held with power; block the wheels, then disarm by force"
    assert looked == [(frozenset({"left"}), 7)]


@pytest.mark.parametrize("requested", [1, 2, 3])
def test_an_operator_who_arms_at_the_instant_of_a_forced_disarm_is_refused_until_they_report(
    armed: Bench, requested: int
) -> None:
    """Its drives' reports are older than the order: none of them counts, however often it is requested."""
    assert armed.commands(ARM, 0.0, 21196.0) == ACCEPTED
    for _ in range(requested):
        assert armed.arms() == TEMPORARILY_REJECTED
    armed.runs(1.0)
    assert armed.arms() in {ACCEPTED, TEMPORARILY_REJECTED}
    armed.runs(1.0)
    assert armed.arms() == ACCEPTED
    assert {drive.state for drive in armed.drives.values()} == {PowerState.OPERATION_ENABLED}
