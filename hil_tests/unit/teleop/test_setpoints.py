"""What a stick and a velocity mean for the robot; forward and left are positive."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge import robot as robots
from firmware_bridge.teleop.mavlink import dialect
from firmware_bridge.teleop.setpoints import Setpoint, Unusable, of_stick, of_target, steer_for

RARS = robots.find("rars")
DEG = math.pi / 180.0


def stick(x: int = 0, y: int = 0x7FFF, z: int = 0, r: int = 0, buttons: int = 0) -> Setpoint | Unusable:
    return of_stick(dialect.MAVLink_manual_control_message(1, x, y, z, r, buttons), RARS)


def target(vx: float = 0.0, yaw_rate: float = 0.0, **other: Any) -> Setpoint | Unusable:
    fields = {"vy": 0.0, "vz": 0.0, "mask": 1511, "frame": 8} | other
    rest = (0.0,) * 4
    return of_target(
        dialect.MAVLink_set_position_target_local_ned_message(
            0,
            1,
            1,
            fields["frame"],
            fields["mask"],
            0.0,
            0.0,
            0.0,
            vx,
            fields["vy"],
            fields["vz"],
            *rest,
            yaw_rate,
        ),
        RARS,
    )


@pytest.mark.parametrize(
    ("given_axes", "speed", "steer", "lift_rate"),
    [
        ({"x": 0}, 0.0, 0.0, 0.0),
        ({"x": 1000}, 0.5, 0.0, 0.0),
        ({"x": -1000}, -0.5, 0.0, 0.0),
        ({"x": 500, "r": -250}, 0.25, 15 * DEG, 0.0),
        ({"r": 1000}, 0.0, -60 * DEG, 0.0),
        ({"r": -1000}, 0.0, 60 * DEG, 0.0),
        ({"r": 0x7FFF, "y": 500}, 0.0, -30 * DEG, 0.0),
        ({"r": 0, "y": 500}, 0.0, 0.0, 0.0),
        ({"r": 0x7FFF, "y": 0x7FFF}, 0.0, None, 0.0),
        ({"x": 0x7FFF}, 0.0, 0.0, 0.0),
        ({"z": 0}, 0.0, 0.0, 0.0),
        ({"z": 500}, 0.0, 0.0, 0.0),
        ({"z": 1000}, 0.0, 0.0, 0.0),
        ({"z": -1000, "buttons": 0b0111}, 0.0, 0.0, 0.0),
        ({"z": 1000, "buttons": 0b1000}, 0.0, 0.0, 0.1),
        ({"z": -500, "buttons": 0b1000}, 0.0, 0.0, -0.05),
        ({"z": 50, "buttons": 0b1000}, 0.0, 0.0, 0.0),
        ({"z": 51, "buttons": 0b1000}, 0.0, 0.0, 0.0051),
        ({"z": 0x7FFF, "buttons": 0b1000}, 0.0, 0.0, 0.0),
    ],
)
def test_a_stick(given_axes: dict[str, int], speed: float, steer: float | None, lift_rate: float) -> None:
    wish = stick(**given_axes)
    assert isinstance(wish, Setpoint)
    assert wish.speed_mps == pytest.approx(speed)
    assert wish.steer_rad == (None if steer is None else pytest.approx(steer))
    assert wish.lift_rate_mps == pytest.approx(lift_rate)


@pytest.mark.parametrize("axis", ["x", "y", "r", "z"])
@pytest.mark.parametrize("value", [1001, -1001, 0x7FFE, -0x8000])
def test_a_stick_beyond_its_stop_is_refused(axis: str, value: int) -> None:
    wish = stick(**{axis: value}, buttons=0b1000)
    assert isinstance(wish, Unusable)
    assert f"{axis} = {value}" in wish.reason


def test_what_z_does_is_nobodys_business_while_its_button_is_up() -> None:
    assert isinstance(stick(z=-0x8000), Setpoint)


# R = a_k / 2 + w cot(theta), a_k = 0.21 m, w = 0.515 m (thesis 2.13): 45 degrees turn with R = 0.62 m.
@pytest.mark.parametrize(
    ("vx", "yaw_rate", "steer_deg"),
    [
        (0.31, -0.5, 45.0),
        (0.31, 0.5, -45.0),
        (-0.31, 0.5, 45.0),
        (-0.31, -0.5, -45.0),
        (0.3, 0.0, 0.0),
        (0.105, -1.0, 90.0),
    ],
)
def test_a_yaw_rate_becomes_the_inner_wheels_angle(vx: float, yaw_rate: float, steer_deg: float) -> None:
    wish = target(vx, yaw_rate)
    assert isinstance(wish, Setpoint)
    assert wish.steer_rad == pytest.approx(steer_deg * DEG)
    assert wish.speed_mps == vx


def test_a_robot_that_stands_keeps_its_steering() -> None:
    assert target(0.0, 0.5) == Setpoint(0.0, None)
    assert target(0.0, 0.0) == Setpoint(0.0, None)


@given(st.floats(-0.5, 0.5).filter(lambda v: abs(v) >= 0.001), st.floats(-60.0, 60.0))
def test_the_angle_gives_the_yaw_rate_back(speed: float, steer_deg: float) -> None:
    base = RARS.base
    steer = steer_deg * DEG
    bend = (
        math.copysign(1.0 / (base.kingpin_distance_m / 2.0 + base.wheelbase_m / math.tan(abs(steer))), steer)
        if steer
        else 0.0
    )
    found = steer_for(speed, speed * bend, base)
    assert found is not None
    assert found == pytest.approx(steer, abs=1e-9)


@pytest.mark.parametrize("frame", [8, 9, 12])
def test_frames_along_the_robot_are_followed(frame: int) -> None:
    assert target(0.2, 0.0, frame=frame) == Setpoint(0.2, 0.0)


@pytest.mark.parametrize("frame", sorted(set(range(22)) - {8, 9, 12}))
def test_other_frames_are_refused(frame: int) -> None:
    wish = target(0.2, 0.0, frame=frame)
    assert isinstance(wish, Unusable)
    assert f"frame {frame}" in wish.reason


@pytest.mark.parametrize(
    ("mask", "steer"),
    [(0x05E7, True), (0x05C7, True), (0x0DE7, False), (0x0DC7, False)],
    ids=["velocity and yaw rate", "the same with vz", "velocity only", "velocity only with vz"],
)
def test_masks_of_velocity_are_followed(mask: int, steer: bool) -> None:  # noqa: FBT001 - a table
    wish = target(0.31, -0.5, mask=mask)
    assert isinstance(wish, Setpoint)
    assert wish.steer_rad == pytest.approx(45.0 * DEG if steer else 0.0)


@pytest.mark.parametrize(
    "mask", [0x0000, 0x0DFC, 0x09FF, 0x05FF, 0x0FFF, 0x0DE6, 0x09E7, 0x05E7 | 0x200, 0xFFFF, 0x05EF]
)
def test_other_masks_are_refused(mask: int) -> None:
    wish = target(0.2, 0.0, mask=mask)
    assert isinstance(wish, Unusable)
    assert f"mask {mask}" in wish.reason


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("field", ["vx", "vy", "yaw_rate"])
def test_what_is_not_finite_is_refused(field: str, value: float) -> None:
    wish = target(**{field: value})
    assert isinstance(wish, Unusable)
    assert wish.key == "not finite"


def test_fields_that_the_mask_ignores_may_hold_anything() -> None:
    assert target(0.2, math.nan, mask=0x0DE7) == Setpoint(0.2, 0.0)
    assert target(0.2, 0.0, vz=math.nan) == Setpoint(0.2, 0.0)


@pytest.mark.parametrize("other", [{"vy": 0.01}, {"vz": 0.01, "mask": 0x05C7}])
def test_the_robot_moves_neither_sideways_nor_up(other: dict[str, Any]) -> None:
    wish = target(0.2, 0.0, **other)
    assert isinstance(wish, Unusable)
    assert wish.key == "sideways"


@pytest.mark.parametrize(
    ("vx", "yaw_rate"), [(5.01, 0.0), (-5.01, 0.0), (0.2, 12.1), (0.2, -12.1), (3e38, 0.0)]
)
def test_the_absurd_is_refused(vx: float, yaw_rate: float) -> None:
    wish = target(vx, yaw_rate)
    assert isinstance(wish, Unusable)
    assert wish.key == "absurd"


@pytest.mark.parametrize(("vx", "yaw_rate"), [(5.0, 0.0), (-0.8, 0.0), (0.1, 2.0)])
def test_what_is_merely_too_much_is_left_to_the_interlocks(vx: float, yaw_rate: float) -> None:
    assert isinstance(target(vx, yaw_rate), Setpoint)
