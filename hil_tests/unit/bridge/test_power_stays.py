"""A base that does not rest keeps its power after an emergency stop; one that slips gets it back."""

import pytest

from firmware_bridge.bridge.power_down import STANDSTILL_WITHIN
from firmware_bridge.drivers.life_cycle import AT_REST, TABLE, DriverState, Task
from hil_tests.unit.bridge.test_power_down import CYCLE, RESTS, Standing


def turning() -> Standing:
    standing = Standing()
    standing.reports("left", velocity=2.0 * RESTS)
    return standing


def test_it_is_reported_when_the_base_does_not_rest_in_its_time() -> None:
    standing = turning()
    standing.requests(STANDSTILL_WITHIN - CYCLE, standstill=False)
    assert standing.reported() == []
    standing.requests(CYCLE, standstill=False)
    assert standing.reported() == ["the robot is not at standstill: node 1 (left) moves"]


@pytest.mark.parametrize("what", ["it rests", "no request", "the power is ordered off", "the wheel stands"])
def test_it_is_reported_no_longer_than_it_is_so(what: str) -> None:
    standing = turning()
    standing.requests(STANDSTILL_WITHIN, standstill=False)
    assert standing.reported()
    if what == "it rests":
        standing.requests()
    elif what == "no request":
        standing.power_down.not_requested(standing.now)
    elif what == "the power is ordered off":
        standing.power_down.ordered(standing.now)
    else:
        standing.reports("left", velocity=0.0)
        standing.requests(standstill=False)
    assert standing.reported() == []


@pytest.mark.parametrize("state", AT_REST)
def test_one_whose_set_up_is_not_in_force_is_caught_by_way_of_its_set_up(state: DriverState) -> None:
    standing = Standing()
    standing.lets_go()
    standing.cart.drivers["left"].state = state
    standing.reports("left", velocity=5.0)
    standing.requests()
    assert standing.cart.drivers["left"].failure is None
    assert TABLE[state, standing.cart.drivers["left"].begun[-1]].tasks[-1] is Task.ENABLE
