"""Standstill of a robot without power, at both edges of each time and bound; above paper devices."""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import pytest

from firmware_bridge.bridge.power_down import AVERAGED, LOOKED_WITHIN, LOOKS_FOR, SLIPS_S, WATCHED_FOR
from firmware_bridge.bridge.power_down import PowerDown as Down
from firmware_bridge.bridge.power_down import PowerDownStage as Stage
from firmware_bridge.drivers.driver import Power, Reports, Stop
from firmware_bridge.drivers.life_cycle import DriverState, Transition
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.unit.pipeline.cart import FakeCart, cart

if TYPE_CHECKING:
    from firmware_bridge.packet import Packet

START: Final[Nanoseconds] = 10 * SECOND
JUDGED: Final[Nanoseconds] = LOOKS_FOR + AVERAGED
"""A current that is too high is looked at twice."""
CYCLE: Final = 50 * MILLISECOND
SILENT: Final = 250 * MILLISECOND
FRICTION: Final = 10.0 / 20.0
"""A: a 20th of the wheels' continuous current."""
RESTS: Final = 12.0 / 80.0
"""rad/s: an 80th of their top speed."""


def held_brush(table: dict[str, Any]) -> None:
    table["axes"][2]["unpowered"] = "holds"
    for axis in table["axes"]:
        axis.pop("standstill_group", None)
        axis.pop("plausibility", None)


class Standing:
    """A cart at rest, whose brush holds by itself."""

    def __init__(self, change: Callable[[dict[str, Any]], None] = held_brush) -> None:
        self.cart = FakeCart(cart(change))
        self.sent: list[Packet] = []
        self.power_down = Down(self.cart.robot, self.cart.all_drivers, self.sent)
        self.now = START
        self.without: frozenset[str] = frozenset()
        for name in self.cart.drivers:
            self.reports(name, current_a=0.1)

    def reports(self, name: str, **what: Any) -> None:
        """Let a device report something, now."""
        driver = self.cart.drivers[name]
        driver.feedback = replace(
            driver.feedback,
            **{"received_at": self.now, "sampled_at": self.now, "current_at": self.now} | what,
        )

    def requests(self, later: Nanoseconds = 0, *, standstill: bool = True) -> Stop | None:
        """Request it, cycle by cycle, for so long; return the newest set-point."""
        until, silent = self.now + later, {}
        for name, driver in self.cart.drivers.items():
            silent[name] = self.now - driver.feedback.received_at > 0
        while True:
            stop = self.power_down.stop_for(standstill=standstill, now=self.now, without=self.without)
            if self.now == until:
                return stop
            self.now = min(self.now + CYCLE, until)
            for name in self.cart.drivers:
                if not silent[name]:
                    self.reports(name)

    def power(self, power: Power) -> None:
        for name in self.cart.drivers:
            self.reports(name, power=power)

    def lets_go(self) -> None:
        assert self.requests(LOOKS_FOR) is Stop.POWER_OFF
        self.power(Power.OFF)

    def reported(self) -> list[str]:
        return [event.reason for event in self.power_down.interlock_events]


def test_while_the_base_moves_nothing_is_requested() -> None:
    standing = Standing()
    assert standing.requests(SECOND, standstill=False) is None
    assert standing.power_down.stage is Stage.KEPT


def test_it_stands_with_power_while_it_is_looked_at_and_then_all_let_go() -> None:
    standing = Standing()
    assert standing.requests(LOOKS_FOR - 1) is Stop.QUICK_STOP
    assert standing.power_down.under_way
    assert standing.requests(1) is Stop.POWER_OFF
    assert standing.reported() == []


def test_a_base_that_moves_again_is_looked_at_again() -> None:
    standing = Standing()
    standing.requests(LOOKS_FOR - 1)
    assert standing.requests(standstill=False) is None
    assert standing.requests(LOOKS_FOR - 1) is Stop.QUICK_STOP
    assert standing.requests(1) is Stop.POWER_OFF


@pytest.mark.parametrize("name", ["left", "right"])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("beyond", "held"), [(0.999, False), (1.001, True)])
def test_more_than_friction_explains_holds_it_with_power(
    name: str, sign: int, beyond: float, *, held: bool
) -> None:
    standing = Standing()
    standing.reports(name, current_a=sign * beyond * FRICTION)
    stop = standing.requests(JUDGED)
    assert standing.power_down.held is held
    assert stop is (Stop.QUICK_STOP if held else Stop.POWER_OFF)
    number = {"left": 1, "right": 2}[name]
    reason = f"on a slope: held with power, 0.50 A at node {number} ({name}), and friction explains 0.50 A"
    assert standing.reported() == ([reason] if held else [])
    assert standing.requests(WATCHED_FOR) is stop
    assert standing.power_down.held is held


@pytest.mark.parametrize(("left", "held"), [(-1.0, False), (1.0, True), (-1.4 - 2 * FRICTION, True)])
def test_what_stands_together_may_be_strained_against_each_other(left: float, *, held: bool) -> None:
    def together(table: dict[str, Any]) -> None:
        held_brush(table)
        table["axes"][0]["standstill_group"] = table["axes"][1]["standstill_group"] = "wheels"

    standing = Standing(together)
    standing.reports("left", current_a=left)
    standing.reports("right", current_a=1.3)
    standing.requests(JUDGED)
    assert standing.power_down.held is held
    if left > 0:
        reason = "on a slope: held with power, 2.30 A at node 1 (left) and node 2 (right), and friction"
        assert standing.reported() == [f"{reason} explains 1.00 A"]


def test_the_currents_of_braking_do_not_count() -> None:
    standing = Standing()
    standing.reports("left", current_a=5.0)
    standing.requests(LOOKS_FOR // 2 - CYCLE)
    standing.reports("left", current_a=0.0)
    assert standing.requests(LOOKS_FOR // 2 + CYCLE) is Stop.POWER_OFF


@pytest.mark.parametrize(("falls", "looks"), [(0.5, 4), (0.85, 9), (0.95, 2)])
def test_a_current_that_falls_is_looked_at_until_it_has_settled(falls: float, looks: int) -> None:
    """The rest of a ramp in the average of a current falls; the current that holds on a slope does not."""
    standing, current, reported = Standing(), 3.0, 0
    standing.reports("left", current_a=current)
    standing.requests(LOOKS_FOR - AVERAGED)
    while not standing.power_down.held and standing.power_down.stage is Stage.LOOKED_AT:
        standing.reports("left", current_a=current)
        standing.requests(AVERAGED)
        current *= falls
        reported += 1
    assert reported == looks
    assert standing.power_down.held is (falls > 0.5)
    assert standing.now <= START + LOOKED_WITHIN


@pytest.mark.parametrize(
    ("arrives", "stage"),
    [(300, Stage.WATCHED), (2_400, Stage.WATCHED), (None, Stage.HELD)],
)
def test_a_current_counts_only_where_it_arrived_at_standstill(arrives: int | None, stage: Stage) -> None:
    """Over a serial line it is read every 400 ms: what was read before the standstill is of the ramp."""
    standing = Standing()
    standing.reports("left", current_a=0.1, current_at=START - 1)
    for ms in range(0, LOOKED_WITHIN // MILLISECOND + 1, 50):
        standing.now = START + ms * MILLISECOND
        standing.reports("right")
        fresh = {} if arrives is None or ms < arrives else {"current_at": START + arrives * MILLISECOND}
        standing.reports("left", **{"current_at": START - 1} | fresh)
        standing.power_down.stop_for(standstill=True, now=standing.now)
        if arrives is not None and ms < arrives:
            assert standing.power_down.stage is Stage.LOOKED_AT
        elif standing.power_down.stage is not Stage.LOOKED_AT:
            break
    assert standing.power_down.stage is stage


def test_an_axis_that_holds_by_itself_may_pull_as_it_likes() -> None:
    standing = Standing()
    standing.reports("brush", current_a=9.0)
    standing.lets_go()


@pytest.mark.parametrize("what", [{"current_a": None}, {"current_a": float("nan")}, {"power": Power.UNKNOWN}])
def test_a_current_that_is_not_known_keeps_the_power(what: dict[str, Any]) -> None:
    standing = Standing()
    standing.reports("right", **what)
    assert standing.requests(LOOKS_FOR) is Stop.QUICK_STOP
    assert standing.reported() == ["held with power: the holding current of node 2 (right) is not known"]


def test_a_driver_that_cannot_report_it_keeps_the_power() -> None:
    standing = Standing()
    standing.cart.drivers["left"].reports = frozenset(Reports) - {Reports.CURRENT}
    standing.requests(LOOKS_FOR)
    assert standing.power_down.held


def silent_since(received: set[str], *, early: int = 0, current_a: float = 0.1) -> Standing:
    """Look at a cart of whose wheels only these report; the others since one timeout, but for so much."""
    standing = Standing()
    standing.requests(LOOKS_FOR - SILENT)
    standing.now += early
    for name in ("left", "right"):
        standing.reports(name, current_a=current_a)
    standing.power_down.stop_for(standstill=True, now=standing.now)
    for later in (LOOKS_FOR, JUDGED) if received else (LOOKS_FOR,):
        standing.now = START + later
        for name in received:
            standing.reports(name)
        standing.power_down.stop_for(standstill=True, now=standing.now)
    return standing


@pytest.mark.parametrize(("early", "held"), [(0, True), (1, False)])
def test_where_all_are_silent_nothing_is_known(early: int, *, held: bool) -> None:
    assert silent_since(set(), early=early).power_down.held is held


@pytest.mark.parametrize(("current_a", "held"), [(0.1, False), (2.0, True)])
def test_one_that_is_silent_leaves_it_to_those_that_are_received(current_a: float, *, held: bool) -> None:
    assert silent_since({"right"}, current_a=current_a).power_down.held is held


@pytest.mark.parametrize("power", [Power.OFF, Power.FAULT])
def test_one_without_power_is_neither_looked_at_nor_given_any(power: Power) -> None:
    standing = Standing()
    standing.reports("left", power=power, current_a=None)
    assert standing.requests(LOOKS_FOR) is Stop.POWER_OFF
    standing.power(Power.OFF)
    standing.reports("left", power=power, velocity=5.0)
    standing.requests(CYCLE)
    assert standing.power_down.stage is Stage.WATCHED
    standing.reports("right", velocity=5.0)
    standing.requests()
    assert standing.cart.drivers["left"].begun == []
    assert standing.cart.drivers["right"].begun == [Transition.ACTIVATE]


def test_where_nothing_had_power_nothing_gets_it_however_it_is_pushed() -> None:
    standing = Standing()
    standing.power(Power.OFF)
    standing.requests(LOOKS_FOR)
    assert standing.power_down.powered_down
    standing.reports("left", velocity=5.0, position=3.0)
    assert standing.requests(WATCHED_FOR) is Stop.POWER_OFF
    assert standing.cart.drivers["left"].begun == []


def kept_by(standing: Standing, *without: str) -> str | None:
    return standing.power_down.kept_by(frozenset(without), standing.now)


@pytest.mark.parametrize(("beyond", "held"), [(0.999, False), (1.001, True)])
def test_what_a_mode_does_without_keeps_its_power_where_it_holds_the_robot(
    beyond: float, *, held: bool
) -> None:
    """And as long as it does: the next instant is looked at again. What the others hold is no matter."""
    standing = Standing()
    standing.reports("right", current_a=9.0)
    standing.reports("left", current_a=-beyond * FRICTION)
    reason = "on a slope: held with power, 0.50 A at node 1 (left), and friction explains 0.50 A"
    assert kept_by(standing, "left") == (reason if held else None)
    assert kept_by(standing, "brush") is None
    standing.reports("left", current_a=0.0)
    assert kept_by(standing, "left") is None


def test_what_one_of_two_that_stand_together_holds_the_other_would_have_to() -> None:
    def together(table: dict[str, Any]) -> None:
        held_brush(table)
        table["axes"][0]["standstill_group"] = table["axes"][1]["standstill_group"] = "wheels"

    standing = Standing(together)
    standing.reports("left", current_a=0.0)
    standing.reports("right", current_a=1.1)
    assert "node 1 (left) and node 2 (right)" in str(kept_by(standing, "left"))
    standing.reports("left", current_a=-1.0)
    assert kept_by(standing, "left") is None


@pytest.mark.parametrize(
    ("what", "kept"),
    [
        ({"power": Power.OFF}, False),
        ({"power": Power.FAULT}, False),
        ({"received_at": START - SILENT}, False),
        ({"received_at": START - SILENT + 1}, True),
        ({"current_a": None}, True),
    ],
)
def test_a_dead_axis_holds_nothing_and_one_whose_current_is_not_known_may(
    what: dict[str, Any], *, kept: bool
) -> None:
    standing = Standing()
    standing.reports("left", **{"current_a": 9.0} | what)
    assert (kept_by(standing, "left") is not None) is kept


def test_an_axis_that_the_mode_does_without_is_not_looked_at() -> None:
    standing = Standing()
    standing.without = frozenset({"left"})
    standing.reports("left", current_a=9.0)
    standing.lets_go()


@pytest.mark.parametrize(
    ("what", "slips"),
    [
        ({"velocity": RESTS}, False),
        ({"velocity": 1.001 * RESTS}, True),
        ({"velocity": -1.001 * RESTS}, True),
        ({"position": 0.999 * SLIPS_S * RESTS}, False),
        ({"position": -1.001 * SLIPS_S * RESTS}, True),
        ({"position": 1.001 * SLIPS_S * RESTS}, True),
    ],
)
def test_one_that_moves_after_it_was_let_go_is_caught(what: dict[str, Any], *, slips: bool) -> None:
    standing = Standing()
    standing.lets_go()
    standing.reports("left", **what)
    standing.requests()
    begun = [standing.cart.drivers[name].begun for name in ("left", "right", "brush")]
    assert begun == ([[Transition.ACTIVATE], [Transition.ACTIVATE], []] if slips else [[], [], []])
    assert standing.power_down.held is slips
    if slips:
        assert standing.reported() == [
            "on a slope: held with power; node 1 (left) moved when its power was disabled"
        ]
        standing.cart.drivers["left"].state = DriverState.ACTIVATING
        assert standing.requests() is Stop.STANDSTILL, "a quick stop would end what gives it power"
        standing.cart.drivers["left"].state = DriverState.ACTIVE
        assert standing.requests() is Stop.QUICK_STOP


@pytest.mark.parametrize(("early", "caught"), [(1, True), (0, False)])
def test_it_is_watched_for_2_s(early: int, *, caught: bool) -> None:
    standing = Standing()
    standing.lets_go()
    standing.requests(WATCHED_FOR - early)
    standing.reports("left", velocity=5.0)
    standing.requests()
    assert standing.power_down.held is caught
    assert standing.power_down.powered_down is not caught


def test_one_in_fault_is_not_given_power() -> None:
    standing = Standing()
    standing.lets_go()
    standing.reports("right", power=Power.FAULT)
    standing.reports("left", velocity=5.0)
    standing.requests()
    assert standing.cart.drivers["right"].begun == []
    assert standing.cart.drivers["left"].begun == [Transition.ACTIVATE]


def test_what_is_not_requested_any_more_is_watched_on_until_someone_gives_power() -> None:
    standing = Standing()
    standing.lets_go()
    standing.power_down.not_requested(standing.now)
    standing.reports("left", velocity=5.0)
    standing.power_down.not_requested(standing.now)
    assert standing.cart.drivers["left"].begun == [Transition.ACTIVATE]
    standing.power_down.not_requested(standing.now)
    assert standing.reported() == []
    standing = Standing()
    standing.lets_go()
    standing.cart.drivers["right"].state = DriverState.ACTIVATING
    standing.reports("left", velocity=5.0)
    standing.power_down.not_requested(standing.now)
    assert standing.cart.drivers["left"].begun == []
    assert standing.power_down.stage is Stage.KEPT


def test_an_order_ends_the_watch_and_the_holding() -> None:
    standing = Standing()
    standing.lets_go()
    standing.power_down.ordered(standing.now)
    standing.reports("left", velocity=5.0)
    standing.power_down.ordered(standing.now)
    assert standing.cart.drivers["left"].begun == []
    standing = Standing()
    standing.reports("left", current_a=2.0)
    standing.requests(LOOKS_FOR)
    standing.power_down.ordered(standing.now)
    assert not standing.power_down.held
    assert standing.reported() == []
