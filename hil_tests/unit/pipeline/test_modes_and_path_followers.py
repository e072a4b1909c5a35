"""A mode without a failed axis, and a commanding path follower: who may choose them, what ends them."""

import pytest

from firmware_bridge.drivers.driver import Power, Speed, Stop
from firmware_bridge.intent import Arm, ChangeDriver, ClearEmergencyStop, Disarm, EnterMode, Follow
from hil_tests.unit.pipeline.cart import GUIDED_MPS, RADIUS_M, FakeCart

GUIDED = Speed(GUIDED_MPS / RADIUS_M)


def off(cart: FakeCart, axis: str, power: Power = Power.OFF) -> None:
    """Let a drive lose its power, or get it back."""
    driver = cart.drivers[axis]
    driver.feedback = type(driver.feedback)(axis, power, cart.now, cart.now)


def brushless() -> FakeCart:
    """A cart whose brush has failed, in the mode that does without it."""
    cart = FakeCart()
    cart.runs(10)
    assert cart.requests(EnterMode("brushless")).accepted
    off(cart, "brush")
    cart.runs(10)
    return cart


def guided() -> FakeCart:
    """A cart that goes its path follower's way."""
    cart = FakeCart()
    cart.arms()
    assert cart.requests(Follow("ahead")).accepted
    cart.runs(20)
    assert cart.newest("left") == GUIDED
    return cart


def test_an_armed_robot_changes_no_mode() -> None:
    cart = FakeCart()
    cart.arms()
    verdict = cart.requests(EnterMode("brushless"))
    assert (verdict.accepted, verdict.temporary) == (False, False)
    assert verdict.reason == "mode: stop and disarm first"
    assert cart.requests(Disarm()).accepted
    assert cart.requests(EnterMode("brushless")).accepted


def test_a_robot_that_moves_changes_no_mode_armed_or_not() -> None:
    cart = FakeCart()
    cart.runs(10)
    cart.drivers["left"].command(Speed(5.0))
    assert cart.requests(EnterMode("brushless")).reason == "mode: stop and disarm first"


def test_an_unknown_mode_is_answered_with_those_that_there_are() -> None:
    cart = FakeCart()
    verdict = cart.requests(EnterMode("wheelless"))
    assert (verdict.accepted, verdict.temporary) == (False, False)
    assert verdict.reason == "mode: this robot has no 'wheelless'; it has brushless"


def test_an_axis_that_is_left_out_is_commanded_to_be_without_power() -> None:
    cart = brushless()
    assert cart.newest("brush") is Stop.POWER_OFF
    assert cart.pipeline.seen.facts.without == {"brush"}


def test_what_is_wrong_with_it_holds_nothing_back_in_that_mode() -> None:
    cart = brushless()
    off(cart, "brush", Power.FAULT)
    cart.runs()
    assert cart.held() == {"not armed"}
    assert cart.requests(Arm()).accepted
    cart.ahead = 0.5
    cart.runs(20)
    assert cart.newest("left") == Speed(5.0)
    assert cart.drivers["brush"].begun == []


def test_while_it_has_power_the_robot_is_held_by_a_row_of_its_own() -> None:
    cart = FakeCart()
    cart.runs(10)
    cart.requests(EnterMode("brushless"))
    cart.runs(10)
    assert cart.held() == {"not armed", "axis excluded: brush"}
    assert cart.requests(Arm()).reason.startswith("arm: node 1 (brush) has power, but this mode excludes it")
    off(cart, "brush")
    cart.runs()
    assert cart.requests(Arm()).accepted


@pytest.mark.parametrize("power", [Power.OFF, Power.STOPPED, Power.UNKNOWN, Power.FAULT])
def test_any_word_but_on_lets_that_row_go(power: Power) -> None:
    cart = brushless()
    off(cart, "brush", power)
    cart.runs()
    assert cart.held() == {"not armed"}


@pytest.mark.parametrize(("cycles", "held"), [(4, True), (5, False)])
def test_one_that_sends_nothing_any_more_is_waited_for_as_long_as_its_link_allows(
    cycles: int, *, held: bool
) -> None:
    """250 ms: by then it has received that its power goes off, or its own watch has stopped it."""
    cart = FakeCart()
    cart.runs(10)
    cart.requests(EnterMode("brushless"))
    cart.runs()
    cart.silent = {"brush"}
    cart.runs(cycles)
    assert ("axis excluded: brush" in cart.held()) is held


def test_power_that_comes_back_disarms() -> None:
    cart = brushless()
    assert cart.requests(Arm()).accepted
    off(cart, "brush", Power.ON)
    cart.runs()
    assert "axis excluded: brush" in cart.held()
    assert not cart.permission.armed


def test_the_whole_robot_wants_the_axis_back() -> None:
    cart = brushless()
    assert cart.requests(EnterMode("")).accepted
    cart.runs()
    assert "axis not enabled: brush" in cart.held()
    assert cart.requests(Arm()).reason.startswith("enabling node 1 (brush) again")


def test_on_the_way_to_rest_at_the_end_it_gets_no_power() -> None:
    cart = brushless()
    before = len(cart.drivers["brush"].set_points)
    cart.pipeline.come_to_standstill(cart.now + cart.robot.cycle)
    assert set(cart.drivers["brush"].set_points[before:]) == {Stop.POWER_OFF}


def test_a_guide_makes_the_commands() -> None:
    cart = guided()
    assert cart.pipeline.seen.command.ahead == GUIDED_MPS
    assert cart.requests(Follow("")).accepted
    cart.runs(20)
    assert cart.newest("left") == Speed(0.0)


def test_an_unknown_guide_is_answered_with_those_that_there_are() -> None:
    verdict = FakeCart().requests(Follow("astray"))
    assert (verdict.accepted, verdict.reason) == (
        False,
        "path follower: this robot has no 'astray'; it has ahead",
    )


def test_a_stick_takes_over_and_the_guide_does_not_come_back() -> None:
    cart = guided()
    cart.ahead = -0.5
    cart.runs(30)
    assert cart.newest("left") == Speed(-5.0)
    cart.ahead = 0.0
    cart.runs(30)
    assert cart.newest("left") == Speed(0.0)


def test_the_operator_must_be_received_while_a_guide_drives() -> None:
    cart = guided()
    cart.talks = False
    cart.runs(9)
    assert cart.newest("left") == GUIDED
    cart.runs(11)
    assert "operator link timeout" in cart.held()
    assert cart.newest("left") == Speed(0.0)


def test_a_guide_that_was_held_back_begins_again() -> None:
    """It rests half a second before it goes on; without the reset it would go at once."""
    cart = guided()
    cart.talks = False
    cart.runs(20)
    cart.talks = True
    while cart.held():
        cart.runs()
    resting = 0
    while cart.newest("left") == Speed(0.0):
        cart.runs()
        resting += 1
    assert resting >= 9


def test_a_guide_ends_when_another_operator_drives() -> None:
    cart = guided()
    assert cart.requests(ChangeDriver()).accepted
    cart.runs(40)
    assert cart.newest("left") == Speed(0.0)


def test_a_guide_is_refused_by_a_robot_that_is_not_armed() -> None:
    cart = FakeCart()
    cart.runs(10)
    verdict = cart.requests(Follow("ahead"))
    assert (verdict.accepted, verdict.reason) == (False, "path follower: arm the robot first")
    assert cart.requests(Follow("")).accepted


def test_a_robot_that_was_disarmed_has_no_guide_when_it_is_armed_again() -> None:
    cart = guided()
    cart.drivers["brush"].command(Speed(9.0))
    cart.runs(20)
    assert not cart.permission.armed
    assert cart.requests(ClearEmergencyStop()).accepted
    assert cart.requests(Arm()).accepted
    cart.runs(40)
    assert cart.held() == set()
    assert cart.newest("left") == Speed(0.0)
