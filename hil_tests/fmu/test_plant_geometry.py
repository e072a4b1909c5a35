"""Steering, scissor and rolling agree with their closed forms (thesis 2.4, 2.5, 3.3)."""

import math
from typing import Any

import pytest

H, KINGPINS, WHEELBASE = 0.030, 0.210, 0.515
B = H * KINGPINS / (2 * WHEELBASE)
RACK_A_RADIAN = 0.030 / 2 / 159


def rack_for(inner_angle: float) -> float:
    tangent = math.tan(abs(inner_angle))
    return math.copysign(tangent * (H**2 + B**2) / (H + B * tangent), inner_angle)  # (4.7)


@pytest.mark.parametrize("degrees", [-60, -30, -5, 0.5, 10, 30, 45, 58.95, 60])
def test_davis_angles_follow_the_rack(bench: Any, degrees: float) -> None:
    inner = math.radians(degrees)
    rack = rack_for(inner)
    now = bench({"angle_steer": rack / RACK_A_RADIAN}).now()
    assert now["rack"] == pytest.approx(rack, rel=1e-12)
    assert now["steer"] == pytest.approx(inner, rel=1e-12)
    near, far = ("steer_left", "steer_right") if degrees > 0 else ("steer_right", "steer_left")
    assert now[near] == pytest.approx(inner, rel=1e-12)
    assert math.tan(abs(now[far])) == pytest.approx(abs(rack) * H / (H**2 + B**2 + B * abs(rack)), rel=1e-12)
    assert abs(now[far]) < abs(inner)


@pytest.mark.parametrize(("degrees", "radius_mm"), [(60.0, 402), (58.95, 415)])
def test_smallest_radii_of_the_thesis(bench: Any, degrees: float, radius_mm: int) -> None:
    now = bench({"angle_steer": rack_for(math.radians(degrees)) / RACK_A_RADIAN}).now()
    radius = KINGPINS / 2 + WHEELBASE / math.tan(now["steer"])  # (2.13)
    assert round(radius * 1000) == radius_mm


def test_small_angles_keep_ackermanns_condition(bench: Any) -> None:
    now = bench({"angle_steer": rack_for(math.radians(1.0)) / RACK_A_RADIAN}).now()
    difference = 1 / math.tan(now["steer_right"]) - 1 / math.tan(now["steer_left"])
    assert difference == pytest.approx(KINGPINS / WHEELBASE, rel=1e-3)


@pytest.mark.parametrize("degrees", [5.0, 10.0, 30.0, 45.0])
def test_scissor_height(bench: Any, degrees: float) -> None:
    nut = 0.3 * (math.cos(math.radians(5.0)) - math.cos(math.radians(degrees)))
    now = bench({"angle_lift": nut / 0.0015 * 2 * math.pi * 25}).now()
    expected = 6 * 0.3 * (math.sin(math.radians(degrees)) - math.sin(math.radians(5.0)))  # (2.16)
    assert now["lift_height"] == pytest.approx(expected, abs=1e-12)


def test_collapsed_and_extended_heights_of_the_thesis() -> None:
    # 156 mm and "1.3" m are what the assumed link length of 300 mm was chosen for.
    assert round(1.8 * math.sin(math.radians(5.0)) * 1000) in {156, 157}
    assert round(1.8 * math.sin(math.radians(45.0)), 1) == 1.3


@pytest.mark.parametrize(("left", "right"), [(100.0, 100.0), (-40.0, 90.0), (300.0, -300.0)])
def test_wheels_roll_without_slip_but_for_their_tyres_bend(bench: Any, left: float, right: float) -> None:
    """On a floor that lets nothing slip a wheel's way is the robot's and the bend of its tyre, exactly."""
    plant = bench({"speed_left": left, "speed_right": right, "floor_friction": 1e12, "angle_steer": 200.0})
    now = plant.now()
    wheel_left, wheel_right = now["speed_left"] / 26, now["speed_right"] / 26
    assert now["speed"] == pytest.approx(0.05 * (wheel_left + wheel_right) / 2, rel=1e-12, abs=1e-15)
    # (5.1) corrected: right minus left
    assert now["yaw_rate"] == pytest.approx((wheel_right - wheel_left) * 0.05 / 0.4, rel=1e-12, abs=1e-15)
    for wheel in ("rear_left", "rear_right", "front_left", "front_right"):
        assert plant.plant.read(f"slip_ahead_{wheel}") == pytest.approx(0.0, abs=1e-12)
    before = [plant.plant.read(f"tyre_ahead_rear_{side}") for side in ("left", "right")]
    now = plant.runs(0.2, left=3.0, steer=12.0)
    bends = [plant.plant.read(f"tyre_ahead_rear_{side}") for side in ("left", "right")]
    ways = [
        0.05 * now[f"angle_{side}"] / 26 - (after - was)
        for side, after, was in zip(("left", "right"), bends, before, strict=True)
    ]
    assert now["heading"] == pytest.approx((ways[1] - ways[0]) / 0.4, rel=1e-9, abs=1e-12)
