"""Commands to a motor, in any fast sequence: the guard finds nothing to refuse in them."""

from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.families.motor_shield.driver.regulator import Pwm, Ticks
from firmware_bridge.families.motor_shield.guard.commands import Inputs
from firmware_bridge.families.motor_shield.guard.rules import GuardedMotor
from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, Nanoseconds

ROBOTS: Final = {name: over_protocol(find("rome"), name, 3) for name in ("ros-arduino-bridge", "arduinoio")}
CYCLE: Final[Nanoseconds] = 50 * MILLISECOND
ORDERS: Final = st.lists(
    st.tuples(st.floats(-9.0, 9.0) | st.just(0.0) | st.none(), st.integers(1, 120)), min_size=1, max_size=30
)
"""A command in rad/s, None for a stop at once, and the milliseconds since the one before."""


def regulator_of(robot: AnyRobot) -> Ticks | Pwm:
    axis = robot.axes[0]
    return Ticks(axis, CYCLE) if ShieldLink.of_link(robot, "board").stops_itself else Pwm(axis, CYCLE)


def inputs(output: int) -> Inputs:
    return Inputs(abs(output), in1=output > 0, in2=output < 0)


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
@given(orders=ORDERS)
def test_words_between_two_cycles_are_none_that_the_guard_refuses(
    robot: AnyRobot, orders: list[tuple[float | None, int]]
) -> None:
    regulator, guard = regulator_of(robot), GuardedMotor(robot.axes[0], robot)
    now: Nanoseconds = 0
    for wanted, after in orders:
        now += after * MILLISECOND
        if wanted is None:
            regulator.reset()
        else:
            regulator.next(wanted, 0.0, after * MILLISECOND)
        reported = inputs(regulator.output)
        assert guard.refuses(reported, now) is None
        guard.sent(reported, now)


def test_the_way_back_begins_at_the_next_cycle_not_at_a_word_in_between() -> None:
    regulator = regulator_of(ROBOTS["ros-arduino-bridge"])
    reported = [
        regulator.next(wanted, None, after * MILLISECOND)
        for wanted, after in ((0.2, 50), (-0.2, 50), (-0.2, 20), (-0.2, 23))
    ]
    assert reported == [3, 0, 0, -3]
