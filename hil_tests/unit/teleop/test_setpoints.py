"""Stick and velocity before a robot gives them a meaning; forward, left and up are positive."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge import robot_types
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.teleop.driving import pressed, stick_of
from firmware_bridge.teleop.incoming import UNUSED, Lever
from firmware_bridge.teleop.setpoints import velocity_of
from firmware_bridge.teleop.station import Stick, Twist, Unusable, Velocity
from hil_tests.unit.teleop.bench import bench_of, target_message
from hil_tests.unit.teleop.received import texts

STATION = robot_types.robot_type_of(robot_types.find("rars")).station
LARGEST = Twist(0.5, 0.0, 1.25)


def stick(x: int = 0, y: int = 0, z: int = 0, r: int = 0, up: int = 1) -> Stick | Unusable:
    message = dialect.MAVLink_manual_control_message(1, x, y, z, r, 0)
    reported = stick_of(message, STATION, Lever(held=bool(up)))
    return reported if isinstance(reported, Unusable) else reported.stick


def target(vx: float = 0.0, yaw_rate: float = 0.0, **other: Any) -> Velocity | Unusable:
    return velocity_of(target_message(vx, yaw_rate, **other), LARGEST)


@pytest.mark.parametrize(
    ("given_axes", "share"),
    [
        ({"x": 0}, {"forward": 0.0}),
        ({"x": 1000}, {"forward": 1.0}),
        ({"x": -250}, {"forward": -0.25}),
        ({"x": UNUSED}, {"forward": None}),
        ({"y": 500}, {"left": -0.5}),
        ({"y": -1000}, {"left": 1.0}),
        ({"y": UNUSED}, {"left": None}),
        ({"r": 1000}, {"turn": -1.0}),
        ({"r": -500}, {"turn": 0.5}),
        ({"r": UNUSED}, {"turn": None}),
        ({"z": 1000}, {"up": 1.0}),
        ({"z": -500}, {"up": -0.5}),
        ({"z": 51}, {"up": 0.051}),
        ({"z": -51}, {"up": -0.051}),
        ({"z": 50}, {"up": None}),
        ({"z": -50}, {"up": None}),
        ({"z": UNUSED}, {"up": None}),
    ],
)
def test_an_axis_is_a_share_with_the_robots_sign(given_axes: dict[str, int], share: dict[str, Any]) -> None:
    rest = {"forward": 0.0, "left": 0.0, "turn": 0.0, "up": None}
    assert stick(**given_axes) == Stick(**(rest | share))


@pytest.mark.parametrize("z", [-0x8000, -1000, 0, 500, 1000])
def test_what_z_does_is_nobodys_business_while_it_does_not_count(z: int) -> None:
    assert stick(z=z, up=0) == Stick(0.0, 0.0, 0.0, None)


@pytest.mark.parametrize("axis", ["x", "y", "r", "z"])
@pytest.mark.parametrize("value", [1001, -1001, 0x7FFE, -0x8000])
def test_a_stick_beyond_its_stop_is_refused(axis: str, value: int) -> None:
    found = stick(**{axis: value})
    assert isinstance(found, Unusable)
    assert f"{axis} = {value}" in found.reason


@given(st.integers(0, 0xFFFF), st.integers(0, 15))
def test_a_button_is_a_bit(buttons: int, button: int) -> None:
    assert pressed(buttons, button) is (format(buttons, "016b")[15 - button] == "1")
    assert not pressed(buttons, None)


@pytest.mark.parametrize("frame", [8, 9, 12])
def test_frames_along_the_robot_are_followed(frame: int) -> None:
    assert target(0.2, 0.0, frame=frame) == Velocity(0.2, 0.0, 0.0)


@pytest.mark.parametrize("frame", sorted(set(range(22)) - {8, 9, 12}))
def test_other_frames_are_refused(frame: int) -> None:
    found = target(0.2, 0.0, frame=frame)
    assert isinstance(found, Unusable)
    assert f"frame {frame}" in found.reason


@pytest.mark.parametrize(
    ("mask", "yaw_rate"),
    [(0x05E7, 0.5), (0x05C7, 0.5), (0x0DE7, None), (0x0DC7, None), (4039, None), (0x05E7 | 0x200, 0.5)],
    ids=[
        "velocity and yaw rate",
        "the same with vz, as MAVSDK and MAVROS send it",
        "velocity only",
        "velocity only with vz",
        "DroneKit's, which states that an acceleration would be a force",
        "the same with yaw rate",
    ],
)
def test_masks_of_velocity_are_followed(mask: int, yaw_rate: float | None) -> None:
    assert target(0.31, -0.5, mask=mask) == Velocity(0.31, 0.0, yaw_rate)


@pytest.mark.parametrize(
    "mask",
    [0x0000, 0x0DFC, 0x09FF, 0x01FF, 0x0FFF, 0x0DE6, 0x09E7, 2503, 2496, 0x05E7 & ~0x40, 0xFFFF, 0x05EF],
)
def test_other_masks_are_refused(mask: int) -> None:
    found = target(0.2, 0.0, mask=mask)
    assert isinstance(found, Unusable)
    assert f"mask {mask}" in found.reason


@pytest.mark.parametrize("mask", [0x09E7, 2503, 4039, 1479, 0x01C7])
@pytest.mark.parametrize("frame", [1, 7, 8, 9, 12])
def test_to_stand_still_is_understood_in_any_frame_with_any_heading(mask: int, frame: int) -> None:
    found = target(0.0, 0.0, mask=mask, frame=frame)
    assert isinstance(found, Velocity)
    assert found.deflected == ""


@pytest.mark.parametrize("frame", [1, 7])
@pytest.mark.parametrize(
    ("heading", "north", "east", "forward", "left"),
    [
        (0.0, 0.3, 0.1, 0.3, -0.1),
        (90.0, 0.3, 0.1, -0.1, -0.3),
        (-90.0, 0.3, 0.1, 0.1, 0.3),
        (180.0, 0.3, 0.1, -0.3, 0.1),
        (30.0, math.cos(math.radians(30)), -math.sin(math.radians(30)), 1.0, 0.0),
    ],
)
def test_a_velocity_on_the_map_is_turned_into_one_along_a_robot_that_goes_any_way(
    frame: int, heading: float, north: float, east: float, *, forward: float, left: float
) -> None:
    message = target_message(north, 0.2, vy=east, frame=frame)
    found = velocity_of(message, Twist(1.0, 1.0, 1.0), math.radians(heading))
    assert isinstance(found, Velocity)
    assert (found.forward_mps, found.left_mps, found.yaw_rate_rad_s) == pytest.approx((forward, left, -0.2))
    assert isinstance(velocity_of(message, Twist(1.0, 1.0, 1.0), None), Unusable)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("field", ["vx", "vy", "yaw_rate"])
def test_what_is_not_finite_is_refused(field: str, value: float) -> None:
    found = target(**{field: value})
    assert isinstance(found, Unusable)
    assert found.key == "not finite"


def test_fields_that_the_mask_ignores_may_hold_anything() -> None:
    assert target(0.2, math.nan, mask=0x0DE7) == Velocity(0.2, 0.0, None)
    assert target(0.2, 0.0, vz=math.nan) == Velocity(0.2, 0.0, 0.0)


def test_right_and_clockwise_become_left_and_counter_clockwise() -> None:
    assert target(0.2, 0.3, vy=0.1) == Velocity(0.2, -0.1, -0.3)


def test_no_robot_here_climbs() -> None:
    found = target(0.2, 0.0, vz=0.01, mask=0x05C7)
    assert isinstance(found, Unusable)
    assert found.key == "vertical"


@pytest.mark.parametrize(
    ("vx", "vy", "yaw_rate"),
    [
        (5.01, 0.0, 0.0),
        (-5.01, 0.0, 0.0),
        (0.0, 5.01, 0.0),
        (4.0, -4.0, 0.0),
        (0.2, 0.0, 12.6),
        (0.2, 0.0, -12.6),
        (3e38, 3e38, 0.0),
    ],
)
def test_the_absurd_is_refused(vx: float, vy: float, yaw_rate: float) -> None:
    found = target(vx, yaw_rate, vy=vy)
    assert isinstance(found, Unusable)
    assert found.key == "absurd"


@pytest.mark.parametrize(
    ("vx", "vy", "yaw_rate"), [(5.0, 0.0, 0.0), (0.0, -5.0, 0.0), (-0.8, 0.1, 0.0), (0.1, 0.0, 12.4)]
)
def test_what_is_merely_too_much_is_left_to_the_interlocks(vx: float, vy: float, yaw_rate: float) -> None:
    assert target(vx, yaw_rate, vy=vy) == Velocity(vx, -vy, -yaw_rate)


YAW_RATE_ALONE = 1535


def test_a_yaw_rate_alone_is_one_whatever_stands_in_the_velocity() -> None:
    found = target(math.nan, -0.25, mask=YAW_RATE_ALONE, vy=7.0)
    assert found == Velocity(0.0, 0.0, 0.25)


@pytest.mark.parametrize(
    ("name", "turns"), [("rome", True), ("diff_drive", True), ("climber", True), ("rars", False)]
)
def test_a_yaw_rate_alone_turns_a_robot_that_can_turn_where_it_stands(name: str, *, turns: bool) -> None:
    bench = bench_of(name)
    bench.target(0.0, 0.0)
    still = bench.command
    stated = "".join(texts(bench.target(0.0, 0.25, mask=YAW_RATE_ALONE)))
    assert (bench.command != still) is turns
    why = "this robot does not turn on the spot; send a velocity, too"
    assert stated == ("" if turns else f"SET_POSITION_TARGET_LOCAL_NED refused: {why}")
    assert "".join(texts(bench.target(0.0, 0.0, mask=YAW_RATE_ALONE))) == "", "to stand still it can"
