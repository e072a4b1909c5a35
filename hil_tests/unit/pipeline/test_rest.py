"""Wheels that turn against each other: the robot is where it was, and does not rest for anybody."""

import math
from dataclasses import replace
from typing import Any, Final, cast

import pytest

from firmware_bridge.bridge.needs import AXIS_STANDS, Instant
from firmware_bridge.drivers.driver import Feedback
from firmware_bridge.intent import NEVER_RECEIVED, Arm, ClearEmergencyStop, Disarm, EmergencyStop, EnterMode
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot_types import find, robot_type_of
from firmware_bridge.safety.snapshot import Facts, Snapshot
from firmware_bridge.units import SECOND
from hil_tests.unit.pipeline.cart import FakeCart

BOUND: Final = 12.0 * (1.0 / 80.0)
"""rad/s: an 80th of the wheels' top speed."""
SPINS: Final = ((BOUND, -BOUND), (-BOUND, BOUND), (BOUND, 0.0), (0.0, -BOUND), (5.0, -5.0))


def spin(cart: FakeCart, left: float, right: float) -> None:
    """Let the wheels be seen to turn with these speeds."""
    for name, speed in (("left", left), ("right", right)):
        driver = cart.drivers[name]
        driver.feedback = replace(driver.feedback, velocity=speed)


@pytest.mark.parametrize(("left", "right"), SPINS)
def test_it_is_not_armed_cleared_or_changed_and_comes_to_rest_disarmed(left: float, right: float) -> None:
    cart = FakeCart()
    cart.runs(10)
    spin(cart, left, right)
    assert cart.requests(Arm()).reason == "arm: the robot still moves"
    assert cart.requests(EnterMode("brushless")).reason == "mode: stop and disarm first"
    spin(cart, 0.0, 0.0)
    assert cart.requests(Arm()).accepted
    spin(cart, left, right)
    assert cart.requests(Disarm()).reason == "disarmed: the robot comes to rest, the drives hold still"
    cart.requests(EmergencyStop())
    assert cart.requests(ClearEmergencyStop()).reason == "clear: the robot still moves"
    spin(cart, 0.0, 0.0)
    assert cart.requests(ClearEmergencyStop()).accepted


@pytest.mark.parametrize(("left", "right"), SPINS)
def test_its_orderly_end_waits_for_each_wheel(left: float, right: float) -> None:
    cart = FakeCart()
    cart.arms()
    spin(cart, left, right)
    assert not cart.pipeline.come_to_standstill(cart.now)[1]
    spin(cart, 0.999 * BOUND, -0.999 * BOUND)
    assert cart.pipeline.come_to_standstill(cart.now)[1]


def test_without_its_brush_it_rests_as_before() -> None:
    cart = FakeCart()
    cart.runs(10)
    assert cart.requests(EnterMode("brushless")).accepted
    spin(cart, BOUND, -BOUND)
    assert cart.requests(Arm()).reason == "arm: the robot still moves"
    spin(cart, 0.0, 0.0)
    assert cart.requests(Arm()).reason != "arm: the robot still moves"


def about(cart: FakeCart, driver: Any) -> Instant:
    """Return a request for the position of an axis, judged now."""

    class OneAxis:
        def place(self, _request: object) -> tuple[Any, float]:
            return driver, 0.5

    others: Any = None
    return Instant(
        title="zero",
        request=None,
        seen=cart.pipeline.known(cart.now),
        events=(),
        permission=cart.permission,
        zeros=cast("Any", OneAxis()),
        guide=others,
        locating=others,
    )


@pytest.mark.interpreted
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_axis_that_moves_by_itself_is_not_given_its_position(sign: float) -> None:
    """The robot rests, whatever its brush does; the brush does not."""
    cart = FakeCart()
    cart.runs(10)
    driver = cart.drivers["brush"]
    bound = driver.axis.standstill_below
    for speed, refused in ((math.nextafter(bound, math.inf), True), (bound, False)):
        driver.feedback = replace(driver.feedback, velocity=sign * speed)
        reason = AXIS_STANDS.refused(about(cart, driver))
        assert (reason is not None, (reason or "").endswith("moves")) == (refused, refused)


RARS: Final[Any] = find("rars")
RULES: Final = robot_type_of(RARS).rules(RARS)
SILENT: Final = RARS.silent_after["left"]


def seen(left_rad_s: float, age: int) -> Snapshot[Any, Any]:
    """Return RARS with a speed report of the left wheel so long ago; all others just reported rest."""
    now = 10 * SECOND
    axes = {axis.name: Feedback(axis.name, received_at=now, sampled_at=now) for axis in RARS.axes}
    axes["left"] = replace(axes["left"], velocity=left_rad_s, received_at=now - age)
    facts = Facts(
        now=now,
        armed=False,
        emergency_stopped=False,
        received_at=NEVER_RECEIVED,
        neutral=True,
        axes=axes,
        sensors={},
        links_lost={},
    )
    rest = robot_type_of(RARS).standstill
    body = RULES[""].kinematics.sensed(axes, {})
    return Snapshot(facts=facts, command=rest, commanded=rest, body=body, pose=Pose(1.0, 2.0, 3.0))


@pytest.mark.parametrize(
    ("mode", "left_rad_s", "age", "rests"),
    [
        ("left_failed", 5.0, SILENT, True),
        ("left_failed", 5.0, SILENT - 1, False),  # it reports, and turns
        ("left_failed", 0.0, 0, True),
        ("right_failed", 5.0, SILENT, False),  # not the one that this mode does without
        ("", 5.0, SILENT, False),
    ],
)
def test_an_axis_that_a_mode_does_without_counts_as_long_as_it_is_received(
    mode: str, left_rad_s: float, age: int, *, rests: bool
) -> None:
    rules = RULES[mode]
    known = rules.sensed(seen(left_rad_s, age))
    assert rules.stopped(known) is rests
    assert rules.at_standstill(known) is rests


def test_what_a_mode_senses_is_the_same_snapshot_with_its_own_body() -> None:
    one = seen(5.0, SILENT)
    command, located = object(), object()
    before: Snapshot[Any, Any] = Snapshot(
        facts=one.facts,
        command=command,
        commanded=one.commanded,
        body=one.body,
        pose=one.pose,
        located=located,  # type: ignore[arg-type] # handed on, whatever it is
    )
    after = RULES["left_failed"].sensed(before)
    assert after.body != before.body
    assert after.body == RULES["left_failed"].kinematics.sensed(before.facts.axes, {})
    assert after.facts is before.facts
    assert after.command is command
    assert (after.commanded, after.pose) == (one.commanded, one.pose)
    assert after.located is located


def test_an_axis_that_is_not_believed_counts_as_one_that_stands() -> None:
    rules, one = RULES[""], seen(5.0, 0)
    known = rules.believed(one, {"left"})
    assert known is not None
    assert rules.stopped(known)
    stands = replace(one.facts.axes["left"], velocity=0.0)
    assert known.facts.axes == {**one.facts.axes, "left": stands}
    assert known.body == rules.kinematics.sensed(known.facts.axes, {})
    assert known.command is one.command
    for others in (set[str](), {"right"}):
        less = rules.believed(one, others)
        assert less is not None
        assert not rules.stopped(less)


def test_where_no_axis_that_carries_is_believed_no_one_knows() -> None:
    names = {axis.name for axis in RARS.axes}
    assert RULES[""].believed(seen(0.0, 0), names) is None
