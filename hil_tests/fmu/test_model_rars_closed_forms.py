"""Published values and closed forms of RARS, each with its equation in [R] (A. P. Das, PhD thesis, 2018)."""

import math
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pytest
import sympy as sp

from firmware_bridge.robot_types import find
from fmu.parts.motor import Shaft
from fmu.rars.equations import model
from fmu.rars.parameters import PARAMETERS, SETS
from fmu.rars.platform import Platform
from fmu.rars.steering import Steering
from fmu.rars.symbols import P as SYMBOLS
from hil_tests.fmu.model_bench import formula, rates
from hil_tests.fmu.rolling import Rolling, quintic
from hil_tests.fmu.rolling_limit import rolling

Vector = npt.NDArray[np.float64]
MODEL = model()
P = {row.name: row.start for row in PARAMETERS}
BASE = find("rars").geometry.base


def test_ackermann_and_davis_geometry() -> None:
    # (2.12): 2 b / h = a_k / w makes both cotangents differ by a_k / w for small angles.
    h, kingpins, base = P["davis_h"], P["kingpin_distance"], P["wheelbase"]
    b = h * kingpins / (2 * base)
    for inner in np.radians([1.0, 10.0, 30.0, 60.0]):
        rack = math.tan(inner) * (h**2 + b**2) / (h + b * math.tan(inner))  # (4.7)
        assert math.atan(rack * h / (h**2 + b**2 - b * rack)) == pytest.approx(inner, rel=1e-12)  # (4.6)
        outer = math.atan(rack * h / (h**2 + b**2 + b * rack))
        # Exactly, cot(outer) - cot(inner) = 2 b / h at every angle: this linkage keeps Ackermann.
        assert 1 / math.tan(outer) - 1 / math.tan(inner) == pytest.approx(kingpins / base, rel=1e-12)


def radius(inner: float) -> float:
    return P["kingpin_distance"] / 2 + P["wheelbase"] / math.tan(inner)  # (2.13)


def test_turn_radii() -> None:
    assert radius(math.radians(60.0)) == pytest.approx(0.402, abs=5e-4)
    assert math.degrees(math.atan(P["wheelbase"] / (0.415 - P["kingpin_distance"] / 2))) == pytest.approx(
        58.95, abs=5e-3
    )


def test_tip_over_speed_in_a_turn() -> None:
    # (2.7): v = sqrt(R g d / Z_cg), printed 1.9 m/s for the smallest turn
    def limit(turn: float) -> float:
        return math.sqrt(turn * 9.81 * BASE.half_support_width_m / BASE.centre_of_gravity_height_m)

    assert limit(0.415) == pytest.approx(1.897, abs=5e-4)
    assert limit(radius(math.radians(60.0))) > find("rars").geometry.limits.speed_mps


@pytest.mark.parametrize("slope", [0.0, math.radians(10), math.radians(30)])
@pytest.mark.parametrize("place", [0.141, 0.220])
def test_the_front_wheels_lift_at_the_tip_over_acceleration(slope: float, place: float) -> None:
    # (2.4): a = g (x_cg cos(th) / z_cg - sin(th)); then the pull at the floor is m (a + g sin(th)).
    parameters = {"slope": slope, "centre_offset": place, "wheel_mass": 0.0}
    load = {row.name: row.expression for row in MODEL.outputs if row.name.startswith("load_")}
    limit = 9.81 * (place * math.cos(slope) / P["cg_height"] - math.sin(slope))
    for share in (0.5, 0.999):
        pull = P["platform_mass"] * (share * limit + 9.81 * math.sin(slope))
        stretch = pull / 2 / P["tyre_stiffness"]
        found = formula(MODEL, load, parameters)(tyre_ahead_rear_left=stretch, tyre_ahead_rear_right=stretch)
        standing = P["platform_mass"] * 9.81 * math.cos(slope) * place / P["wheelbase"]
        left = standing - P["cg_height"] * pull / P["wheelbase"]
        assert 2 * found["load_front_left"] == pytest.approx(left, rel=1e-9)
        assert sum(found.values()) == pytest.approx(P["platform_mass"] * 9.81 * math.cos(slope), rel=1e-12)
    assert left == pytest.approx(0.0, abs=2e-3 * standing)
    # The printed limit of 0.144 g on 30 degrees belongs to x_cg = 141 mm.
    if place == 0.141 and slope > 0.5:
        assert limit / 9.81 == pytest.approx(0.144, abs=2e-3)


@pytest.mark.parametrize("name", ["A", "B"])
def test_inertia_matrix_of_the_reduced_model(name: str) -> None:
    """(3.77), (3.78): the kinetic energy over (y1', y2', x'), forwards left, forwards right, to the right."""
    p = P | dict(SETS[name])
    shafts = [Shaft(axis, SYMBOLS) for axis in ("left", "right", "steer")]
    platform = Platform(shafts[0], shafts[1], Steering(shafts[2]))
    speeds = sp.symbols("y1 y2 x", real=True)
    track = SYMBOLS["rear_track"]
    at = {platform.body.speed: (speeds[0] + speeds[1]) / 2, platform.body.drift: -speeds[2]}
    at |= {platform.body.yaw_rate: (speeds[1] - speeds[0]) / track}
    spins = [
        symbol
        for symbol in platform.energy().free_symbols
        if symbol not in at and symbol not in SYMBOLS.values()
    ]
    energy = platform.energy().xreplace(dict.fromkeys(spins, sp.S.Zero)).xreplace(at)
    matrix = sp.hessian(energy, speeds).xreplace({SYMBOLS[key]: value for key, value in p.items()})
    length, a, m, m_w = p["rear_track"], p["centre_offset"], p["platform_mass"], p["wheel_mass"]
    turning = (p["yaw_inertia"] + 2 * p["wheel_yaw_inertia"]) / length**2
    big_a = turning + m * (a**2 / length**2 + 0.25) + m_w
    big_b = -turning + m * (0.25 - a**2 / length**2)
    big_d, big_e = a * m / length, m + 2 * m_w
    wanted = [[big_a, big_b, big_d], [big_b, big_a, -big_d], [big_d, -big_d, big_e]]
    assert np.array(matrix.tolist(), dtype=float) == pytest.approx(np.array(wanted), rel=1e-12)
    if name == "B":
        assert (big_a, big_b, big_d, big_e) == pytest.approx((167.40, -131.90, 73.333, 71.0), abs=5e-3)


def test_the_quintic_path() -> None:
    # (3.41): beta = 20 pi s^3 - 30 pi s^4 + 12 pi s^5, T = 60 s; 0.982 m/s on the circle of 5 m.
    angles = [quintic(t)[0] for t in np.linspace(0.0, 60.0, 601)]
    assert (angles[0], angles[-1]) == pytest.approx((0.0, 2 * math.pi), abs=1e-12)
    assert all(later > earlier for earlier, later in pairwise(angles))
    peak = max(quintic(t)[1] for t in np.linspace(0.0, 60.0, 601))
    assert peak == pytest.approx(math.pi / 16, rel=1e-12)
    assert quintic(30.0)[1] == pytest.approx(peak, rel=1e-12)
    assert peak * 5.0 == pytest.approx(0.982, abs=5e-4)
    for t in (0.0, 60.0):
        assert quintic(t)[1:] == pytest.approx((0.0, 0.0), abs=1e-15)
    assert quintic(20.0)[1] == pytest.approx((quintic(20.001)[0] - quintic(19.999)[0]) / 0.002, rel=1e-6)
    assert quintic(20.0)[2] == pytest.approx((quintic(20.001)[1] - quintic(19.999)[1]) / 0.002, rel=1e-6)


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("heading", [0.0, math.pi, 1.1, -2.0])
@pytest.mark.parametrize("slope", [0.0, math.radians(10.0), math.radians(-5.0)])
def test_torques_on_a_slope_give_the_motion_they_were_planned_for(
    name: str, heading: float, slope: float
) -> None:
    """(3.44) corrected, forwards in plain numbers and backwards in the plant's own equations without slip."""
    p = P | dict(SETS[name]) | {"slope": slope}
    quiet = {
        f"{part}_{axis}": 0.0
        for part in ("coulomb", "viscous", "rotor_inertia")
        for axis in ("left", "right")
    }
    robot = Rolling.of(p)
    speed, yaw, change, turning = 0.3, -0.4, 0.2, 0.5
    torques = robot.torques(speed, yaw, change, turning, slope=slope, heading=heading)
    assert robot.rates(speed, yaw, *torques, slope=slope, heading=heading) == pytest.approx((change, turning))
    half = p["rear_track"] / 2
    sides = {"left": -1, "right": 1}
    given = {f"speed_{side}": 26 / 0.05 * (speed + sign * half * yaw) for side, sign in sides.items()}
    given |= {
        f"current_{side}": torque / (26 * p[f"torque_constant_{side}"])
        for side, torque in zip(sides, torques, strict=True)
    }
    found = rolling(dict(SETS[name]) | quiet | {"slope": slope})(heading=heading, **given)
    for side, sign in sides.items():
        assert found[f"speed_{side}"] * 0.05 / 26 == pytest.approx(change + sign * half * turning, rel=1e-9)
    assert found["speed"] == pytest.approx(change, rel=1e-9)


@pytest.mark.parametrize("name", SETS)
def test_torques_lead_round_the_circle_without_slip(name: str) -> None:
    """[R] 3.3.3, both ways: path to torques, torques to path; the center of mass O3 on 5 m."""
    robot = Rolling.of(P | dict(SETS[name]))
    a = P["centre_offset"]
    axle = math.sqrt(25.0 - a**2)  # O3 leads the axle by a: the axle's middle runs on a smaller circle

    def torques(t: float) -> tuple[float, float]:
        _, rate, change = quintic(t)
        return robot.torques(axle * rate, rate, axle * change, change)

    def slope(t: float, state: Vector) -> Vector:
        speed, yaw, heading = state[0], state[1], state[2]
        v_rate, w_rate = robot.rates(speed, yaw, *torques(t))
        return np.array([v_rate, w_rate, yaw, speed * math.cos(heading), speed * math.sin(heading)])

    heading = math.pi / 2 - math.asin(a / 5.0)  # from the tangent by -asin(a / R)
    start = np.array([5.0, 0.0]) - a * np.array([math.cos(heading), math.sin(heading)])
    state, step = np.array([0.0, 0.0, heading, *start]), 0.02
    worst = 0.0
    for count in range(3000):
        t = count * step
        k1 = slope(t, state)
        k2 = slope(t + step / 2, state + step / 2 * k1)
        k3 = slope(t + step / 2, state + step / 2 * k2)
        k4 = slope(t + step, state + step * k3)
        state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        ahead = np.array([math.cos(state[2]), math.sin(state[2])])
        worst = max(worst, abs(float(np.hypot(*(state[3:] + a * ahead))) - 5.0))
    assert worst < 1e-6
    assert state[2] - heading == pytest.approx(2 * math.pi, abs=1e-9)
    assert max(abs(torques(t)[1] - torques(t)[0]) for t in np.linspace(0, 60, 61)) < 3.0


GAINS = {"Ki": 100.0, "Kp": 60.0, "Kd": 20.0}
LOOP = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-100.0, -60.0, -20.0]])
"""(3.102) corrected: the last row is (-Ki, -Kp, -Kd); the print exchanges Kp and Kd."""


def test_eigenvalues_of_the_steering_loop() -> None:
    values = np.sort_complex(np.linalg.eigvals(LOOP))
    assert np.poly(LOOP) == pytest.approx([1.0, 20.0, 60.0, 100.0], rel=1e-12)
    for value in values:
        assert abs(value**3 + 20 * value**2 + 60 * value + 100) < 1e-9
    assert values[0].real == pytest.approx(-16.779, abs=5e-3)
    assert (values[1].real, abs(values[1].imag)) == pytest.approx((-1.610, 1.835), abs=5e-3)
    # The print's order would leave a slow swing: its damping is a tenth of the right one's.
    printed = np.linalg.eigvals(np.array([[0, 1, 0], [0, 0, 1], [-100.0, -20.0, -60.0]]))
    assert max(printed.real) == pytest.approx(-0.153, abs=5e-3)


def test_computed_torque_on_the_rack_gives_that_loop() -> None:
    """(3.97), (3.98), both corrected, cancel exactly: the rack follows (3.99)-(3.101) by them."""
    quiet = {"coulomb_steer": 0.0, "viscous_steer": 0.0, "tyre_torque": 0.0}
    function = rates(MODEL, quiet)
    metres = P["pinion_diameter"] / 2 / P["gear_steer"]

    def acceleration(angle: float, speed: float, wanted: float) -> float:
        free = function(angle_steer=angle, speed_steer=speed)["speed_steer"]
        pushed = function(angle_steer=angle, speed_steer=speed, current_steer=1.0)["speed_steer"]
        current = (wanted - free) / (pushed - free)
        return float(function(angle_steer=angle, speed_steer=speed, current_steer=current)["speed_steer"])

    state = np.array([0.0, 0.03, 0.0])  # integral, error, rate of the rack in m
    exact, step = state.copy(), 0.02
    values, vectors = np.linalg.eig(LOOP)
    for _ in range(50):

        def slope(y: Vector) -> Vector:
            wanted = -GAINS["Ki"] * y[0] - GAINS["Kp"] * y[1] - GAINS["Kd"] * y[2]
            return np.array(
                [y[1], y[2], metres * acceleration(y[1] / metres, y[2] / metres, wanted / metres)]
            )

        k1 = slope(state)
        k2 = slope(state + step / 2 * k1)
        k3 = slope(state + step / 2 * k2)
        k4 = slope(state + step * k3)
        state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        exact = (vectors @ (np.exp(values * step) * np.linalg.solve(vectors, exact.astype(complex)))).real
        assert state == pytest.approx(exact, rel=1e-3, abs=2e-5)
