"""A hold that latches: the emergency stop stays when it has let go, until an order clears it."""

from firmware_bridge.drivers.driver import Speed, Stop
from firmware_bridge.intent import Arm, ClearEmergencyStop
from hil_tests.unit.pipeline.cart import RACES, FakeCart


def racing() -> FakeCart:
    """A cart whose brush has just turned too fast; the hand lets go of the stick then."""
    cart = FakeCart()
    cart.arms()
    cart.brush = 0.9
    cart.runs(2)
    cart.brush = 0.0
    return cart


def test_below_its_threshold_nothing_latches() -> None:
    cart = FakeCart()
    cart.arms()
    cart.brush = 0.8
    cart.runs(5)
    assert cart.held() == set()
    assert not cart.permission.emergency_stopped


def test_it_stops_everything_in_the_cycle_in_which_it_trips() -> None:
    cart = racing()
    assert RACES.name in cart.held()
    assert cart.permission.emergency_stopped
    assert not cart.permission.armed
    assert cart.newest("brush") in {Speed(0.0), Stop.QUICK_STOP}


def test_the_emergency_stop_outlives_it() -> None:
    cart = racing()
    cart.runs(20)
    assert RACES.name not in cart.held()
    assert {"emergency stop", "not armed"} <= cart.held()
    assert {cart.newest(name) for name in cart.drivers} == {Stop.QUICK_STOP}
    refused = cart.requests(Arm())
    assert (refused.accepted, refused.reason) == (
        False,
        "arm: the emergency stop is latched; clear it first",
    )


def test_cleared_it_may_be_armed_and_moves_again() -> None:
    cart = racing()
    cart.runs(5)
    assert cart.requests(ClearEmergencyStop()).accepted
    cart.runs()
    assert cart.held() == {"not armed"}
    assert cart.requests(Arm()).accepted
    cart.brush = 0.5
    cart.runs()
    assert cart.newest("brush") == Speed(5.0)


def test_cleared_while_it_trips_it_latches_again() -> None:
    cart = racing()
    cart.drivers["brush"].command(Speed(9.0))
    assert cart.requests(ClearEmergencyStop()).accepted
    cart.drivers["brush"].command(Speed(9.0))
    cart.runs()
    assert cart.permission.emergency_stopped
