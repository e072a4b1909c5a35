"""Wheels that turn against each other: the robot is where it was, and does not rest for anybody."""

import math
from dataclasses import replace
from typing import Final

import pytest

from firmware_bridge.intent import Arm, ClearEmergencyStop, Disarm, EmergencyStop, EnterMode
from hil_tests.unit.pipeline.cart import PaperCart

BOUND: Final = 12.0 * (1.0 / 80.0)
"""rad/s: an 80th of the wheels' top speed."""
SPINS: Final = ((BOUND, -BOUND), (-BOUND, BOUND), (BOUND, 0.0), (0.0, -BOUND), (5.0, -5.0))


def spin(cart: PaperCart, left: float, right: float) -> None:
    """Let the wheels be seen to turn with these speeds."""
    for name, speed in (("left", left), ("right", right)):
        driver = cart.drivers[name]
        driver.feedback = replace(driver.feedback, velocity=speed)


@pytest.mark.parametrize(("left", "right"), SPINS)
def test_it_is_not_armed_cleared_or_changed_and_comes_to_rest_disarmed(left: float, right: float) -> None:
    cart = PaperCart()
    cart.runs(10)
    spin(cart, left, right)
    assert cart.asks(Arm()).reason == "arm: the robot still moves"
    assert cart.asks(EnterMode("brushless")).reason == "mode: stop and disarm first"
    spin(cart, 0.0, 0.0)
    assert cart.asks(Arm()).accepted
    spin(cart, left, right)
    assert cart.asks(Disarm()).reason == "disarmed: the robot comes to rest, the drives hold still"
    cart.asks(EmergencyStop())
    assert cart.asks(ClearEmergencyStop()).reason == "clear: the robot still moves"
    spin(cart, 0.0, 0.0)
    assert cart.asks(ClearEmergencyStop()).accepted


@pytest.mark.parametrize(("left", "right"), SPINS)
def test_its_orderly_end_waits_for_each_wheel(left: float, right: float) -> None:
    cart = PaperCart()
    cart.arms()
    spin(cart, left, right)
    assert not cart.pipeline.come_to_rest(cart.now)[1]
    spin(cart, 0.999 * BOUND, -0.999 * BOUND)
    assert cart.pipeline.come_to_rest(cart.now)[1]


def test_without_its_brush_it_rests_as_before() -> None:
    cart = PaperCart()
    cart.runs(10)
    assert cart.asks(EnterMode("brushless")).accepted
    spin(cart, BOUND, -BOUND)
    assert cart.asks(Arm()).reason == "arm: the robot still moves"
    spin(cart, 0.0, 0.0)
    assert cart.asks(Arm()).reason != "arm: the robot still moves"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_axis_that_moves_by_itself_is_not_told_where_it_stands(sign: float) -> None:
    """The robot rests, whatever its brush does; the brush does not."""
    cart = PaperCart()
    cart.runs(10)
    driver = cart.drivers["brush"]
    bound = driver.axis.rests_below
    for speed, refused in ((math.nextafter(bound, math.inf), True), (bound, False)):
        driver.feedback = replace(driver.feedback, velocity=sign * speed)
        verdict = cart.permission.set_zero(driver, 0.5, cart.pipeline.known(cart.now), ())
        assert (not verdict.accepted, verdict.reason.endswith("moves")) == (refused, refused)
        assert driver.zeros == ([] if refused else [0.5])
