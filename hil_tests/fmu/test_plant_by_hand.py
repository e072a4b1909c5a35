"""The same plant a second time: accelerations from formulas written by hand, runs by another integrator.

The accelerations come from one step of 1 us; here they are worked out without SymPy and without the model's
files, the mechanisms by differentiating their geometry numerically.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from fmu.rars.equations import model
from fmu.rars.interface import AXES, INPUTS, OUTPUTS
from fmu.rars.parameters import PARAMETERS, SETS
from hil_tests.fmu.model_bench import formula, rates
from hil_tests.fmu.rolling_limit import rolling

P = {row.name: row.start for row in PARAMETERS}
MICROSECOND = 1_000
STILL = {f"inductance_{axis}": 1e9 for axis in AXES} | {"presliding": 1e9}
"""Currents and dry friction stay at their start for the one step."""


def accelerations(bench: Any, start: dict[str, float]) -> dict[str, float]:
    plant = bench(STILL | start, step=MICROSECOND)
    before = plant.now()
    plant.plant.step()
    return {axis: (plant.now()[f"speed_{axis}"] - before[f"speed_{axis}"]) / 1e-6 for axis in AXES}


def slope(function: Callable[[float], float], at: float, step: float = 1e-5) -> float:
    return (function(at + step) - function(at - step)) / (2 * step)


@pytest.mark.parametrize("parameters", SETS.values(), ids=SETS)
@pytest.mark.parametrize(("left", "right"), [(200.0, 260.0), (-150.0, 90.0), (0.0, 300.0)])
def test_platform_accelerations_without_slip(parameters: dict[str, float], left: float, right: float) -> None:
    p = P | parameters
    # Front tyres off, currents on: the two coupled equations with the convective term.
    start = {"speed_left": left, "speed_right": right, "current_left": 2.0, "current_right": -1.0}
    found = rolling(parameters)(**start)
    got = {side: found[f"speed_{side}"] for side in ("left", "right")}
    r, track, a = p["wheel_radius"], p["rear_track"], p["centre_offset"]
    speed, yaw = r * (left + right) / 52, r * (right - left) / 26 / track
    torques = [
        26 * (p[f"torque_constant_{s}"] * i - p[f"viscous_{s}"] * w)
        for s, i, w in (("left", 2.0, left), ("right", -1.0, right))
    ]
    total = p["platform_mass"] + 2 * p["wheel_mass"]
    s = 2 * (p["wheel_spin_inertia"] + p["rotor_inertia_left"] * 26**2) / r**2
    i_o = p["yaw_inertia"] + 2 * p["wheel_yaw_inertia"] + p["platform_mass"] * a**2
    i_o += 2 * p["wheel_mass"] * (track / 2) ** 2
    v_dot = (sum(torques) / r + p["platform_mass"] * a * yaw**2) / (total + s)
    w_dot = (track / 2 * (torques[1] - torques[0]) / r - p["platform_mass"] * a * speed * yaw) / (
        i_o + s * track**2 / 4
    )
    assert got["left"] == pytest.approx(26 / r * (v_dot - track / 2 * w_dot), rel=1e-9)
    assert got["right"] == pytest.approx(26 / r * (v_dot + track / 2 * w_dot), rel=1e-9)


WHEELS = ("rear_left", "rear_right", "front_left", "front_right")


@pytest.mark.parametrize("parameters", SETS.values(), ids=SETS)
@pytest.mark.parametrize("seed", range(3))
def test_platform_accelerations_on_tyres(parameters: dict[str, float], seed: int) -> None:
    """Newton and Euler about the center of mass, with tyres stretched."""
    p = P | parameters
    generator = np.random.default_rng(seed)
    speed, drift, yaw = (float(value) for value in generator.uniform(-1, 1, 3))
    rack_angle = float(generator.uniform(-400, 400))
    stretch = {
        f"tyre_{way}_{wheel}": generator.uniform(-1e-4, 1e-4) for way in ("ahead", "left") for wheel in WHEELS
    }
    currents = {"current_left": 2.0, "current_right": -1.0}
    shafts = {"speed_left": generator.uniform(-200, 200), "speed_right": generator.uniform(-200, 200)}
    free = dict(parameters) | {"tyre_damping": 0.0, "slope": 0.1}
    got = rates(model(), free)(
        speed=speed,
        drift=drift,
        yaw_rate=yaw,
        angle_steer=rack_angle,
        heading=0.7,
        **stretch,
        **currents,
        **shafts,
    )
    a, track, base, kingpins = p["centre_offset"], p["rear_track"], p["wheelbase"], p["kingpin_distance"]
    rack, h = rack_angle * 0.015 / 159, p["davis_h"]
    b = h * kingpins / (2 * base)
    places = {"rear_left": (0.0, track / 2), "rear_right": (0.0, -track / 2)}
    places |= {"front_left": (base, kingpins / 2), "front_right": (base, -kingpins / 2)}
    force, moment = np.zeros(2), 0.0
    for wheel, place in places.items():
        side = 1 if place[1] > 0 else -1
        angle = math.atan2(rack * h, h * h + b * b - side * b * rack) if place[0] else 0.0
        pull = p["tyre_stiffness"] * np.array([stretch[f"tyre_ahead_{wheel}"], stretch[f"tyre_left_{wheel}"]])
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        here = turn @ pull
        force += here
        moment += float(place[0] * here[1] - place[1] * here[0])
    m, m_w = p["platform_mass"], p["wheel_mass"]
    total = m + 2 * m_w
    ahead = m * a / total  # the common center of mass
    force += total * 9.81 * math.sin(0.1) * np.array([-math.cos(0.7), math.sin(0.7)])
    moment += ahead * total * 9.81 * math.sin(0.1) * math.sin(0.7)
    about_axle = p["yaw_inertia"] + 2 * p["wheel_yaw_inertia"] + m * a**2 + 2 * m_w * (track / 2) ** 2
    about_middle = about_axle - total * ahead**2
    yaw_acceleration = (moment - ahead * float(force[1])) / about_middle
    middle = force / total
    assert got["speed"] == pytest.approx(middle[0] + ahead * yaw**2 + drift * yaw, rel=1e-9)
    assert got["drift"] == pytest.approx(middle[1] - ahead * yaw_acceleration - speed * yaw, rel=1e-9)
    assert got["yaw_rate"] == pytest.approx(yaw_acceleration, rel=1e-9)
    # (3.73) corrected: I_w w' = tau - r F_s
    for axis in ("left", "right"):
        torque = 26 * (p[f"torque_constant_{axis}"] * currents[f"current_{axis}"]
                       - p[f"viscous_{axis}"] * shafts[f"speed_{axis}"])  # fmt: skip
        torque -= p["wheel_radius"] * p["tyre_stiffness"] * stretch[f"tyre_ahead_rear_{axis}"]
        inertia = p["wheel_spin_inertia"] + p[f"rotor_inertia_{axis}"] * 26**2
        assert got[f"speed_{axis}"] / 26 == pytest.approx(torque / inertia, rel=1e-9)


@pytest.mark.parametrize("angle", [0.0, 120.0, -300.0, 420.0])
def test_rack_acceleration(bench: Any, angle: float) -> None:
    metres = 0.015 / 159
    h = P["davis_h"]
    b = h * P["kingpin_distance"] / (2 * P["wheelbase"])

    def wheel(rack: float, side: int) -> float:
        return math.atan2(rack * h, h * h + b * b - side * b * rack)

    inertia = P["link_mass"] * P["link_centre"] ** 2 + P["link_inertia"]
    inertia += P["kingpin_offset"] ** 2 * P["front_wheel_mass"]

    def mass(rack: float) -> float:
        left, right = slope(lambda x: wheel(x, 1), rack), slope(lambda x: wheel(x, -1), rack)
        return P["tie_rod_mass"] + inertia * (left**2 + right**2)

    rack, motor_speed = metres * angle, 600.0
    got = accelerations(bench, {"angle_steer": angle, "speed_steer": motor_speed, "current_steer": 0.5})
    rack_speed = metres * motor_speed
    # Lagrange for one coordinate: M xdd + M' xd2 / 2 = force.
    force = P["torque_constant_steer"] * 0.5 - P["viscous_steer"] * motor_speed
    torque = force - metres * slope(mass, rack, 1e-4) * rack_speed**2 / 2
    expected = torque / (P["rotor_inertia_steer"] + metres**2 * mass(rack))
    assert got["steer"] == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("angle", [500.0, 3000.0, 8000.0])
def test_lift_acceleration(bench: Any, angle: float) -> None:
    metres = 0.0015 / (2 * math.pi * 25)

    def height(nut: float) -> float:
        base = 0.3 * math.cos(math.radians(5)) - nut
        return 6 * math.sqrt(0.3**2 - base**2)

    # Strong acceleration, heavy load, no screw friction to speak of: inertia and weight only.
    heavy = {"lift_mass": 50.0, "screw_friction": 1e-9, "coulomb_lift": 0.0, "viscous_lift": 0.0}
    got = accelerations(
        bench, heavy | {"angle_lift": angle, "speed_lift": 500.0, "torque_constant_lift": 0.0}
    )
    nut, nut_speed = metres * angle, metres * 500.0
    gain, bend = slope(height, nut), slope(lambda x: slope(height, x), nut, 1e-4)
    torque = -metres * 50.0 * (9.81 * gain + gain * bend * nut_speed**2)
    assert got["lift"] == pytest.approx(torque / (4e-7 + 50.0 * (metres * gain) ** 2), rel=1e-3)


DORMAND_PRINCE = (
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
FOURTH = (5179 / 57600, 0.0, 7571 / 16695, 393 / 640, -92097 / 339200, 187 / 2100, 1 / 40)


Vector = npt.NDArray[np.float64]


def integrated(rates: Callable[[Vector], Vector], state: Vector, seconds: float, tolerance: float) -> Vector:
    """Dormand-Prince 5(4) with step control."""
    now, step = 0.0, 1e-6
    while now < seconds:
        step = min(step, seconds - now)
        slopes = [rates(state)]
        for row in DORMAND_PRINCE:
            slopes.append(rates(state + step * sum(c * k for c, k in zip(row, slopes, strict=True))))
        fifth = state + step * sum(c * k for c, k in zip(DORMAND_PRINCE[-1], slopes[:-1], strict=True))
        fourth = state + step * sum(c * k for c, k in zip(FOURTH, slopes, strict=True))
        error = float(np.max(np.abs(fifth - fourth) / (1e-3 + np.abs(fifth)))) / tolerance
        if error <= 1.0:
            state, now = fifth, now + step
        step *= min(4.0, max(0.2, 0.9 * (error + 1e-12) ** -0.2))
    return state


def test_another_integrator_finds_the_same_run(bench: Any) -> None:
    plant_model, function = model(), rates(model())
    names = [state.name for state in plant_model.states]
    voltages = {"left": 9.0, "right": 4.0, "steer": 12.0, "lift": 20.0}
    held = {name: voltages[name.removeprefix("voltage_")] for name in INPUTS}
    starts = formula(plant_model, {state.name: state.start for state in plant_model.states})()

    def slopes(state: Vector) -> Vector:
        return np.array(list(function(**dict(zip(names, map(float, state), strict=True)), **held).values()))

    end = integrated(slopes, np.array(list(starts.values()), dtype=float), 0.1, 1e-8)
    now = bench().runs(0.1, **voltages)
    for state, value in zip(plant_model.states, end, strict=True):
        if state.name in OUTPUTS:
            assert now[state.name] == pytest.approx(value, rel=2e-4, abs=2e-5), state.name
