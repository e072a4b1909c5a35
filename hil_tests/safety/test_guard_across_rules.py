"""The guard's rules over several axes, called directly: axes that count, axes stopped, and until when."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import pytest

from firmware_bridge.robot import AnyRobot, GuardExclusive, GuardSum
from firmware_bridge.robot_types import find
from firmware_bridge.safety.guard.across_axes import (
    HALTED_WITHIN,
    AxesRule,
    Exclusion,
    OneHomes,
    SpeedSum,
    rules_across,
)
from firmware_bridge.safety.guard.in_force import RequestedMotion
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds
from hil_tests.scenarios.homed import homed

if TYPE_CHECKING:
    from collections.abc import Mapping

CYCLE = 20 * MILLISECOND


@dataclass
class Table:
    name: str
    top_speed: float = 100.0

    @property
    def title(self) -> str:
        return self.name


@dataclass(eq=False)
class Axis:
    """An axis as the rules see it."""

    name: str
    speed: float = 0.0
    moving: bool = False
    homes: bool = False
    homes_within_s: float = 0.0
    commanded_at: Nanoseconds = -NEVER
    cycle: Nanoseconds = CYCLE
    axis: Any = field(init=False)

    def __post_init__(self) -> None:
        self.axis = Table(self.name)


def requested(**speeds: float) -> dict[str, RequestedMotion]:
    return {name: RequestedMotion(speed != 0.0, speed) for name, speed in speeds.items()}


class Trio:
    """Three axes and one rule."""

    def __init__(self, rule: type[AxesRule] | None = None, **row: Any) -> None:
        self.axes = {name: Axis(name) for name in ("a", "b", "c")}
        axes = cast("Mapping[str, Any]", self.axes)
        self.rule: AxesRule
        if rule is SpeedSum:
            self.rule = SpeedSum(GuardSum.model_validate(row), axes)
        elif rule is Exclusion:
            self.rule = Exclusion(GuardExclusive.model_validate(row), axes)
        else:
            self.rule = OneHomes(axes.values())

    def refuses(self, wanted: Mapping[str, RequestedMotion], now: Nanoseconds = CYCLE) -> str | None:
        return self.rule.refuses(
            cast("Mapping[Any, RequestedMotion]", {self.axes[name]: one for name, one in wanted.items()}), now
        )

    def sent(self, name: str, now: Nanoseconds, speed: float | None = None) -> Nanoseconds:
        """Note a set-point, and return until when the rule is kept."""
        axis = self.axes[name]
        axis.commanded_at = now
        axis.speed = axis.speed if speed is None else speed
        self.rule.sent(cast("Any", axis), now)
        return self.rule.due


def pair(bound: float = 50.0) -> Trio:
    """The sum of a and b; c is none of its axes."""
    return Trio(SpeedSum, name="sum", of={"a": 1.0, "b": 1.0}, bound=bound)


def test_only_who_has_not_been_sent_anything_at_this_instant_may_repair_a_sum() -> None:
    trio = pair()
    trio.axes["a"].commanded_at = trio.axes["b"].commanded_at = 0
    assert trio.refuses(requested(a=60.0)) is None, "b may still correct it"
    trio.axes["b"].commanded_at = CYCLE
    assert trio.refuses(requested(a=60.0)) == "sum of 60.0000 is beyond 50.0000"
    assert trio.refuses(requested(a=30.0, b=30.0)) == "sum of 60.0000 is beyond 50.0000", "both are requested"


def test_within_for_an_instant_only_mends_nothing() -> None:
    trio = pair()
    trio.sent("a", 0, 0.0)
    trio.sent("b", 0, 0.0)
    due = trio.sent("a", CYCLE, 60.0)
    assert due == CYCLE + CYCLE, "a cycle"
    assert trio.sent("b", CYCLE, -20.0) == NEVER
    assert trio.sent("a", CYCLE, 80.0) == CYCLE, "no one is left at this instant"


def test_a_sum_that_stands_beyond_ends_after_a_cycle_from_when_it_was_passed_last() -> None:
    trio = pair()
    trio.sent("a", 0, 0.0)
    trio.sent("b", 0, 0.0)
    assert trio.sent("a", CYCLE, 51.0) == 2 * CYCLE
    assert trio.sent("a", CYCLE + 5 * MILLISECOND, 52.0) == 2 * CYCLE, "passed once"
    assert trio.sent("b", CYCLE + 10 * MILLISECOND, 0.0) == CYCLE + 10 * MILLISECOND, "b has fixed nothing"
    assert trio.sent("b", CYCLE + 12 * MILLISECOND, -10.0) == NEVER


def test_no_one_goes_on_from_mixture_to_mixture() -> None:
    """Of each cycle 15 ms are beyond, and each time the other axis could correct it: the integral ends it."""
    trio = pair()
    for name, speed in (("a", 50.0), ("b", -50.0), ("a", 100.0), ("b", -100.0)):
        assert trio.sent(name, 0, speed) == NEVER
    refused = None
    for cycle in range(1, 40):
        now = cycle * CYCLE
        if trio.refuses(requested(b=1.0), now) is not None:
            refused = cycle
            break
        trio.sent("b", now, 1.0)
        trio.sent("b", now + 15 * MILLISECOND, -100.0)
    # Two cycles of 200 are 8,000; each cycle is 51 x 15 ms beyond, and 50 x 5 ms within.
    assert refused == 17


def test_who_was_sent_something_since_the_bound_was_passed_mends_nothing_later() -> None:
    trio = Trio(SpeedSum, name="sum", of={"a": 1.0, "b": 1.0, "c": 1.0}, bound=50.0)
    for name in "abc":
        trio.sent(name, 0, 0.0)
    now = CYCLE
    assert trio.sent("a", now, 80.0) == now + CYCLE
    assert trio.sent("b", now + 1, 0.0) == now + CYCLE, "c may"
    assert trio.sent("c", now + 2, -40.0) == NEVER
    assert trio.sent("a", now + 2, 100.0) == now + 2, "at the same instant b, which had its turn, may not"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_was_beyond_to_one_side_does_not_count_for_the_other(sign: float) -> None:
    trio = pair()
    trio.sent("a", 0, sign * 100.0)
    trio.sent("b", 0, 0.0)
    now = 8 * CYCLE
    trio.sent("b", now, 0.0)
    trio.sent("a", now + CYCLE, 0.0)
    later = now + 2 * CYCLE
    assert trio.refuses(requested(a=sign * 60.0), later) is not None, "more than 2 cycles at the top"
    assert trio.refuses(requested(a=-sign * 60.0), later) is None


def test_a_stop_takes_along_who_else_moves() -> None:
    trio = pair()
    a, b = trio.axes["a"], trio.axes["b"]
    a.moving = b.moving = True
    a.speed = b.speed = 0.0
    assert [one.axis.name for one in trio.rule.stops_with(cast("Any", (a,)))] == ["b"], "by position, too"
    b.moving, b.speed = False, 5.0
    assert list(trio.rule.stops_with(cast("Any", (a,)))) == []


def sides() -> Trio:
    return Trio(Exclusion, name="sides", one=["a"], other=["b", "c"])


def test_each_mover_is_looked_at() -> None:
    trio = sides()
    assert trio.refuses(requested(b=1.0, c=1.0)) is None
    trio.axes["a"].moving = True
    assert trio.refuses(requested(c=1.0)) == "sides: c may not move while a may"
    assert trio.refuses({**requested(b=0.0), **requested(c=1.0)}) == "sides: c may not move while a may"
    assert trio.refuses({"a": RequestedMotion(moves=True, speed=1.0), **requested(c=1.0)}) is not None


def test_who_is_requested_to_rest_together_is_in_nobodys_way() -> None:
    trio = sides()
    trio.axes["a"].moving = True
    assert trio.refuses(requested(a=0.0, b=1.0)) is None
    trio.axes["c"].moving = True
    assert trio.refuses(requested(a=1.0, b=0.0)) == "sides: a may not move while c may"


def test_one_homes_alone_and_goes_on() -> None:
    trio = Trio()
    trio.axes["a"].homes = True
    assert trio.refuses(requested(a=1.0)) is None, "it is the one"
    assert trio.refuses(requested(b=1.0)) == "homing: b may not move while a is homing"
    assert (
        trio.refuses({**requested(a=1.0), **requested(b=1.0)}) == "homing: b may not move while a is homing"
    )
    foreign_node = cast("Any", Axis("d"))
    assert trio.rule.refuses({foreign_node: RequestedMotion(moves=True, speed=1.0)}, 0) is None, (
        "no axis of the rule"
    )


def test_a_homing_lasts_no_longer_than_its_time() -> None:
    trio = Trio()
    for axis in trio.axes.values():
        axis.homes_within_s, axis.moving = 2.0, True
    for begin in (0, 100 * SECOND, 200 * SECOND):
        for name in "bcb"[: 1 + begin // (100 * SECOND)]:
            assert trio.sent(name, begin) == NEVER, "no one homes"
        trio.axes["a"].homes = True
        assert trio.sent("a", begin) == begin + 2 * SECOND + HALTED_WITHIN
        assert trio.sent("b", begin + SECOND) == begin + 2 * SECOND + HALTED_WITHIN, "a still homes"
        trio.axes["a"].homes = False
        assert trio.sent("a", begin + 2 * SECOND) == NEVER


@pytest.mark.parametrize(
    ("machine", "homes"),
    [(find("rars"), False), (find("climber"), False), (homed(), True)],
    ids=["rars", "climber", "rars that homes"],
)
def test_a_robot_has_the_rules_of_its_file(machine: AnyRobot, *, homes: bool) -> None:
    axes = {axis.name: cast("Any", with_table(axis)) for axis in machine.axes}
    rules = rules_across(machine, axes)
    sums, sides = machine.guard.sums, machine.guard.exclusive
    wanted = [*(row.name for row in sums), *(row.name for row in sides)]
    assert [rule.name for rule in rules] == [*(["homing"] if homes else []), *wanted]


def with_table(table: Any) -> Axis:
    found = Axis(table.name)
    found.axis = table
    return found
