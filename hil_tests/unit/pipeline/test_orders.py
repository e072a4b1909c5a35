"""Requests in any order, with any report of the devices: what is granted, refused and sent at any time."""

import math
from dataclasses import replace
from itertools import product
from typing import Final, NamedTuple

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from firmware_bridge.bridge.joint_state import Motion
from firmware_bridge.bridge.orders import ORDERS, order_of
from firmware_bridge.drivers.driver import Power, Speed
from firmware_bridge.drivers.life_cycle import DriverState, Transition
from firmware_bridge.intent import (
    Answer,
    Arm,
    ChangeDriver,
    ClearEmergencyStop,
    ConfirmPosition,
    Disarm,
    EmergencyStop,
    EnterMode,
    Follow,
    Pause,
    Request,
    ResetOdometry,
    Resume,
)
from hil_tests.lanes import examples
from hil_tests.unit.pipeline.cart import FakeCart

REQUESTS: Final[tuple[Request, ...]] = (
    Arm(),
    Disarm(),
    Disarm(force=True),
    EmergencyStop(),
    EmergencyStop(final=True),
    ClearEmergencyStop(),
    Pause(),
    Resume(),
    EnterMode("brushless"),
    EnterMode(""),
    EnterMode("no such"),
    Follow("ahead"),
    Follow(""),
    Follow("no such"),
    ConfirmPosition("brush", 0.5),
    ConfirmPosition("brush", math.nan),
    ResetOdometry(),
    ChangeDriver(),
)
GIVES_POWER: Final = {Transition.ACTIVATE, Transition.RECOVER}
RAMP: Final = 0.11
"""m/s that a wheel may be set slower in a cycle of 50 ms, with rounding."""


def test_every_request_has_a_row_and_every_row_a_request() -> None:
    found = {id(order_of(request)) for request in REQUESTS}
    assert found == {id(order) for order in ORDERS.values()}


def test_arming_right_after_a_forced_disarm_enables_first() -> None:
    """The drives still report power: with it the robot must not count as armed while it is being taken."""
    cart = FakeCart()
    cart.arms()
    assert cart.requests(Disarm(force=True)).accepted
    answer = cart.requests(Arm())
    assert (answer.accepted, answer.temporary) == (False, True)
    assert not cart.permission.armed
    assert Transition.ACTIVATE in cart.drivers["left"].begun
    # At the same instant its report is still the old one.
    assert not cart.requests(Arm()).accepted
    cart.runs()
    assert cart.requests(Arm()).accepted


def test_the_power_counts_as_gone_once_it_was_ordered_off_and_the_brakes_are_done() -> None:
    cart = FakeCart()
    cart.arms()
    assert not cart.permission.powered_down
    cart.ahead = 0.5
    cart.runs(20)
    assert cart.requests(Disarm(force=True)).accepted
    assert not cart.permission.powered_down, "it brakes first"
    cart.ahead = 0.0
    cart.runs(60)
    assert cart.permission.powered_down


@pytest.mark.parametrize("first", [EmergencyStop(), EmergencyStop(final=True), Disarm(force=True)])
def test_a_lasting_reason_comes_before_one_that_time_ends(first: Request) -> None:
    cart = FakeCart()
    cart.arms()
    cart.requests(first)
    cart.drivers["left"].feedback = replace(cart.drivers["left"].feedback, velocity=5.0)
    cart.ahead = 1.0
    cart.speaks()
    answer = cart.requests(Arm())
    assert not answer.temporary
    stopped = isinstance(first, EmergencyStop)
    assert answer.reason.startswith("arm: the emergency stop" if stopped else "arm: x stands at")


class Requested(RuleBasedStateMachine):
    """A cart, its operator, and devices that report what they like."""

    def __init__(self) -> None:
        super().__init__()
        self.cart: Final = FakeCart()
        self.cart.runs(10)
        self.begun = self._begun()
        self.answers: list[Answer] = []
        self.commanded = dict.fromkeys(("left", "right"), 0.0)

    def _begun(self) -> int:
        return sum(len(GIVES_POWER & {one}) for driver in self.cart.drivers.values() for one in driver.begun)

    @rule(request=st.sampled_from(REQUESTS))
    def requests(self, request: Request) -> None:
        cart = self.cart
        permission, drivers = cart.permission, cart.drivers
        used = [driver for name, driver in drivers.items() if name not in permission.rules.without]
        ready = all(
            driver.state is DriverState.ACTIVE
            and driver.feedback.power is Power.ON
            and not driver.feedback.fault
            and cart.now - driver.feedback.received_at < 10 * cart.robot.cycle
            for driver in used
        )
        still = all(abs(drivers[name].feedback.velocity) < 0.2 for name in ("left", "right"))
        before = permission.motion
        answer = cart.requests(request)
        self.answers.append(answer)
        assert answer.reason or isinstance(request, ChangeDriver)
        assert not (answer.accepted and answer.temporary)
        if isinstance(request, Arm) and answer.accepted:
            assert before is Motion.ARMED or (before is Motion.DISARMED and ready and still)
            assert permission.armed
        if isinstance(request, EmergencyStop) or (isinstance(request, Disarm) and request.force):
            assert answer.accepted
            assert permission.forbids_power
        if isinstance(request, ClearEmergencyStop) and answer.accepted:
            assert permission.armed is (before is Motion.ARMED), "a reset starts nothing"
            assert not permission.emergency_stopped
        if not isinstance(request, Arm):
            assert not (permission.armed and before is not Motion.ARMED), "only a request to arm arms"
        if not answer.accepted and not isinstance(request, Arm):
            assert permission.motion is before
        # The same once more changes nothing more.
        after = permission.motion
        if answer.accepted:
            cart.requests(request)
            assert permission.motion is after

    @rule(share=st.sampled_from((0.0, 0.3, 1.0)), brush=st.sampled_from((0.0, 0.5)))
    def moves_the_stick(self, share: float, brush: float) -> None:
        self.cart.ahead, self.cart.brush = share, brush

    @rule(cycles=st.integers(1, 12))
    def time_passes(self, cycles: int) -> None:
        for _ in range(cycles):
            self.cart.runs()
            self.look()

    @rule(name=st.sampled_from(("left", "right", "brush")), power=st.sampled_from(Power))
    def a_device_reports_its_power(self, name: str, power: Power) -> None:
        driver = self.cart.drivers[name]
        driver.feedback = replace(driver.feedback, power=power)

    @rule(name=st.sampled_from(("left", "right", "brush")), speed=st.sampled_from((0.0, 0.5, 9.0)))
    def a_device_moves(self, name: str, speed: float) -> None:
        driver = self.cart.drivers[name]
        driver.feedback = replace(driver.feedback, velocity=speed)

    @rule(name=st.sampled_from(("left", "right", "brush")))
    def a_device_falls_silent_or_speaks_again(self, name: str) -> None:
        self.cart.silent ^= {name}

    @rule(state=st.sampled_from((DriverState.ACTIVE, DriverState.INACTIVE, DriverState.FAILED)))
    def a_driver_is_in_another_state(self, state: DriverState) -> None:
        self.cart.drivers["right"].state = state

    @rule()
    @precondition(lambda self: self.cart.talks)
    def the_station_falls_silent(self) -> None:
        self.cart.talks = False

    @rule()
    def the_station_is_back(self) -> None:
        self.cart.talks = True

    @invariant()
    def look(self) -> None:
        """Hold at every instant."""
        cart, permission = self.cart, self.cart.permission
        given, self.begun = self._begun() - self.begun, self._begun()
        assert not (permission.armed and permission.forbids_power)
        assert not (given and permission.emergency_stopped), "power was given in an emergency stop"
        for name in ("left", "right"):
            newest = cart.drivers[name].set_points[-1:]
            speed = newest[0].value if newest and isinstance(newest[0], Speed) else 0.0
            before, self.commanded[name] = self.commanded[name], speed
            # Without the permission it ramps down, and never up.
            assert permission.armed or abs(speed) <= abs(before) + 1e-9
            assert not permission.powered_off or speed == 0.0 or abs(speed) < abs(before) + 1e-9


TestRequested = Requested.TestCase
TestRequested.settings = settings(max_examples=examples(60), stateful_step_count=40, deadline=None)


class Situation(NamedTuple):
    """What a request meets, beside the motion permission."""

    moves: bool
    """A wheel turns."""
    deflected: bool
    power: Power
    fault: bool
    silent: bool
    state: DriverState
    """Of the right wheel's driver, as the three before."""
    paused: bool


SITUATIONS: Final = [
    Situation(*values)
    for values in product(
        (False, True),
        (False, True),
        (Power.ON, Power.OFF),
        (False, True),
        (False, True),
        (DriverState.ACTIVE, DriverState.INACTIVE),
        (False, True),
    )
]
LASTING, TEMPORARY, GRANTED = "lasting", "temporary", "granted"


def outcome(request: Request, motion: Motion, it: Situation) -> str:
    """Return what the rules say, in the words of a person and in another order than the table's."""
    stopped = "stopped" in motion.value or "terminated" in motion.value
    off, armed = "powered off" in motion.value, motion is Motion.ARMED
    ready = it.power is Power.ON and not it.fault and not it.silent and it.state is DriverState.ACTIVE
    lasting = temporary = False
    match request:
        case Arm() if not armed:
            lasting = stopped or it.deflected
            temporary = it.moves or off or not ready
        case ClearEmergencyStop() if stopped:
            lasting, temporary = "terminated" in motion.value, it.moves
        case Resume() | EnterMode(mode=""):
            lasting = it.paused and it.deflected
        case EnterMode(mode="brushless"):
            lasting, temporary = armed, it.moves
        case Follow(path_follower="ahead"):
            lasting = not armed
        case EnterMode() | Follow(path_follower="no such") | ConfirmPosition():
            lasting = True
    return LASTING if lasting else TEMPORARY if temporary else GRANTED


@pytest.mark.parametrize("motion", Motion)
def test_each_request_in_each_joint_state_is_answered_by_the_rules(motion: Motion) -> None:
    cart = FakeCart()
    cart.arms()
    permission, driver = cart.permission, cart.drivers["right"]
    sound = {name: one.feedback for name, one in cart.drivers.items()}
    wrong = []
    for it, request in product(SITUATIONS, REQUESTS):
        permission.motion, permission.paused, permission.mode = motion, it.paused, ""
        permission.untrusted.clear()
        cart.all_drivers.set_points.clear()
        cart.all_drivers.taken_at.clear()
        for name, one in cart.drivers.items():
            one.feedback = replace(sound[name], received_at=cart.now, sampled_at=cart.now)
        driver.state = it.state
        old = cart.now - (10_000_000_000 if it.silent else 0)
        driver.feedback = replace(
            driver.feedback,
            power=it.power,
            fault="0x8611" if it.fault else "",
            received_at=old,
            sampled_at=old,
        )
        if it.moves:
            left = cart.drivers["left"]
            left.feedback = replace(left.feedback, velocity=5.0)
        cart.ahead = 0.5 if it.deflected else 0.0
        cart.speaks()
        answer = cart.requests(request)
        found = GRANTED if answer.accepted else TEMPORARY if answer.temporary else LASTING
        expected = outcome(request, motion, it)
        if found != expected:
            wrong.append((request, it, found, expected, answer.reason))
        if not answer.accepted and not isinstance(request, Arm):
            assert permission.motion is motion
    assert wrong == []
