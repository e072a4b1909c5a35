"""ROME's base: (2.13) and (2.14), the control law (2.15) on the paths (2.20)-(2.22), energy, rest."""

import math
from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt
import pytest
import sympy as sp

from fmu.rome_base.equations import inverse, model, rims
from fmu.rome_base.parameters import AXES, PARAMETERS, SETS
from hil_tests.fmu.model_bench import NOTHING, ModelBench, only_loses

Vector = npt.NDArray[np.float64]
MODEL = model()
P = {row.name: row.start for row in PARAMETERS}
RADIUS, DISTANCE, GEAR = P["wheel_radius"], P["wheel_distance"], P["gear_wheel"]
FREE = {f"{part}_wheel": 0.0 for part in ("resistance", "coulomb", "viscous", "torque_constant")}
FREE |= {"roller_friction": 0.0, "roller_viscous": 0.0}
PSI = sp.Symbol("psi")
TURNED = sp.lambdify(PSI, rims(PSI, DISTANCE), "numpy")


def test_the_inverse_is_the_inverse() -> None:
    psi, distance = sp.symbols("psi L", positive=True)
    forwards, backwards = rims(psi, distance), inverse(psi, distance)
    assert sp.simplify(forwards * backwards) == sp.eye(3)  # (2.13) x (2.14)
    assert sp.simplify(forwards.det()) == 3 * sp.sqrt(3) * distance / 2


def test_a_wheel_drives_at_right_angles_to_its_place() -> None:
    # (2.7)-(2.11) corrected: wheel i drives along psi + z_i + 90 degrees, and counter-clockwise.
    matrix = rims(sp.Rational(3, 10), sp.Rational(3, 20))
    for i in range(3):
        along = 0.3 + 2 * math.pi / 3 * i + math.pi / 2
        expected = (math.cos(along), math.sin(along), 0.15)
        assert [float(value) for value in matrix.row(i)] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("speeds", [(1.0, 1.0, 1.0), (0.0, -1.0, 1.0), (2.0, -1.0, -1.0), (0.3, 0.9, -0.4)])
def test_free_wheels_keep_the_motion_that_they_have(speeds: tuple[float, float, float]) -> None:
    start = {f"speed_{axis}": 100 * speed for axis, speed in zip(AXES, speeds, strict=True)}
    with ModelBench(MODEL, FREE | start) as bench:
        first = bench.now()
        rolled = [RADIUS / GEAR * 100 * speed for speed in speeds]
        back = np.array(inverse(0, DISTANCE).tolist(), dtype=float) @ rolled
        assert (first["speed"], first["speed_sideways"], first["yaw_rate"]) == pytest.approx(
            tuple(back), abs=1e-15
        )
        last = bench.runs(2.0)
    # Nothing acts but what holds the wheels together: yaw rate and direction in the world stay.
    assert last["yaw_rate"] == pytest.approx(first["yaw_rate"], rel=1e-9, abs=1e-12)
    ratio = (P["wheel_inertia"] + P["rotor_inertia_wheel"] * GEAR**2) * 1.5 / RADIUS**2 / P["mass"]
    turned = last["heading"] / (
        1 + ratio
    )  # the wheels' spin turns with the base, the body's momentum does not
    east = last["speed"] * math.cos(turned) - last["speed_sideways"] * math.sin(turned)
    north = last["speed"] * math.sin(turned) + last["speed_sideways"] * math.cos(turned)
    assert (east, north) == pytest.approx((first["speed"], first["speed_sideways"]), abs=1e-9)


def test_a_pure_turn_reaches_the_speed_of_its_motors() -> None:
    with ModelBench(MODEL) as bench:
        now = bench.runs(1.5, one=6.0, two=6.0, three=6.0)
    constant, resistance = P["torque_constant_wheel"], P["resistance_wheel"]
    dry = P["coulomb_wheel"]
    speed = (6.0 - resistance * dry / constant) / (constant + resistance * P["viscous_wheel"] / constant)
    assert now["yaw_rate"] == pytest.approx(speed / GEAR * RADIUS / DISTANCE, rel=1e-4)
    assert math.hypot(now["x"], now["y"]) < 1e-12


def test_rollers_rub_when_the_base_moves() -> None:
    """Ahead at a steady speed: the rim forces of the motors balance the rollers of all three wheels."""
    with ModelBench(MODEL) as bench:
        now = bench.runs(4.0, two=-6.0, three=6.0)
    u = now["speed"]
    assert abs(now["speed_sideways"]) < 1e-9
    rim = [
        (P["torque_constant_wheel"] * now[f"current_{axis}"] - P["viscous_wheel"] * now[f"speed_{axis}"]
         - P["coulomb_wheel"] * np.sign(round(now[f"speed_{axis}"], 6))) * GEAR / RADIUS
        for axis in AXES
    ]  # fmt: skip
    pushing = sum(-math.sin(2 * math.pi / 3 * i) * force for i, force in enumerate(rim))
    level = P["mass"] * 9.81 / 3 * P["roller_friction"]
    rubbing = 0.0
    for i in range(3):
        share = math.cos(2 * math.pi / 3 * i)
        rubbing += abs(share) * level + P["roller_viscous"] * u * share**2
    assert pushing == pytest.approx(rubbing, rel=1e-4)


def follow(
    path: Callable[[float], tuple[float, float, float]],
    error: float,
    seconds: float,
    parameters: Mapping[str, float] = NOTHING,
) -> tuple[float, float]:
    """Drive along a path by (2.15), wheel speeds kept by a PI law.

    Returns the last distance from the path, and the share of the time in which a motor got all of its 12 V.
    """
    integral, offset = np.zeros(3), np.zeros(3)
    far, full = 0.0, 0
    start = np.array(path(0.0))
    gear = parameters.get("gear_wheel", GEAR)
    given = {**parameters, "x": start[0] + error, "y": start[1], "heading": start[2]}
    with ModelBench(MODEL, given) as bench:
        now = bench.now()
        for step in range(round(seconds * 100)):
            t = step / 100
            wanted = np.array(path(t))
            slope = (np.array(path(t + 1e-4)) - np.array(path(t - 1e-4))) / 2e-4
            e = np.array([now["x"], now["y"], now["heading"]]) - wanted
            offset += e * 0.01
            rim = TURNED(now["heading"]) @ (slope - 2.0 * e - 0.5 * offset)  # (2.15), e = actual - desired
            speeds = np.array([now[f"speed_{axis}"] for axis in AXES]) * RADIUS / gear
            integral += (rim - speeds) * 0.01
            volts = (
                gear / RADIUS * P["torque_constant_wheel"] * (rim + 3.0 * (rim - speeds) + 30.0 * integral)
            )
            full += bool(np.max(np.abs(volts)) >= 12.0)
            now = bench.runs(
                0.01, **dict(zip(AXES, (float(v) for v in np.clip(volts, -12, 12)), strict=True))
            )
            far = math.hypot(e[0], e[1])
    return far, full / round(seconds * 100)


@pytest.mark.long(keeps=["line"])
@pytest.mark.parametrize(
    "path",
    [
        lambda t: (0.8 * math.cos(0.25 * t), 0.8 * math.sin(0.25 * t), 0.0),  # (2.20), scaled
        lambda t: (0.2 * t, 0.0, 0.0),  # (2.21), scaled
        lambda t: (0.6 * math.cos(0.25 * t), 0.9 * math.sin(0.25 * t), 0.5 * t),  # (2.22), scaled, turning
    ],
    ids=["circle", "line", "ellipse"],
)
def test_the_corrected_law_leads_back_to_the_path(
    path: Callable[[float], tuple[float, float, float]],
) -> None:
    assert follow(path, 0.05, 6.0)[0] < 0.004


def orbit() -> Callable[[float], tuple[float, float, float]]:
    """(4.10) in DU and TU, in the plane that it nearly is, 1 m to the DU and 1 s to the TU, about perigee."""
    place = np.array([-0.5985, 1.6634, -0.9523, -0.0639])  # DU, DU/TU

    def rate(s: Vector) -> Vector:
        return np.array([*s[2:], *(-s[:2] / np.linalg.norm(s[:2]) ** 3)])

    def flown(s: Vector, h: float, steps: int) -> list[Vector]:
        rows = [s]
        for _ in range(steps):
            s = rows[-1]
            k1 = rate(s)
            k2 = rate(s + h / 2 * k1)
            k3 = rate(s + h / 2 * k2)
            rows.append(s + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(s + h * k3)))
        return rows

    # It begins 4 TU before that place: the perigee lies between.
    track = np.array(flown(flown(place, -0.005, 800)[-1], 0.005, 2200))
    times = 0.005 * np.arange(len(track))
    # From rest: the first two seconds of the way are driven at a growing pace.

    def at(t: float) -> tuple[float, float, float]:
        when = t * t / 4 if t < 2 else t - 1
        return float(np.interp(when, times, track[:, 0])), float(np.interp(when, times, track[:, 1])), 0.0

    return at


def line(t: float) -> tuple[float, float, float]:
    """(2.21), 1 m/s, from rest within two seconds."""
    return t * t / 4 if t < 2 else t - 1, 0.0, 0.0


@pytest.mark.long(keeps=["line"])
@pytest.mark.parametrize("path", [line, orbit()], ids=["line", "orbit"])
def test_the_sources_own_paths_need_the_faster_gears(
    path: Callable[[float], tuple[float, float, float]],
) -> None:
    """1 m/s on the line (2.21), 1.01 m/s on the orbit (4.10): with 30:1 on the path, with 64:1 lost."""
    fast = [math.dist(path(t + 0.01)[:2], path(t)[:2]) / 0.01 for t in np.arange(0.0, 10.0, 0.05)]
    assert max(fast) == pytest.approx(1.01, abs=0.015)
    far, full = follow(path, 0.0, 10.0, SETS["metre_scale"])
    assert far < 0.01
    assert full == 0.0
    far, full = follow(path, 0.0, 10.0)
    assert far > 0.3
    assert full > 0.5


@pytest.mark.parametrize("seed", range(3))
def test_energy_never_grows(seed: int) -> None:
    generator = np.random.default_rng(seed)
    start = {f"speed_{axis}": generator.uniform(-500, 500) for axis in AXES}
    start |= {f"current_{axis}": generator.uniform(-5, 5) for axis in AXES}
    with ModelBench(MODEL, start) as bench:
        only_loses(bench, 4000)


def test_without_losses_energy_stays() -> None:
    start = {f"speed_{axis}": speed for axis, speed in zip(AXES, (300.0, -100.0, 250.0), strict=True)}
    with ModelBench(MODEL, FREE | start) as bench:
        before = bench.energy()
        assert [bench.runs(0.1) and bench.energy() for _ in range(20)] == pytest.approx(
            [before] * 20, rel=1e-9
        )


def test_at_rest_nothing_creeps() -> None:
    with ModelBench(MODEL) as bench:
        before = bench.now()
        assert bench.runs(5.0) == before


def test_turned_by_120_degrees_it_is_the_same_machine() -> None:
    with ModelBench(MODEL) as one, ModelBench(MODEL, {"heading": -2 * math.pi / 3}) as other:
        a = one.runs(1.0, one=5.0, two=-2.0, three=1.0)
        b = other.runs(1.0, two=5.0, three=-2.0, one=1.0)
    assert (a["x"], a["y"]) == pytest.approx((b["x"], b["y"]), abs=1e-12)
    assert a["heading"] == pytest.approx(b["heading"] + 2 * math.pi / 3, abs=1e-12)
    assert a["speed_two"] == pytest.approx(b["speed_three"], abs=1e-9)


def test_reversing_mirrors_driving() -> None:
    with ModelBench(MODEL) as one, ModelBench(MODEL) as other:
        ahead = one.runs(0.5, two=-6.0, three=6.0)
        back = other.runs(0.5, two=6.0, three=-6.0)
    for name in ("x", "speed", "current_two", "angle_three"):
        assert ahead[name] == pytest.approx(-back[name], rel=1e-9)


def test_a_wheel_in_the_air_turns_as_its_own_inertia_lets_it_and_moves_nothing() -> None:
    """Its motor gets 6 V: without friction it gains K i n / (I_w + J n2), and the base stands."""
    with ModelBench(MODEL, FREE | {"torque_constant_wheel": P["torque_constant_wheel"]}) as bench:
        before = bench.runs(0.002, one=6.0, lifted_one=1.0)
        now = bench.runs(0.0001, one=6.0, lifted_one=1.0)
    current = 0.5 * (before["current_one"] + now["current_one"])
    inertia = P["wheel_inertia"] / GEAR**2 + P["rotor_inertia_wheel"]
    gained = (now["speed_one"] - before["speed_one"]) / 0.0001
    assert gained == pytest.approx(P["torque_constant_wheel"] * current / inertia, rel=1e-2)
    assert [now[it] for it in ("speed", "speed_sideways", "yaw_rate")] == pytest.approx([0.0] * 3)


def test_put_down_it_turns_with_the_floor_again_and_the_base_has_what_it_lost() -> None:
    with ModelBench(MODEL) as bench:
        spun = bench.runs(0.5, one=6.0, lifted_one=1.0)
        assert spun["speed_one"] > 200.0
        assert math.hypot(spun["speed"], spun["speed_sideways"]) < 1e-3
        moved = bench.runs(0.05, one=6.0)
        assert moved["speed_sideways"] > 0.01  # wheel one drives to the left
        now = bench.runs(3.0)
    rolled = np.array(rims(0, DISTANCE).tolist(), dtype=float) @ [
        now[it] for it in ("speed", "speed_sideways", "yaw_rate")
    ]
    assert rolled == pytest.approx([RADIUS / GEAR * now[f"speed_{axis}"] for axis in AXES], abs=1e-9)


@pytest.mark.parametrize("lifted", [("one",), ("one", "three"), AXES], ids="+".join)
def test_the_others_carry_on_as_if_it_were_not_there(lifted: tuple[str, ...]) -> None:
    """With free wheels in the air a push has the mass of what still turns with the base: energy stays."""
    start = {f"speed_{axis}": speed for axis, speed in zip(AXES, (300.0, -100.0, 250.0), strict=True)}
    with ModelBench(MODEL, FREE | start) as bench:
        before, first = bench.energy(), bench.now()
        for _ in range(5):
            now = bench.runs(0.2, **{f"lifted_{axis}": 1.0 for axis in lifted})
            assert bench.energy() == pytest.approx(before, rel=1e-9)
        for axis in lifted:
            assert now[f"speed_{axis}"] == pytest.approx(first[f"speed_{axis}"], rel=1e-12)
