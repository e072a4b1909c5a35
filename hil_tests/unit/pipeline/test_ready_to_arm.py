"""What is to be known before a robot is armed: each device is heard, and the controls were let go."""

from firmware_bridge.drivers.driver import BRING_UP
from firmware_bridge.intent import Arm
from hil_tests.unit.pipeline.cart import ARM, PaperCart


def test_a_device_that_fell_silent_is_set_up_anew_whatever_it_said_last() -> None:
    """Its last word was that it has power, and it stands."""
    cart = PaperCart()
    cart.runs(10)
    cart.silent = {"left"}
    cart.runs(cart.robot.silent_after["left"] // cart.robot.cycle)
    verdict = cart.asks(Arm())
    assert not verdict.accepted
    assert "enabling node 1 (left) again" in verdict.reason
    assert tuple(cart.drivers["left"].begun) == BRING_UP
    assert cart.drivers["right"].begun == []


def test_controls_that_were_deflected_from_the_start_are_let_go_where_a_cycle_sees_it() -> None:
    """Let go for one message, in which it is armed, and deflected again before the bridge has looked."""
    cart = PaperCart()
    cart.ahead = 0.5
    cart.runs(10)
    cart.ahead = 0.0
    cart._speaks()  # noqa: SLF001 - between two cycles
    assert cart.asks(ARM).accepted
    cart.ahead = 0.5
    cart.runs(5)
    assert "controls deflected" in cart.held()
    assert cart.pipeline.seen.demanded.ahead == 0.0
    cart.ahead = 0.0
    cart.runs()
    cart.ahead = 0.5
    cart.runs()
    assert "controls deflected" not in cart.held()
    assert cart.pipeline.seen.demanded.ahead > 0.0
