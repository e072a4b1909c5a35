"""Meaning of a stick and a velocity for RARS; forward, left and up are positive."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.robots.rars.motion import RarsMotion
from firmware_bridge.robots.rars.station import steer_for
from hil_tests.unit.teleop.bench import rars
from hil_tests.unit.teleop.received import texts

RARS = rars().robot
DEG = math.pi / 180.0
HELD = 30 * DEG
"""Earlier angle of the steering."""


def stick(x: int = 0, y: int = 0x7FFF, z: int = 0, r: int = 0, buttons: int = 0) -> RarsMotion:
    bench = rars()
    bench.stick(r=-500)
    assert bench.command.steer_rad == pytest.approx(HELD)
    assert bench.stick(x=x, y=y, z=z, r=r, buttons=buttons) == []
    return bench.command


def target(vx: float = 0.0, yaw_rate: float = 0.0, **other: Any) -> RarsMotion | str:
    """Return the command, or the reason for which there is none."""
    bench = rars()
    bench.stick(r=-500)
    replies = bench.target(vx, yaw_rate, **other)
    return "".join(texts(replies)) or bench.command


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
        ({"r": 0x7FFF, "y": 0x7FFF}, 0.0, 0.0, 0.0),
        ({"x": 0x7FFF}, 0.0, 0.0, 0.0),
        ({"z": 0}, 0.0, 0.0, 0.0),
        ({"z": 500}, 0.0, 0.0, 0.0),
        ({"z": 1000}, 0.0, 0.0, 0.0),
        ({"z": -0x8000}, 0.0, 0.0, 0.0),
        ({"z": -1000, "buttons": 0b0011}, 0.0, 0.0, 0.0),
        ({"z": 1000, "buttons": 0b1000}, 0.0, 0.0, 0.1),
        ({"z": -500, "buttons": 0b1000}, 0.0, 0.0, -0.05),
        ({"z": 50, "buttons": 0b1000}, 0.0, 0.0, 0.0),
        ({"z": 51, "buttons": 0b1000}, 0.0, 0.0, 0.0051),
        ({"z": 0x7FFF, "buttons": 0b1000}, 0.0, 0.0, 0.0),
    ],
)
def test_a_stick(given_axes: dict[str, int], speed: float, steer: float, lift_rate: float) -> None:
    wanted = stick(**given_axes)
    assert wanted.speed_mps == pytest.approx(speed)
    assert wanted.steer_rad == pytest.approx(steer)
    assert wanted.lift_rate_mps == pytest.approx(lift_rate)


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
    wanted = target(vx, yaw_rate)
    assert isinstance(wanted, RarsMotion)
    assert wanted.steer_rad == pytest.approx(steer_deg * DEG)
    assert wanted.speed_mps == pytest.approx(vx)


def test_without_a_yaw_rate_it_goes_straight_on() -> None:
    wanted = target(0.3, 0.5, mask=0x0DE7)
    assert isinstance(wanted, RarsMotion)
    assert wanted.steer_rad == 0.0


@pytest.mark.parametrize("yaw_rate", [0.5, 0.0, -0.5])
@pytest.mark.parametrize("vx", [0.0, 0.0009, -0.0009])
def test_a_robot_that_stands_keeps_its_steering(vx: float, yaw_rate: float) -> None:
    wanted = target(vx, yaw_rate)
    assert isinstance(wanted, RarsMotion)
    assert wanted.steer_rad == pytest.approx(HELD)


@given(st.floats(-0.5, 0.5).filter(lambda v: abs(v) >= 0.001), st.floats(-60.0, 60.0))
def test_the_angle_gives_the_yaw_rate_back(speed: float, steer_deg: float) -> None:
    base = RARS.geometry.base
    steer = steer_deg * DEG
    curvature = (
        math.copysign(1.0 / (base.kingpin_distance_m / 2.0 + base.wheelbase_m / math.tan(abs(steer))), steer)
        if steer
        else 0.0
    )
    found = steer_for(speed, speed * curvature, base)
    assert found is not None
    assert found == pytest.approx(steer, abs=1e-9)


@pytest.mark.parametrize(
    ("other", "word"), [({"vy": 0.01}, "forward"), ({"vz": 0.01, "mask": 0x05C7}, "plane")]
)
def test_it_moves_neither_sideways_nor_up(other: dict[str, Any], word: str) -> None:
    assert word in str(target(0.2, 0.0, **other))


@pytest.mark.parametrize(
    ("vx", "yaw_rate"), [(5.01, 0.0), (-5.01, 0.0), (0.2, 12.1), (0.2, -12.1), (3e38, 0.0)]
)
def test_the_absurd_is_refused(vx: float, yaw_rate: float) -> None:
    assert "SET_POSITION_TARGET_LOCAL_NED refused" in str(target(vx, yaw_rate))


@pytest.mark.parametrize(("vx", "yaw_rate"), [(5.0, 0.0), (-0.8, 0.0), (0.1, 2.0)])
def test_what_is_merely_too_much_is_left_to_the_interlocks(vx: float, yaw_rate: float) -> None:
    assert isinstance(target(vx, yaw_rate), RarsMotion)


def test_a_velocity_ends_the_lifts_rate_and_keeps_its_target() -> None:
    bench = rars()
    bench.stick(z=1000, buttons=0b1000)
    bench.target(0.1, 0.0)
    assert bench.command.lift_rate_mps == 0.0
    bench.order(400, 1)
    bench.report()
    bench.order(187, 1)
    height = bench.command.lift_m
    bench.target(0.1, 0.0)
    assert bench.command.lift_m == height is not None


@pytest.mark.parametrize(("command", "params"), [(400, (1,)), (400, (0, 21196)), (5300, (0,)), (5300, (1,))])
def test_a_change_of_state_ends_the_lifts_rate(command: int, params: tuple[float, ...]) -> None:
    bench = rars()
    bench.stick(x=500, z=1000, buttons=0b1000)
    bench.order(command, *params)
    assert (bench.command.lift_rate_mps, bench.command.speed_mps) == (0.0, 0.25)
