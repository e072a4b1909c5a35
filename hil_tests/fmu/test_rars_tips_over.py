"""RARS lifts its wheels, falls back onto them, or tips over: braking, a curve, a wheel without load."""

import math
from typing import Final

import pytest

from firmware_bridge.motion.standing import Standing
from fmu.rars_tipping.parameters import SETS
from hil_tests.fmu.tipping_bench import BRAKED, GRIPS, LOADS, RAISED, RECTANGLE, P, rolling, tipping

REAR_HEAVY: Final = SETS["2.3.1"]
MAX_SPEED: Final = 0.5
"""m/s of the robot file's limit."""


def test_a_stop_while_backing_lifts_the_front_and_it_falls_back() -> None:
    with tipping(REAR_HEAVY, GRIPS, RAISED, rolling(-MAX_SPEED)) as bench:
        pitches = [bench.runs(0.01)["pitch"] for _ in range(100)]
        now = bench.now()
    assert 0.02 < max(pitches) < 0.05
    assert min(pitches) > -1e-3, "no restitution: it does not rock on over its front wheels"
    assert [now["tipped"], now["pitch"]] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert min(now[name] for name in LOADS) > 50.0


@pytest.mark.parametrize(("speed", "tips"), [(MAX_SPEED, 1.0), (0.1, 0.0)])
def test_a_stop_while_backing_downhill_tips_it_over_backwards(speed: float, tips: float) -> None:
    slope = math.radians(12.0)
    with tipping(REAR_HEAVY, GRIPS, RAISED, rolling(-speed), slope=slope) as bench:
        assert bench.runs(3.0)["tipped"] == tips


def test_rear_brakes_alone_never_tip_it_over_forwards() -> None:
    # The rear wheels' grip goes with their load, before it would lift them.
    with tipping(GRIPS, RAISED, rolling(MAX_SPEED), slope=math.radians(-20.0)) as bench:
        for _ in range(100):
            now = bench.runs(0.01)
            assert now["pitch"] == pytest.approx(0.0, abs=1e-9)
            assert now["load_rear_left"] > 50.0


@pytest.mark.parametrize(("speed", "tips"), [(0.25, 0.0), (0.65, 1.0)])
def test_a_curve_across_a_slope_tips_it_over_sideways(speed: float, tips: float) -> None:
    radius, k = 0.42, P["torque_constant_left"]
    shafts = {
        side: speed / P["wheel_radius"] * P["gear_left"] * (radius + sign * P["rear_track"] / 2) / radius
        for side, sign in (("left", -1), ("right", 1))
    }
    start = {f"speed_{side}": shaft for side, shaft in shafts.items()}
    start |= {"angle_steer": 440.0, "heading": -math.pi / 2 - 0.9, "slope": math.radians(23.0)}
    with tipping(REAR_HEAVY, GRIPS, RAISED, start) as bench:
        volts = {side: k * shaft + 0.3 for side, shaft in shafts.items()}
        readings = [bench.runs(0.02, **volts) for _ in range(100)]
    assert (max(row["roll"] for row in readings) > 1.0) == bool(tips)
    assert readings[-1]["tipped"] == tips


def test_what_has_tipped_over_stays_so_until_reset() -> None:
    with tipping(REAR_HEAVY, GRIPS, RAISED, rolling(-MAX_SPEED), slope=math.radians(15.0)) as bench:
        before = bench.plant.save_state()
        assert bench.runs(3.0)["tipped"] == 1.0
        bench.plant.change("slope", 0.0)
        bench.plant.change("lift_payload", 0.0)
        for volts in (24.0, -24.0):
            now = bench.runs(1.0, left=volts, right=volts)
            assert now["tipped"] == 1.0
            assert now["pitch"] == pytest.approx(math.pi / 2, abs=1e-3)
            assert [now["speed"], now["yaw_rate"]] == pytest.approx([0.0, 0.0], abs=1e-4)
            assert [now[name] for name in LOADS] == [0.0] * 4
        bench.plant.restore_state(before)
        assert bench.runs(0.0)["tipped"] == 0.0


def test_a_lifted_wheel_has_no_traction() -> None:
    # On the right edge of its support: the left wheels carry nothing.
    slope = math.radians(26.0)
    with tipping(REAR_HEAVY, BRAKED, RAISED, slope=slope, slope_heading=math.pi / 2) as bench:
        while bench.now()["roll"] < 0.02:
            bench.runs(0.01)
        for side in ("rear_left", "front_left"):
            assert bench.plant.read(f"load_{side}") == 0.0
            for way in ("ahead", "left"):
                assert bench.plant.read(f"force_{way}_{side}") == pytest.approx(0.0, abs=1e-5)
        assert bench.plant.read("force_left_rear_right") > 100.0


def test_it_falls_back_when_the_slope_ends_before_the_unstable_point() -> None:
    slope, uphill = math.radians(26.0), math.pi / 2
    with tipping(REAR_HEAVY, BRAKED, RAISED, slope=slope, slope_heading=uphill) as bench:
        while bench.now()["roll"] < 0.05:
            assert bench.runs(0.01)["zmp_margin"] < 0.0
        bench.plant.change("slope", math.radians(15.0))
        rolls = [bench.runs(0.01)["roll"] for _ in range(100)]
        assert rolls[-1] == pytest.approx(0.0, abs=1e-6)
        assert min(rolls) > -2e-3
        assert bench.now()["zmp_margin"] > 0.05


def test_the_pendulum_turns_as_its_closed_form_does() -> None:
    # About the rear contacts, from rest a little beyond the limit: theta'' = lambda^2 (theta - theta_0).
    slope = math.radians(20.0)
    with tipping(SETS["2.3.1_rectangle"], BRAKED, RAISED, slope=slope) as bench:
        bench.runs(0.2)
        first = bench.now()
        second = bench.runs(0.1)
        z, x, mass = first["centre_height"], 0.141, 80.0
        apart = 70 * 10 / 80 * (1.5 - 0.19 - 4.0 / 70) ** 2
        inertia = P["pitch_inertia"] + apart + mass * (x**2 + z**2)
        arm, angle = math.hypot(x, z), math.atan2(z, x)
        middle = (first["pitch"] + second["pitch"]) / 2
        wanted = -mass * 9.81 * arm * math.cos(angle + middle + slope) / inertia
    assert (second["pitch_rate"] - first["pitch_rate"]) / 0.1 == pytest.approx(wanted, rel=0.02)


@pytest.mark.parametrize(("share", "slides"), [(0.93, True), (1.07, False)])
def test_nose_downhill_its_rear_wheels_hold_it_by_their_share_of_the_load(
    share: float, *, slides: bool
) -> None:
    """The same moments as the governor's: 10 kg on the raised table, 18 degrees, front wheels that roll."""
    pitch = math.radians(-18.0)
    contacts = ((0.0, -0.168), (0.515, -0.168), (0.515, 0.168), (0.0, 0.168))
    needed = Standing(contacts, (0.141, 0.0, 0.4038), pitch).friction(0.0, 0.515)
    grip = {"floor_friction": share * needed}
    with tipping(RECTANGLE, BRAKED, RAISED, grip, slope=-pitch, slope_heading=math.pi) as bench:
        now = bench.runs(2.0)
    assert (abs(now["speed"]) > 0.1) is slides
