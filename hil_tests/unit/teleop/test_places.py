"""SET_POSITION_TARGET_LOCAL_NED with a place: one axis goes to x, and to nothing else."""

import math
from typing import Any, Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.robot import CommandForm, Robot
from firmware_bridge.robot_types import find
from firmware_bridge.robots.servo_axis.geometry import AxisGeometry
from firmware_bridge.robots.servo_axis.motion import AxisMotion, AxisState
from firmware_bridge.robots.servo_axis.station import STATION
from hil_tests.unit.teleop.bench import Bench
from hil_tests.unit.teleop.received import texts
from hil_tests.unit.teleop.toy import toy

ROBOT: Final[Any] = find("servo_axis")
TOP: Final = ROBOT.geometry.limits.speed
PLACE, X_ALONE, FORCE = 3576, 3582, 512
NAN, INFINITE = math.nan, math.inf


class AxisBench(Bench[AxisGeometry, AxisMotion, AxisState]):
    """One axis and its operator."""


def bench(robot: Robot[AxisGeometry] = ROBOT) -> AxisBench:
    return AxisBench(robot, STATION, AxisMotion(), AxisState(0.0, 0.0), ("axis",))


def place(x: float, *, y: float = 0.0, z: float = 0.0, mask: int = PLACE, frame: int = 1) -> Any:
    return dialect.MAVLink_set_position_target_local_ned_message(0, 1, 1, frame, mask, x, y, z, *(0.0,) * 8)


@pytest.mark.parametrize("mask", [PLACE, X_ALONE, PLACE | FORCE])
def test_the_axis_is_sent_to_x_at_its_limit(mask: int) -> None:
    one = bench()
    assert one.say(place(1.25, mask=mask)) == []
    assert one.command == AxisMotion(TOP, 1.25)


def test_a_place_is_no_neutral_command_and_a_velocity_of_zero_is() -> None:
    one = bench()
    one.say(place(0.0))
    assert "send a velocity of zero first" in one.operator.intent.deflected
    one.target()
    assert one.operator.intent.deflected == ""
    assert one.command == AxisMotion()


def test_a_stick_at_rest_leaves_the_place_and_a_deflected_one_takes_over() -> None:
    one = bench()
    one.say(place(1.0))
    one.stick()
    assert one.command == AxisMotion(TOP, 1.0)
    one.stick(x=500)
    assert one.command == AxisMotion(0.5 * TOP)


@pytest.mark.parametrize(
    ("message", "why"),
    [
        (place(NAN), "one axis goes to x: a finite number"),
        (place(INFINITE), "one axis goes to x: a finite number"),
        (place(1.0, y=0.5), "with y and z at 0"),
        (place(1.0, z=-0.5), "with y and z at 0"),
        (place(1.0, frame=8), "frame 8; a place is in frame 1"),
        (place(1.0, frame=7), "frame 7; a place is in frame 1"),
        (place(1.0, mask=PLACE & ~0x38), "a place alone is 3576"),
        (place(1.0, mask=PLACE & ~0x400), "a place alone is 3576"),
        (place(1.0, mask=PLACE & ~0x800), "a place alone is 3576"),
        (place(1.0, mask=0), "a place alone is 3576"),
    ],
)
def test_what_is_no_place_of_one_axis_moves_nothing(message: Any, why: str) -> None:
    one = bench()
    refused = "".join(texts(one.say(message)))
    assert why in refused
    assert one.command == AxisMotion()


def test_an_axis_by_speed_and_another_robot_go_to_no_place() -> None:
    axes = [axis.model_copy(update={"command": CommandForm.SPEED}) for axis in ROBOT.axes]
    one = bench(ROBOT.model_copy(update={"axes": tuple(axes)}))
    assert "goes to no place" in "".join(texts(one.say(place(1.0))))
    assert one.command == AxisMotion()
    other = toy()
    before = other.command
    assert "type mask 3576" in "".join(texts(other.say(place(1.0))))
    assert other.command == before


@given(
    x=st.floats(width=32),
    y=st.floats(width=32),
    mask=st.integers(0, 0xFFFF),
    frame=st.integers(0, 21),
)
def test_whatever_comes_no_command_is_out_of_numbers(x: float, y: float, mask: int, frame: int) -> None:
    one = bench()
    one.say(place(x, y=y, mask=mask, frame=frame))
    command = one.command
    assert math.isfinite(command.speed)
    assert command.target is None or command.target == x
