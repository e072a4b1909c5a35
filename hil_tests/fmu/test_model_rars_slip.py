"""RARS on its tyres: the corrected adhesion curve, the slope that holds, loads, rest, energy, limits."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from fmu.rars.equations import model
from fmu.rars.parameters import PARAMETERS, SETS
from hil_tests.fmu.conftest import FINE
from hil_tests.fmu.model_bench import ModelBench, formula, only_loses, rates
from hil_tests.fmu.rolling import Rolling

MODEL = model()
P = {row.name: row.start for row in PARAMETERS}
AXES = ("left", "right")
WHEELS = ("rear_left", "rear_right", "front_left", "front_right")
BRAKED = {f"coulomb_{axis}": 50.0 for axis in AXES} | {"rolling_resistance": 0.0}
"""Motors that hold whatever comes: the wheels are locked."""
PASSIVE = {f"{part}_{axis}": 0.0 for part in ("coulomb", "viscous", "torque_constant") for axis in AXES}


def adhesion(slip: float) -> float:
    """(3.83) corrected: odd, mu_peak at 0.15, 0.66 of it at 1, flat beyond (assumed)."""
    size = abs(slip)
    share = size / 0.15 if size < 0.15 else 1 - 0.34 * (min(size, 1.0) - 0.15) / 0.85
    return math.copysign(0.3 * share, slip)


def steady(force: float, slip_speed: float) -> float:
    """Return the deflection that carries a force while it is wiped off."""
    assert abs(force) >= P["tyre_stiffness"] * 25e-6 * abs(slip_speed), "else the wiping is held back"
    return force / P["tyre_stiffness"]


APART = {"cg_height": 0.0, "friction_circle": 0.0}


@cache
def rear_forces() -> Any:
    readings = {row.name: row.expression for row in MODEL.outputs}
    return formula(MODEL, {way: readings[f"force_{way}_rear_left"] for way in ("ahead", "left")}, APART)


@pytest.mark.parametrize("slip", [0.02, 0.1, 0.149, 0.2, 0.575, 0.9, 1.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_tyres_steady_force_is_the_corrected_curve(slip: float, sign: float) -> None:
    """Bristles in steady state under given speeds: rate 0 exactly where F = mu(slip) N."""
    function = rates(MODEL, APART)
    forces = rear_forces()
    load = 9.81 * (70.0 * (1 - 0.22 / 0.515) + 0.6) / 2
    force = adhesion(sign * slip) * load
    for speed in (0.4, -0.4):
        # Driving: the rim is the faster one; braking: the wheel's middle is; reverse likewise.
        rim, middle = (
            (speed, speed * (1 - slip)) if (sign > 0) == (speed > 0) else (speed * (1 - slip), speed)
        )
        given = {
            "speed_left": 26 * rim / 0.05,
            "speed": middle,
            "tyre_ahead_rear_left": steady(force, rim - middle),
        }
        assert function(**given)["tyre_ahead_rear_left"] == pytest.approx(0.0, abs=1e-7)
        assert forces(**given)["ahead"] == pytest.approx(force, rel=1e-6)
        # Sideways: the slip angle atan(v_t / v_l), below (3.76); how fast the rim is does not matter.
        drift = -sign * math.tan(slip) * 0.4
        for rolled in (speed, 2 * speed, 0.0, -speed):
            sliding = {"speed_left": 26 * rolled / 0.05, "speed": speed, "drift": drift}
            sliding["tyre_left_rear_left"] = steady(force, -drift)
            assert function(**sliding)["tyre_left_rear_left"] == pytest.approx(0.0, abs=1e-7)
            assert forces(**sliding)["left"] == pytest.approx(force, rel=1e-6)


@pytest.mark.parametrize("circle", [0.0, 1.0])
def test_the_friction_circle_is_an_option(circle: float) -> None:
    """A locked wheel that slides slantwise: with the circle both share 0.66 mu N, else each has its own."""
    start = BRAKED | {"friction_circle": circle, "cg_height": 0.0}
    function = rates(MODEL, start)
    load = 9.81 * (70.0 * (1 - 0.22 / 0.515) + 0.6) / 2
    both = math.sqrt(0.5) * adhesion(1.0)
    shares = (
        {"ahead": both, "left": both} if circle else {"ahead": adhesion(1.0), "left": adhesion(math.pi / 4)}
    )
    given = {"speed": 0.5, "drift": 0.5}
    given |= {f"tyre_{way}_rear_left": steady(-share * load, -0.5) for way, share in shares.items()}
    found = function(**given)
    for way in ("ahead", "left"):
        assert found[f"tyre_{way}_rear_left"] == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize(("speed", "drift", "rim"), [(0.4, 0.02, 0.41), (0.4, 0.3, 0.3), (-0.3, 0.1, 0.0)])
def test_both_slips_share_one_adhesion_against_the_way_of_sliding(
    speed: float, drift: float, rim: float
) -> None:
    """|F| = mu(sqrt(rho^2 + delta^2)) N, along the slip velocity."""
    start = {"cg_height": 0.0, "friction_circle": 1.0}
    load = 9.81 * (70.0 * (1 - 0.22 / 0.515) + 0.6) / 2
    sliding = np.array([rim - speed, -drift])
    rho, angle = sliding[0] / max(abs(rim), abs(speed)), math.atan2(drift, abs(speed))
    force = abs(adhesion(math.hypot(rho, angle))) * load * sliding / np.linalg.norm(sliding)
    given = {"speed_left": 26 * rim / 0.05, "speed": speed, "drift": drift}
    for way, along, slip in zip(("ahead", "left"), force, sliding, strict=True):
        given[f"tyre_{way}_rear_left"] = steady(float(along), float(slip))
    found = rates(MODEL, start)(**given)
    for way in ("ahead", "left"):
        assert found[f"tyre_{way}_rear_left"] == pytest.approx(0.0, abs=1e-7)
    slips = {row.name: row.expression for row in MODEL.outputs if row.name.startswith("slip_")}
    reported = formula(MODEL, slips, start)(**given)
    assert reported["slip_ahead_rear_left"] == pytest.approx(rho, rel=1e-9)
    assert reported["slip_left_rear_left"] == pytest.approx(-angle, rel=1e-9)


@pytest.mark.parametrize(("place", "border"), [(0.220, 10.9), (0.141, 13.8)])
def test_the_slope_that_holds(place: float, border: float) -> None:
    """tan = mu (1 - x/w) / (1 - mu z/w): 11 and 14 degrees at mu = 0.3; 30 degrees need more than 0.61."""
    exact = math.atan(0.3 * (1 - place / 0.515) / (1 - 0.3 * 0.190 / 0.515))
    assert math.degrees(exact) == pytest.approx(border, abs=0.1)
    base = BRAKED | {"centre_offset": place, "wheel_mass": 0.0}
    for degrees, slides in ((border - 0.4, False), (border + 0.4, True), (30.0, True)):
        with ModelBench(MODEL, base | {"slope": math.radians(degrees)}) as bench:
            bench.runs(1.0)
            before = bench.now()
            after = bench.runs(1.0)
        if slides:
            assert after["x"] < before["x"] - 0.05
        else:
            assert after == pytest.approx(before, rel=0, abs=1e-8), "nothing creeps"


def test_enough_friction_holds_thirty_degrees() -> None:
    # 0.61 is the thesis's static load; with x_cg = 141 mm and load transfer: mu = tan / (1 - x/w + tan z/w).
    tangent = math.tan(math.radians(30.0))
    least = tangent / (1 - 0.141 / 0.515 + tangent * 0.190 / 0.515)
    base = BRAKED | {"centre_offset": 0.141, "wheel_mass": 0.0, "slope": math.radians(30.0)}
    for friction, slides in ((least * 0.97, True), (least * 1.03, False)):
        with ModelBench(MODEL, base | {"floor_friction": friction}) as bench:
            before = bench.runs(1.0)["x"]
            assert (bench.runs(1.0)["x"] < before - 0.05) == slides


def test_locked_wheels_slide_down_by_sliding_friction() -> None:
    slope = math.radians(30.0)
    with ModelBench(MODEL, BRAKED | {"slope": slope, "cg_height": 0.0, "wheel_mass": 0.0}) as bench:
        first = bench.runs(0.5)["speed"]
        last = bench.runs(0.5)["speed"]
    load = math.cos(slope) * (1 - 0.22 / 0.515)
    down = 9.81 * (math.sin(slope) - 0.66 * 0.3 * load)  # (3.83) at slip 1
    freely_rolling = 1 + 2 * P["front_spin_inertia"] / 0.05**2 / 70.0
    assert (first - last) / 0.5 == pytest.approx(down / freely_rolling, rel=1e-3)


def test_wheels_spin_when_the_motors_ask_for_too_much() -> None:
    with ModelBench(MODEL, {"cg_height": 0.0, "rolling_resistance": 0.0}) as bench:
        now = bench.runs(0.05, left=24.0, right=24.0)
        assert abs(bench.plant.read("slip_ahead_rear_left")) > 0.3
        later = bench.runs(0.02, left=24.0, right=24.0)
        slip = bench.plant.read("slip_ahead_rear_left")
    load = 9.81 * (70.0 * (1 - 0.22 / 0.515) + 0.6)
    mass = 70.6 + 2 * P["front_spin_inertia"] / 0.05**2
    assert (later["speed"] - now["speed"]) / 0.02 == pytest.approx(adhesion(slip) * load / mass, rel=0.03)


def test_accelerating_presses_the_rear_wheels_down() -> None:
    with ModelBench(MODEL) as bench:
        standing = {wheel: bench.plant.read(f"load_{wheel}") for wheel in WHEELS}
        before = bench.runs(0.3, left=1.0, right=1.0)["speed"]
        loads = {wheel: bench.plant.read(f"load_{wheel}") for wheel in WHEELS}
        pull = sum(bench.plant.read(f"force_ahead_{wheel}") for wheel in WHEELS)
    assert standing["front_left"] == pytest.approx(70 * 9.81 * 0.22 / 0.515 / 2, rel=1e-12)
    assert sum(standing.values()) == pytest.approx(70.6 * 9.81, rel=1e-12)
    assert before > 0
    shift = 0.190 * pull / 0.515 / 2
    assert loads["rear_left"] - standing["rear_left"] == pytest.approx(shift, rel=1e-3, abs=1e-4)
    assert sum(loads.values()) == pytest.approx(sum(standing.values()), rel=1e-12)


def test_rolling_resistance_brings_the_coasting_robot_to_rest() -> None:
    start = PASSIVE | {f"speed_{axis}": 0.2 / 0.05 * 26 for axis in AXES} | {"cg_height": 0.0}
    start |= {"rolling_resistance": 0.01}
    with ModelBench(MODEL, start) as bench:
        first = bench.runs(0.2)["speed"]
        last = bench.runs(0.5)["speed"]
        rest = bench.runs(4.5)
        later = bench.runs(1.0)
        # Without any motor, only the bristles of the bearings hold: springs, on which it swings by 0.1 mm.
        assert later["x"] == pytest.approx(rest["x"], abs=1e-4)
        bend = P["rolling_presliding"] * P["front_radius"]
        assert abs(later["speed"]) < bend * math.sqrt(0.01 * 9.81 / bend)
    # With its motors, shorted, it stands.
    with ModelBench(MODEL, {f"speed_{axis}": 0.2 / 0.05 * 26 for axis in AXES}) as bench:
        rest = bench.runs(5.0)
        assert bench.runs(1.0)["x"] == pytest.approx(rest["x"], abs=1e-8)
        assert abs(bench.now()["speed"]) < 1e-7
    mass = (
        70.6
        + 2 * (P["front_spin_inertia"] + P["wheel_spin_inertia"] + P["rotor_inertia_left"] * 676) / 0.05**2
    )
    assert (first - last) / 0.5 == pytest.approx(0.01 * 70.6 * 9.81 / mass, rel=5e-3)


def test_at_rest_across_a_slope_nothing_creeps() -> None:
    start = BRAKED | {"slope": math.radians(8.0), "heading": 1.2, "angle_steer": 250.0}
    with ModelBench(MODEL, start) as bench:
        before = bench.runs(2.0)
        assert bench.runs(3.0) == pytest.approx(before, rel=0, abs=1e-9)


@pytest.mark.parametrize("parameters", SETS.values(), ids=SETS)
@pytest.mark.parametrize("seed", range(2))
def test_energy_never_grows(seed: int, parameters: dict[str, float]) -> None:
    """Spinning, sliding, across a slope, with load transfer: whatever happens, nothing is gained."""
    generator = np.random.default_rng(seed)
    start = {f"speed_{axis}": generator.uniform(-600, 600) for axis in AXES}
    start |= {f"current_{axis}": generator.uniform(-20, 20) for axis in AXES}
    start |= {"angle_steer": generator.uniform(-400, 400), "heading": generator.uniform(-3, 3)}
    start |= {"slope": generator.uniform(0, 0.4), "floor_friction": generator.uniform(0.1, 0.9)}
    with ModelBench(MODEL, dict(parameters) | start) as bench:
        only_loses(bench, 4000)


def test_stiff_tyres_come_near_rolling_without_slip() -> None:
    """The limit: both equations of [R] 3.3 in closed form, driven by torques, with rotors as rim mass."""
    tyres = {"floor_friction": 1e4, "tyre_stiffness": 2e6, "tyre_damping": 6e3, "rolling_resistance": 0.0}
    quiet: dict[str, Any] = {f"{part}_{axis}": 0.0 for part in ("coulomb", "viscous") for axis in AXES}
    quiet |= {"cg_height": 0.0}
    robot = Rolling.of(P)
    with ModelBench(MODEL, tyres | quiet, step=FINE) as bench:
        pushed, count = 0.0, 4000
        for _ in range(count):
            now = bench.runs(1e-4, left=1.0, right=1.0)
            pushed += (
                26 * P["torque_constant_left"] * (now["current_left"] + now["current_right"]) / 0.05 * 1e-4
            )
    turning = 2 * (P["rotor_inertia_left"] * 676 + P["front_spin_inertia"]) / 0.05**2
    assert now["speed"] == pytest.approx(pushed / (robot.mass + robot.rim + turning), rel=2e-3)


def test_the_thesis_own_floor_lets_odometry_drift() -> None:
    """At mu = 0.3 the wheels' way is longer than the robot's while it speeds up: that is physics."""
    with ModelBench(MODEL) as bench:
        now = bench.runs(0.3, left=5.0, right=5.0)
    rolled = 0.05 * now["angle_left"] / 26
    assert now["x"] < 0.9 * rolled
