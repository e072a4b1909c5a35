"""Two links in one robot: each with its own pace, and one that stops only the groups of its own."""

from typing import Any

import pytest

from firmware_bridge.drivers.driver import Power, Speed, Stop
from firmware_bridge.intent import Arm, Disarm, EmergencyStop
from hil_tests.unit.pipeline.cart import TOOL, FakeCart, cart


def every_second(table: dict[str, Any]) -> None:
    table["links"][TOOL]["every"] = 2


def stops_itself(table: dict[str, Any]) -> None:
    table["links"][TOOL]["stops"] = ["tool"]


def sweeping(change: Any = lambda _table: None) -> FakeCart:
    """A cart that drives and brushes."""
    bench = FakeCart(cart(change))
    bench.arms()
    bench.ahead = bench.brush = 0.5
    bench.runs(20)
    assert bench.newest("left") == Speed(5.0)
    assert bench.newest("brush") == Speed(5.0)
    return bench


def test_a_link_of_every_second_cycle_is_reported_in_every_second() -> None:
    bench = sweeping(every_second)
    before = bench.reported()
    bench.runs(10)
    counted = {name: count - before[name] for name, count in bench.reported().items()}
    assert counted == {"left": 10, "right": 10, "brush": 5}


def test_its_set_points_change_when_it_is_due_and_not_before() -> None:
    bench = sweeping(every_second)
    while bench.cycle % 2 == 0:
        bench.runs()
    bench.brush = 0.7
    bench.runs()
    assert bench.cycle % 2 == 0, "this was a cycle in which the brush's link is not due"
    assert bench.newest("brush") == Speed(5.0)
    bench.runs()
    assert bench.newest("brush") == Speed(7.0)


@pytest.mark.parametrize("odd", [0, 1])
def test_a_brush_that_is_let_go_stops_at_once_due_or_not(odd: int) -> None:
    bench = sweeping(every_second)
    bench.runs(odd)
    bench.brush = 0.0
    bench.runs()
    assert bench.newest("brush") == Speed(0.0)


@pytest.mark.parametrize("odd", [0, 1])
@pytest.mark.parametrize("request_", [EmergencyStop(), Disarm(force=True)])
def test_a_stop_reaches_a_link_at_once_due_or_not(odd: int, request_: EmergencyStop | Disarm) -> None:
    bench = sweeping(every_second)
    bench.runs(odd)
    assert bench.requests(request_).accepted
    bench.pipeline.run(bench.now)
    assert bench.newest("brush") in {Speed(0.0), Stop.POWER_OFF, Stop.QUICK_STOP}


def test_a_stop_is_reported_once_between_two_cycles_of_the_link() -> None:
    bench = sweeping(every_second)
    bench.brush = 0.0
    bench.runs(2)
    before = bench.reported()["brush"]
    bench.runs(10)
    assert bench.reported()["brush"] - before == 5


def test_a_lost_link_stops_the_whole_robot() -> None:
    bench = sweeping()
    bench.links[TOOL].lost = "the adapter is gone"
    bench.runs()
    assert f"link lost: {TOOL}" in bench.held()
    assert not bench.permission.armed
    bench.runs(20)
    assert bench.newest("left") == Speed(0.0)


def test_a_link_that_stops_only_its_group_leaves_the_wheels_rolling() -> None:
    """The brush's drive is silent then, too, and that stops no more than its link does."""
    bench = sweeping(stops_itself)
    bench.links[TOOL].lost = "the adapter is gone"
    bench.runs()
    assert bench.held() == {f"link lost: {TOOL}"}
    assert bench.newest("brush") == Speed(0.0)
    bench.runs(20)
    assert bench.held() == {f"link lost: {TOOL}", "axis timeout: brush"}
    assert bench.permission.armed
    assert bench.newest("left") == Speed(5.0)
    assert bench.newest("brush") == Speed(0.0)


def test_a_robot_without_one_of_its_links_cannot_be_armed() -> None:
    bench = sweeping(stops_itself)
    bench.ahead = bench.brush = 0.0
    bench.links[TOOL].lost = "the adapter is gone"
    bench.runs(20)
    assert bench.requests(Disarm()).accepted
    assert bench.requests(Arm()).reason == "arm: the adapter is gone; plug it in again"


@pytest.mark.parametrize(("axis", "rolls"), [("brush", True), ("left", False)])
def test_a_fault_on_that_link_stops_its_group_and_any_other_the_robot(axis: str, *, rolls: bool) -> None:
    bench = sweeping(stops_itself)
    driver = bench.drivers[axis]
    driver.feedback = type(driver.feedback)(axis, Power.FAULT, bench.now, bench.now, fault="0x2310")
    bench.runs(20)
    assert f"axis fault: {axis}" in bench.held()
    assert bench.permission.armed is rolls
    assert (bench.newest("right") == Speed(5.0)) is rolls
    assert bench.newest("brush") == Speed(0.0)
