"""Conditions for arming a robot: each device has reported, and the controls were let go."""

import pytest

from firmware_bridge.drivers.life_cycle import Transition
from firmware_bridge.intent import Arm, Disarm
from firmware_bridge.units import SECOND
from hil_tests.unit.pipeline.cart import ARM, FakeCart


def test_a_device_that_fell_silent_is_set_up_again_whatever_it_stated_last() -> None:
    """Its last word was that it has power, and it stands."""
    cart = FakeCart()
    cart.runs(10)
    cart.silent = {"left"}
    cart.runs(cart.robot.silent_after["left"] // cart.robot.cycle)
    verdict = cart.requests(Arm())
    assert not verdict.accepted
    assert "enabling node 1 (left) again" in verdict.reason
    assert cart.drivers["left"].begun == [Transition.RECOVER]
    assert cart.drivers["right"].begun == []


def test_controls_that_were_deflected_from_the_start_are_let_go_where_a_cycle_sees_it() -> None:
    """Let go for one message, in which it is armed, and deflected again before the bridge has looked."""
    cart = FakeCart()
    cart.ahead = 0.5
    cart.runs(10)
    cart.ahead = 0.0
    cart.speaks()  # between two cycles
    assert cart.requests(ARM).accepted
    cart.ahead = 0.5
    cart.runs(5)
    assert "stick not neutral" in cart.held()
    assert cart.pipeline.seen.commanded.ahead == 0.0
    cart.ahead = 0.0
    cart.runs()
    cart.ahead = 0.5
    cart.runs()
    assert "stick not neutral" not in cart.held()
    assert cart.pipeline.seen.commanded.ahead > 0.0


def after_a_silence() -> FakeCart:
    cart = FakeCart()
    cart.arms()
    cart.talks = False
    cart.runs(20)
    assert {"operator link timeout"} <= cart.held()
    return cart


@pytest.mark.parametrize(("shares", "moves"), [((0.0, 0.5), True), ((0.5,), False), ((0.5, 0.0, 0.5), True)])
def test_who_lets_go_after_a_silence_has_let_go_however_soon_he_goes_on(
    shares: tuple[float, ...], *, moves: bool
) -> None:
    cart = after_a_silence()
    for share in shares:
        cart.ahead = share
        cart.speaks()  # between two cycles
    cart.talks = True
    cart.runs(10)
    assert ("stick not neutral" not in cart.held()) is moves
    assert (cart.pipeline.seen.commanded.ahead > 0.0) is moves


def test_who_let_go_before_the_silence_was_seen_has_not() -> None:
    cart = FakeCart()
    cart.arms()
    cart.speaks()  # the last message that is received
    cart.talks = False
    cart.runs(20)
    cart.talks, cart.ahead = True, 0.5
    cart.runs(10)
    assert "stick not neutral" in cart.held()


def test_arming_is_refused_where_the_next_cycle_would_disarm() -> None:
    cart = after_a_silence()
    cart.requests(Disarm())
    cart.runs(250)
    verdict = cart.requests(Arm())
    assert (verdict.accepted, verdict.reason) == (
        False,
        "arm: no motion command for 10 s: no station in control; send motion commands, then arm",
    )


def test_a_bridge_that_has_just_stood_still_is_not_armed() -> None:
    cart = FakeCart()
    cart.runs(10)
    cart.now += SECOND
    cart.speaks()  # packets that waited in the port come first
    for driver in cart.drivers.values():
        driver.received(cart.now)
    verdict = cart.requests(Arm())
    assert not verdict.accepted
    assert "the bridge itself did nothing for 1.00 s" in verdict.reason
