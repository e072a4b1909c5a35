"""RARS that can tip over, beside closed forms: centre of mass, loads, static limits, and the plant rars."""

import math
from collections.abc import Mapping
from typing import Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fmu.build import ensure
from fmu.plant import FmuPlant
from fmu.rars import interface as plain
from fmu.rars_tipping.interface import INPUTS, OUTPUTS
from hil_tests.fmu.tipping_bench import (
    BRAKED,
    GRIPS,
    LOADS,
    RAISED,
    RECTANGLE,
    STEPS,
    P,
    TippingBench,
    lift_angle,
    tipping,
)
from validation.references.rars import VOLTAGES

TRAPEZIUM: Final = dict(RECTANGLE) | {"rear_contact_inset": 0.0}
ACROSS: Final = math.pi / 2
G: Final = 9.81
SLOPE: Final = math.radians(30.0)


def centre(height: float, payload: float) -> float:
    """The closed form of z, with 70 kg in all and 8 kg of scissor."""
    return (70 * 0.19 + 8 * (height - 0.5) / 2 + payload * height) / (70 + payload)


@pytest.mark.parametrize(
    ("height", "payload", "printed"), [(0.5, 0.0, 0.190), (0.5, 10.0, 0.229), (1.5, 10.0, 0.404)]
)
def test_the_centre_of_mass_follows_payload_and_lift(height: float, payload: float, printed: float) -> None:
    start = {"angle_lift": lift_angle(height - 0.5), "lift_payload": payload}
    with tipping(RECTANGLE, start) as bench:
        found = bench.now()["centre_height"]
    assert found == pytest.approx(centre(height, payload), abs=1e-12)
    assert found == pytest.approx(printed, abs=5e-4)


def inclined_until_it_lifts(bench: TippingBench, start: float, degrees_per_s: float = 0.2) -> float:
    """Incline the floor slowly from this angle on; return the angle in degrees at which the robot turns."""
    degrees = start
    bench.runs(0.02)
    while abs(bench.now()["roll"]) + abs(bench.now()["pitch"]) < 1e-7:
        degrees += degrees_per_s * 0.002
        bench.plant.change("slope", math.radians(degrees))
        bench.runs(0.002)
        assert degrees < start + 1.0, "it stands beyond its limit"
    return degrees


@pytest.mark.parametrize(
    ("chosen", "uphill", "lever", "printed"),
    [
        (RECTANGLE, 0.0, 0.141, 19.3),
        (RECTANGLE, ACROSS, 0.168, 22.6),
        (RECTANGLE, -ACROSS, 0.168, 22.6),
        # The trapezium is 191 mm wide to either side where the centre of mass is.
        (TRAPEZIUM, ACROSS, 0.2 - 0.032 * 0.141 / 0.515, 25.3),
        (dict(RECTANGLE) | {"centre_offset": 0.22}, 0.0, 0.22, 28.6),
    ],
)
def test_static_tip_angles(chosen: Mapping[str, float], uphill: float, lever: float, printed: float) -> None:
    closed = math.degrees(math.atan(lever / centre(1.5, 10.0)))
    assert closed == pytest.approx(printed, abs=0.06)
    with tipping(chosen, BRAKED, RAISED, slope_heading=uphill, slope=math.radians(closed - 0.1)) as bench:
        assert inclined_until_it_lifts(bench, closed - 0.1) == pytest.approx(closed, abs=0.05)
        bench.plant.change("slope", math.radians(closed + 0.5))
        now = bench.runs(3.0)
        assert now["tipped"] == 1.0
        assert now["pitch" if uphill == 0 else "roll"] * (uphill or 1.0) > 1.5


def test_the_slope_s_direction_changes_while_it_stands() -> None:
    slope = math.radians(20.0)
    with tipping(RECTANGLE, BRAKED, RAISED, slope_heading=ACROSS, slope=slope) as bench:
        assert bench.runs(0.3)["zmp_margin"] > 0.01
        for degree in range(90, -1, -1):
            bench.plant.change("slope_heading", math.radians(degree))
            bench.runs(0.02)
        assert bench.runs(0.1)["pitch"] > 0.0, "its nose is uphill, and 20 degrees are too many"


@pytest.mark.parametrize(("payload", "limit"), [(0.0, 0.1427), (10.0, 0.034)])
def test_acceleration_that_lifts_the_front_on_thirty_degrees(payload: float, limit: float) -> None:
    mass = 70.0 + payload
    closed = 0.141 / centre(0.5, payload) * math.cos(SLOPE) - math.sin(SLOPE)
    assert closed == pytest.approx(limit, abs=5e-4)
    for share, lifts in ((closed - 1.5e-3, False), (closed + 3e-3, True)):
        acceleration = share * G
        amps = mass * G * 0.5 * P["wheel_radius"] / 2 / P["gear_left"] / P["torque_constant_left"]
        start = {"slope": SLOPE, "lift_payload": payload, "current_left": amps, "current_right": amps}
        with tipping(RECTANGLE, GRIPS, start, rolling_resistance=0.0) as bench:
            reached, least, pitch = _drive_on(bench, mass, acceleration)
        assert reached / G == pytest.approx(share, abs=3e-4)
        assert (least > 0.0, pitch > 1e-5) == (not lifts, lifts)


def _drive_on(bench: TippingBench, mass: float, acceleration: float) -> tuple[float, float, float]:
    """Accelerate smoothly for 1 s; return the m/s2 reached, a front wheel's least load, the largest pitch."""
    least, pitch, more = math.inf, 0.0, 0.0
    inertia = P["rotor_inertia_left"] + P["wheel_spin_inertia"] / P["gear_left"] ** 2
    front = 2 * P["front_spin_inertia"] / P["wheel_radius"] ** 2
    for step in range(1000):
        share = min(1.0, step / 500)
        # What the wheels' slip takes is found on the way.
        more += 0.01 * mass * (share * acceleration - bench.plant.read("der(speed)"))
        force = mass * G * 0.5 + (mass + front) * share * acceleration + more
        shaft = share * acceleration / P["wheel_radius"] * P["gear_left"]
        torque = force * P["wheel_radius"] / 2 / P["gear_left"] + inertia * shaft
        volts = {side: _volts(bench.now()[f"speed_{side}"], torque) for side in ("left", "right")}
        now = bench.runs(0.001, **volts)
        least, pitch = min(least, now["load_front_left"]), max(pitch, now["pitch"])
    return bench.plant.read("der(speed)"), least, pitch


def _volts(speed: float, torque: float) -> float:
    """Return the voltage at which the left motor has this torque beside its own friction."""
    dry = P["coulomb_left"] * min(1.0, max(-1.0, speed))
    amps = (torque + dry + P["viscous_left"] * speed) / P["torque_constant_left"]
    return P["resistance_left"] * amps + P["torque_constant_left"] * speed


@pytest.mark.parametrize("course", ["straight", "reference"])
def test_with_all_wheels_loaded_it_moves_as_the_plain_plant(course: str) -> None:
    straight = ((0.5, 0.0, 0.0, 0.0, 0.0), (2.0, 6.0, 6.0, 0.0, 24.0), (3.0, -3.0, -3.0, 0.0, 0.0))
    # In a turn the outer wheels carry more here, and the plain plant has no shift to the side.
    rows, tolerance = (straight, 1e-9) if course == "straight" else (VOLTAGES, 4e-3)
    # The plain plant's centre of mass does not rise with the lift.
    start = {"lift_mass": 1.0, "scissor_mass": 0.0}
    names = list(plain.OUTPUTS)
    with tipping(start) as bench, FmuPlant(ensure("rars"), list(INPUTS), names) as other:
        for until, *volts in rows:
            for place, value in enumerate(volts):
                other.inputs[place] = bench.plant.inputs[place] = value
            while other.steps_done < round(until * STEPS):
                other.step()
                bench.plant.step()
                assert bench.plant.outputs[OUTPUTS_AT["zmp_margin"]] > 0.1
        now, then = bench.now(), dict(zip(names, other.outputs, strict=True))
    for name in ("x", "y"):
        assert now[name] == pytest.approx(then[name], abs=tolerance)
    assert now["heading"] == pytest.approx(then["heading"], abs=2 * tolerance)
    assert now["lift_height"] == then["lift_height"]
    assert abs(then["x"]) > 0.3


OUTPUTS_AT: Final = {name: place for place, name in enumerate(OUTPUTS)}


@settings(max_examples=25, deadline=None)
@given(
    slopes=st.lists(st.tuples(st.floats(0.0, 0.6), st.floats(-3.2, 3.2)), min_size=3, max_size=3),
    payload=st.tuples(st.floats(0.0, 10.0), st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)),
    rise=st.floats(0.0, 1.0),
    volts=st.lists(st.tuples(*[st.floats(-12.0, 12.0)] * 3), min_size=3, max_size=3),
    friction=st.floats(0.05, 1.2),
)
def test_the_loads_are_the_weight_and_none_is_negative(
    slopes: list[tuple[float, float]],
    payload: tuple[float, float, float],
    rise: float,
    volts: list[tuple[float, float, float]],
    friction: float,
) -> None:
    carried = dict(zip(("lift_payload", "payload_ahead", "payload_left"), payload, strict=True))
    start = carried | {"angle_lift": lift_angle(rise), "floor_friction": friction, "centre_offset": 0.141}
    with tipping(start, slope=slopes[0][0], slope_heading=slopes[0][1]) as bench:
        for (slope, uphill), (left, right, steer) in zip(slopes, volts, strict=True):
            bench.plant.change("slope", slope)
            bench.plant.change("slope_heading", uphill)
            for _ in range(10):
                now = bench.runs(0.02, left=left, right=right, steer=steer)
                loads = [now[name] for name in LOADS]
                assert sum(loads) == pytest.approx((1 - now["tipped"]) * bench.weight(), rel=1e-12)
                assert min(loads) >= -1e-9
                assert all(math.isfinite(value) for value in now.values())
                assert (min(loads) < 1e-9) >= (now["zmp_margin"] < -1e-3)


def test_a_payload_that_is_put_on_and_shifted_moves_the_loads() -> None:
    with tipping(RECTANGLE, BRAKED) as bench:
        empty = bench.runs(0.1)
        assert empty["zmp_margin"] == pytest.approx(0.141)
        bench.plant.change("lift_payload", 10.0)
        assert bench.runs(0.1)["zmp_margin"] == pytest.approx(0.141)
        bench.plant.change("payload_ahead", -0.4)
        assert bench.runs(0.1)["zmp_margin"] == pytest.approx(0.141 - 10 * 0.4 / 80)
        bench.plant.change("payload_ahead", 0.0)
        bench.plant.change("payload_left", 0.3)
        now = bench.runs(0.1)
        aside = 10 * 0.3 / 80
        assert now["load_front_left"] - now["load_front_right"] == pytest.approx(
            bench.weight() * 0.141 / 0.515 * aside / 0.168
        )
        assert [now["roll"], now["pitch"]] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_a_payload_aside_turns_the_robot_that_accelerates() -> None:
    turned = {}
    for aside in (-0.3, 0.0, 0.3):
        with tipping(GRIPS, lift_payload=10.0, payload_left=aside) as bench:
            turned[aside] = bench.runs(0.5, left=3.0, right=3.0)["heading"]
    # Its mass stays behind on its side, and slows that side down.
    assert turned[0.3] > 1e-5
    assert turned[0.3] == pytest.approx(-turned[-0.3], rel=1e-6)
    assert turned[0.0] == pytest.approx(0.0, abs=1e-12)


def test_the_accelerometer_has_gravity_in_the_body_s_axes() -> None:
    slope = math.radians(10.0)
    with tipping(BRAKED, slope=slope, slope_heading=math.pi / 3) as bench:
        bench.runs(0.5)
        force = [bench.plant.read(f"specific_force_{way}") for way in ("ahead", "left", "up")]
    level = G * math.sin(slope)
    wanted = [level * math.cos(math.pi / 3), level * math.sin(math.pi / 3), G * math.cos(slope)]
    assert force == pytest.approx(wanted, abs=1e-3)
