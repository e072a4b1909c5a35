"""An axis that is not believed loses its power, whatever else stops the robot, until the robot is armed."""

from dataclasses import replace

from firmware_bridge.drivers.driver import Power, Speed, Stop
from firmware_bridge.drivers.life_cycle import Transition
from firmware_bridge.intent import Arm, EmergencyStop
from hil_tests.unit.pipeline.cart import FakeCart


def frozen() -> FakeCart:
    """Return a cart that drives, and whose left wheel shows the same position for half a second."""
    cart = FakeCart()
    cart.arms()
    cart.ahead = 0.3
    cart.runs(20)
    for _ in range(10):
        driver = cart.drivers["left"]
        driver.feedback = replace(driver.feedback, velocity=0.0)
        cart.runs()
    return cart


def test_it_alone_loses_its_power() -> None:
    cart = frozen()
    assert cart.permission.untrusted == {"left"}
    assert not cart.permission.armed
    assert cart.newest("left") is Stop.POWER_OFF
    assert cart.newest("right") != Stop.POWER_OFF
    cart.runs(100)
    assert cart.newest("left") is Stop.POWER_OFF
    assert cart.newest("right") == Speed(0.0)


def test_an_emergency_stop_does_not_give_it_back() -> None:
    cart = frozen()
    cart.requests(EmergencyStop())
    cart.runs(40)
    assert cart.newest("left") is Stop.POWER_OFF
    assert cart.newest("right") is Stop.QUICK_STOP


def test_nor_does_the_orderly_end() -> None:
    cart = frozen()
    cart.pipeline.come_to_standstill(cart.now)
    assert cart.newest("left") is Stop.POWER_OFF


def test_arming_gives_it_back() -> None:
    cart = frozen()
    cart.ahead = 0.0
    driver = cart.drivers["left"]
    driver.feedback, driver.unpowered = replace(driver.feedback, power=Power.OFF), True
    cart.runs(40)
    assert "enabling node 1 (left) again" in cart.requests(Arm()).reason
    assert driver.begun[-1:] == [Transition.ACTIVATE]
    cart.runs()
    assert cart.newest("left") is not Stop.POWER_OFF
    driver.feedback = replace(driver.feedback, power=Power.ON)
    cart.runs(10)
    assert cart.requests(Arm()).accepted


def test_so_does_arming_one_that_has_kept_its_power() -> None:
    cart = frozen()
    cart.ahead = 0.0
    cart.runs(40)
    assert cart.newest("left") is Stop.POWER_OFF
    assert cart.requests(Arm()).accepted
    cart.runs()
    assert cart.newest("left") is not Stop.POWER_OFF
