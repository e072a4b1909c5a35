"""Motors, straight line, circle and lift agree with closed forms; left and right are mirror images."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from fmu.rars.parameters import PARAMETERS, SETS
from hil_tests.fmu.conftest import FINE
from hil_tests.fmu.rolling_limit import rolling

Vector = npt.NDArray[np.float64]

P = {row.name: row.start for row in PARAMETERS}
RADIUS, TRACK, WHEELBASE, KINGPINS = 0.05, 0.4, 0.515, 0.21


def no_load_speed(axis: str, voltage: float) -> float:
    resistance, constant = P[f"resistance_{axis}"], P[f"torque_constant_{axis}"]
    rubbing = voltage - resistance * P[f"coulomb_{axis}"] / constant
    return rubbing / (constant + resistance * P[f"viscous_{axis}"] / constant)


GRIPPING = {"floor_friction": 1e4, "cg_height": 0.0, "tyre_stiffness": 2e6, "tyre_damping": 6e3}
GRIPPING |= {"rolling_resistance": 0.0}
"""Tyres that hardly slip: near the limit that has closed forms."""


def test_a_wheel_motor_alone_reaches_its_no_load_speed(bench: Any) -> None:
    now = bench(GRIPPING, step=FINE).runs(1.5, left=24.0, right=24.0)
    for axis in ("left", "right"):
        assert now[f"speed_{axis}"] == pytest.approx(no_load_speed(axis, 24.0), rel=1e-6)
        assert now[f"current_{axis}"] == pytest.approx(0.236, rel=1e-3)
    assert now["speed"] == pytest.approx(RADIUS * now["speed_left"] / 26, rel=1e-6)
    assert now["yaw_rate"] == pytest.approx(0.0, abs=1e-12)


def test_the_step_of_the_bench_is_fine_enough(bench: Any) -> None:
    """Hard starts, a turn, a reversal and both stops, beside a run with an eighth of the step."""
    course = (
        (0.6, {"left": 12.0, "right": 10.0, "steer": 24.0, "lift": 24.0}),
        (0.6, {"left": -12.0, "right": 12.0, "steer": -24.0, "lift": -12.0}),
        (0.6, {"left": 3.0, "right": 3.0}),
    )
    runs = []
    for plant in (bench(), bench(step=12_500)):
        held = [voltages for way, voltages in course for _ in range(round(way / 0.02))]
        runs.append([list(plant.runs(0.02, **voltages).values()) for voltages in held])
    coarse, fine = np.array(runs)
    assert (np.abs(coarse - fine).max(axis=0) < 2e-5 * np.abs(fine).max(axis=0)).all()


class LinearMotor:
    """Winding and shaft of a wheel motor that moves half of the rolling robot, under 6 V from rest."""

    def __init__(self) -> None:
        mass = P["platform_mass"] + 2 * P["wheel_mass"] + 2 * P["wheel_spin_inertia"] / RADIUS**2
        inertia = P["rotor_inertia_left"] + mass / 2 * (RADIUS / 26) ** 2
        constant, inductance = P["torque_constant_left"], P["inductance_left"]
        self.system = np.array(
            [
                [-P["resistance_left"] / inductance, -constant / inductance],
                [constant / inertia, -P["viscous_left"] / inertia],
            ]
        )
        self.steady = np.linalg.solve(self.system, [-6.0 / inductance, 0.0])
        self.values, self.vectors = np.linalg.eig(self.system)
        self.amplitudes = np.linalg.solve(self.vectors, -self.steady)

    def at(self, t: float) -> Vector:
        """Current in A and speed in rad/s."""
        found: Vector = self.steady + (self.vectors @ (self.amplitudes * np.exp(self.values * t))).real
        return found


def test_straight_line_follows_the_linear_motor_exactly() -> None:
    """The limit without slip, from the plant's own equations."""
    rates = rolling({"coulomb_left": 0.0, "coulomb_right": 0.0})
    motor, names = LinearMotor(), ("current_left", "speed_left")

    def slope(state: Vector) -> Vector:
        current, speed = map(float, state)
        both = {f"{what}_{side}": value for side in ("left", "right")
                for what, value in (("current", current), ("speed", speed), ("voltage", 6.0))}  # fmt: skip
        found = rates(**both)
        return np.array([found[name] for name in names])

    state, h = np.zeros(2), 50e-6
    for steps in range(1, 11):
        for _ in range(40):
            k1 = slope(state)
            k2 = slope(state + h / 2 * k1)
            k3 = slope(state + h / 2 * k2)
            k4 = slope(state + h * k3)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        exact = motor.at(0.002 * steps)
        assert state[0] == pytest.approx(exact[0], abs=2e-4)
        assert state[1] == pytest.approx(exact[1], abs=2e-4)


@pytest.mark.parametrize(("stiffness", "damping"), [(5e5, 4e3), (2e6, 6e3)])
def test_straight_line_on_springs_follows_the_linear_system(
    bench: Any, stiffness: float, damping: float
) -> None:
    """Without slip the tyres are springs: motor, rear tyre, half the robot, front tyre and wheel."""
    tyres = GRIPPING | {"floor_friction": 1e12, "tyre_stiffness": stiffness, "tyre_damping": damping}
    plant = bench(tyres | {"coulomb_left": 0.0, "coulomb_right": 0.0}, step=FINE)
    constant, inductance, per_turn = P["torque_constant_left"], P["inductance_left"], RADIUS / 26
    rotor = P["rotor_inertia_left"] + P["wheel_spin_inertia"] / 26**2
    half, spin = P["platform_mass"] / 2 + P["wheel_mass"], P["front_spin_inertia"]
    rear_bend = np.array([0.0, per_turn, 0.0, -1.0, 0.0, 0.0])
    front_bend = np.array([0.0, 0.0, 0.0, -1.0, RADIUS, 0.0])
    rear = stiffness * np.eye(6)[2] + damping * rear_bend
    front = stiffness * np.eye(6)[5] + damping * front_bend
    current, shaft = np.eye(6)[0], np.eye(6)[1]
    system = np.array(
        [
            (-P["resistance_left"] * current - constant * shaft) / inductance,
            (constant * current - P["viscous_left"] * shaft - per_turn * rear) / rotor,
            rear_bend,
            (rear + front) / half,
            -RADIUS * front / spin,
            front_bend,
        ]
    )
    steady = np.linalg.solve(system, [-6.0 / inductance, 0.0, 0.0, 0.0, 0.0, 0.0])
    values, vectors = np.linalg.eig(system)
    amplitudes = np.linalg.solve(vectors, -steady)
    for steps in range(1, 11):
        now = plant.runs(0.002, left=6.0, right=6.0)
        exact = steady + (vectors @ (amplitudes * np.exp(values * 0.002 * steps))).real
        assert now["current_left"] == pytest.approx(exact[0], abs=2e-4)
        assert now["speed_left"] == pytest.approx(exact[1], abs=2e-4)
        assert now["speed"] == pytest.approx(exact[3], abs=2e-6)


FREE = {
    f"{part}_{axis}": 0.0 for part in ("coulomb", "viscous", "torque_constant") for axis in ("left", "right")
}


def test_a_ramp_accelerates_the_free_robot(bench: Any) -> None:
    mass = P["platform_mass"] + 2 * P["wheel_mass"]
    rotating = 2 * (P["wheel_spin_inertia"] + P["rotor_inertia_left"] * 26**2) / RADIUS**2
    downhill = -9.81 * math.sin(0.1) * mass
    found = rolling(FREE | {"slope": 0.1})()["speed"]
    assert found == pytest.approx(downhill / (mass + rotating), rel=1e-9)
    # On tyres and with the front wheels' inertia, which the closed form leaves out.
    rotating += 2 * P["front_spin_inertia"] / RADIUS**2
    now = bench(GRIPPING | FREE | {"slope": 0.1}, step=FINE).runs(1.0)
    assert now["speed"] == pytest.approx(downhill / (mass + rotating), rel=1e-4)


@pytest.mark.parametrize("degrees", [3.0, 10.0, 20.0, 40.0])
def test_front_wheels_lead_the_coasting_robot_round(bench: Any, degrees: float) -> None:
    # Nothing but the front tyres acts on the platform: its circle lies where their slips cancel.
    free = {
        f"{part}_{axis}": 0.0
        for part in ("coulomb", "viscous", "torque_constant")
        for axis in ("left", "right")
    }
    tangent, h = math.tan(math.radians(degrees)), P["davis_h"]
    b = h * KINGPINS / (2 * WHEELBASE)
    rack = tangent * (h**2 + b**2) / (h + b * tangent)
    wheel = 0.3 / RADIUS * 26
    start = {"angle_steer": rack / (0.015 / 159), "speed_left": wheel, "speed_right": wheel}
    now = bench(free | start).runs(2.5)
    by_left = KINGPINS / 2 + WHEELBASE / math.tan(now["steer_left"])
    by_right = -KINGPINS / 2 + WHEELBASE / math.tan(now["steer_right"])
    low, high = sorted((by_left, by_right))
    # The tyres must also turn the momentum of the offset center of mass: m a v W at the wheelbase.
    slack = 0.02 * low
    assert low - slack < now["speed"] / now["yaw_rate"] < high + slack
    assert now["speed"] > 0.1


def test_wheel_speeds_that_fit_the_angle_leave_the_front_wheels_little_slip(bench: Any) -> None:
    degrees, speed = 30.0, 0.3
    tangent, h = math.tan(math.radians(degrees)), P["davis_h"]
    b = h * KINGPINS / (2 * WHEELBASE)
    rack = tangent * (h**2 + b**2) / (h + b * tangent)
    radius = KINGPINS / 2 + WHEELBASE / tangent
    plant = bench({"angle_steer": rack / (0.015 / 159)})

    def voltage(axis: str, share: float) -> float:
        shaft = 26 * speed / RADIUS * share
        loss = P[f"coulomb_{axis}"] + P[f"viscous_{axis}"] * shaft
        return (
            shaft * P[f"torque_constant_{axis}"]
            + P[f"resistance_{axis}"] * loss / P[f"torque_constant_{axis}"]
        )

    left, right = (1 - TRACK / 2 / radius), (1 + TRACK / 2 / radius)
    now = plant.runs(1.5, left=voltage("left", left), right=voltage("right", right))
    assert now["speed"] / now["yaw_rate"] == pytest.approx(radius, rel=0.01)
    for wheel in ("front_left", "front_right", "rear_left", "rear_right"):
        assert abs(plant.plant.read(f"slip_left_{wheel}")) < 0.05
        assert abs(plant.plant.read(f"slip_ahead_{wheel}")) < 0.05


def test_lifting_takes_the_torque_of_the_corrected_screw_formula(bench: Any) -> None:
    plant = bench({"lift_mass": 0.5, "coulomb_lift": 0.0, "viscous_lift": 0.0})
    now = plant.runs(1.0, lift=12.0)
    height = now["lift_height"] / 6 + 0.3 * math.sin(math.radians(5))
    angle = math.asin(height / 0.3)
    force = 0.5 * 9.81 * 6 / math.tan(angle)  # (2.17)
    thread = 0.10 / math.cos(math.radians(30))  # printed: mu 0.1, 2 alpha 60 degrees
    torque = (
        force * 0.010 / 2 * (0.0015 + math.pi * thread * 0.010) / (math.pi * 0.010 - thread * 0.0015)
    )  # (2.18)
    # The rest goes into the slow change of speed as the scissor opens.
    assert now["current_lift"] * 25e-3 * 25 == pytest.approx(torque, rel=0.02)


def test_the_ten_watt_motor_lifts_the_platform_within_its_peak_current(bench: Any) -> None:
    plant = bench()
    currents = [plant.runs(0.01, lift=15.0)["current_lift"] for _ in range(100)]
    assert plant.now()["lift_height"] > 0.1
    assert max(currents) < 2.0


@pytest.mark.parametrize("start", [{}, {"angle_lift": 4000.0, "angle_steer": -250.0, "lift_payload": 4.0}])
def test_at_rest_nothing_creeps(bench: Any, start: dict[str, float]) -> None:
    plant = bench(start)
    before = plant.now()
    after = plant.runs(10.0)
    assert after == pytest.approx(before, rel=0, abs=1e-11)


def test_an_unlocked_screw_lets_the_lift_down(bench: Any) -> None:
    start = {"angle_lift": 3000.0, "torque_constant_lift": 0.0}
    assert bench(start).runs(0.5)["lift_height"] == pytest.approx(
        bench(start).now()["lift_height"], abs=1e-12
    )
    loose = bench(start | {"screw_friction": 0.02})
    assert loose.runs(0.5)["lift_height"] < bench(start).now()["lift_height"] - 0.004


@pytest.mark.parametrize("parameters", SETS.values(), ids=SETS)
def test_left_and_right_are_mirror_images(bench: Any, parameters: dict[str, float]) -> None:
    one, other = bench(parameters), bench(parameters)
    for left, right, steer in ((6.0, 3.0, 8.0), (-4.0, 2.0, -12.0), (0.0, 5.0, 3.0)):
        a = one.runs(0.4, left=left, right=right, steer=steer)
        b = other.runs(0.4, left=right, right=left, steer=-steer)
        pairs = [("x", "x", 1), ("y", "y", -1), ("heading", "heading", -1), ("speed", "speed", 1)]
        pairs += [("yaw_rate", "yaw_rate", -1), ("rack", "rack", -1), ("steer", "steer", -1)]
        pairs += [("steer_left", "steer_right", -1), ("current_left", "current_right", 1)]
        pairs += [("speed_left", "speed_right", 1), ("current_steer", "current_steer", -1)]
        for name, image, sign in pairs:
            assert a[name] == pytest.approx(sign * b[image], rel=1e-9, abs=1e-10), name


def test_forward_and_reverse_are_mirror_images(bench: Any) -> None:
    # Without load transfer: with it, driving off forwards presses the driven wheels down.
    level = {"cg_height": 0.0}
    ahead, back = bench(level).runs(0.7, left=7.0, right=7.0), bench(level).runs(0.7, left=-7.0, right=-7.0)
    for name in ("x", "speed", "current_left", "angle_right"):
        assert ahead[name] == pytest.approx(-back[name], rel=1e-12)


def test_the_battery_sags_by_its_resistance(bench: Any) -> None:
    now = bench().runs(0.002, left=12.0, right=12.0)
    power = 12.0 * (now["current_left"] + now["current_right"])
    drawn = power / now["battery_voltage"]
    assert drawn > 20
    assert now["battery_voltage"] == pytest.approx(24.0 - 0.05 * drawn, rel=1e-12)
