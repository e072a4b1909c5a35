"""The climbing robot: both halves joined, the corrected pivot (33), plane and tank, weight and energy."""

import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np
import numpy.typing as npt
import pytest
import sympy as sp

from fmu.climber.equations import Climber, model
from fmu.climber.parameters import PARAMETERS, SETS
from fmu.parts.motor import Shaft
from hil_tests.fmu.model_bench import ModelBench, formula, only_loses, rates

Vector = npt.NDArray[np.float64]
MODEL = model()
P = {row.name: row.start for row in PARAMETERS}
START = {"psi_left": math.pi, "psi_right": math.pi}
GEAR = P["gear_wheel"]


def start(parameters: Mapping[str, float]) -> dict[str, float]:
    p = P | dict(parameters)
    turn = math.atan(p["half_track"] / (p["tank_radius"] + p["wheel_radius"]))
    half = p["tank_radius"] * turn
    return START | {"arc_left": -half, "arc_right": half, "joint": 2 * turn}


def rolled(
    left: Callable[[float], float],
    right: Callable[[float], float],
    seconds: float,
    parameters: Mapping[str, float],
    step: float = 0.04,
) -> Iterator[dict[str, float]]:
    """Integrate the contacts under given wheel speeds in rad/s, without motors."""
    function = rates(MODEL, parameters)
    state = start(parameters)
    names = [*state, "tube_left", "tube_right", "height_left", "height_right", "pitch"]
    values = np.array([state.get(name, 0.0) for name in names])

    def slope(t: float, at: Vector) -> Vector:
        given = dict(zip(names, map(float, at), strict=True))
        found = function(speed_left=GEAR * left(t), speed_right=GEAR * right(t), **given)
        return np.array([found[name] for name in names])

    for count in range(round(seconds / step)):
        yield dict(zip(names, map(float, values), strict=True))
        t = count * step
        a = slope(t, values)
        b = slope(t + step / 2, values + step / 2 * a)
        c = slope(t + step / 2, values + step / 2 * b)
        d = slope(t + step, values + step * c)
        values = values + step / 6 * (a + 2 * b + 2 * c + d)
    yield dict(zip(names, map(float, values), strict=True))


SHAPES = {"ball": {}, "crowned": {"crown_radius": 0.008}, "wide": {"tank_radius": 2.0}}


@pytest.mark.parametrize("parameters", SHAPES.values(), ids=SHAPES)
def test_both_halves_stay_joined(parameters: dict[str, float]) -> None:
    """The right contact follows its own equations; the middle found from either wheel is the same point."""
    names = ("gear", "rotor_inertia", "coulomb", "viscous", "torque_constant")
    wheel = {f"{name}_{axis}": sp.Symbol("unused") for name in names for axis in ("left", "right")}
    robot = Climber(Shaft("left", wheel), Shaft("right", wheel))
    middle, right = robot.chassis.middle, robot.right
    track = sp.Symbol("half_track", real=True)
    gap = [middle[i] - track * right.axle[i] - right.middle[i] for i in range(3)]
    square = sum(a * b for a, b in zip(robot.chassis.longitudinal, right.axle, strict=True))
    bend = sum(a * b for a, b in zip(robot.left.axle, right.axle, strict=True)) - sp.cos(
        sp.Symbol("joint", real=True)
    )
    closing = formula(
        MODEL, {"x": gap[0], "y": gap[1], "z": gap[2], "square": square, "bend": bend}, parameters
    )
    states = list(rolled(lambda t: 2.0 + math.sin(2 * t), lambda t: 2.0 - math.sin(2 * t), 3.0, parameters))
    assert max(abs(row["psi_left"] - math.pi) for row in states) > 0.2
    for row in states[::5]:
        for name, value in closing(**row).items():
            assert value == pytest.approx(0.0, abs=5e-8), name


def test_on_a_plane_it_is_a_differential_drive() -> None:
    parameters = SETS["plane"]
    *_, last = rolled(lambda _: 1.0, lambda _: 3.0, 2.0, parameters)
    radius, track = P["wheel_radius"], P["half_track"]
    turned = radius * 2.0 * 2.0 / (2 * track)
    curve = track * (1.0 + 3.0) / 2.0
    assert last["psi_left"] == pytest.approx(math.pi + turned, abs=1e-5)
    height = (last["height_left"] + last["height_right"]) / 2
    arc = (last["arc_left"] + last["arc_right"]) / 2
    assert height == pytest.approx(curve * math.sin(turned), abs=1e-6)
    assert arc == pytest.approx(-curve * (1 - math.cos(turned)), abs=1e-6)
    for name in ("pitch", "joint", "tube_left", "tube_right"):
        assert last[name] == pytest.approx(0.0, abs=1e-5)


def test_up_the_tank_it_rolls_straight() -> None:
    *_, last = rolled(lambda _: 2.0, lambda _: 2.0, 2.0, {})
    assert last["height_left"] == pytest.approx(4.0 * P["wheel_radius"], rel=1e-12)
    assert last["psi_right"] == pytest.approx(math.pi, abs=1e-12)
    assert last["joint"] == pytest.approx(start({})["joint"], abs=1e-12)


def pivot(turn: float, tank: float, wheel: float, track: float) -> float:
    length = math.sqrt(wheel**2 + 4 * track**2)
    return math.sqrt(
        length**2 - wheel**2 + 2 * (tank**2 + wheel * tank) * (math.cos(turn) - 1)
    )  # (33) corrected


@pytest.mark.parametrize("ratio", [7.5, 20.0, 500.0])
def test_the_corrected_pivot_keeps_its_distance(ratio: float) -> None:
    wheel, track = P["wheel_radius"], P["half_track"]
    tank = ratio * track
    for turn in np.linspace(0.0, 1.9 * track / (tank + wheel), 7):
        height = pivot(turn, tank, wheel, track)
        middle = np.array([(tank + wheel) * math.cos(turn), (tank + wheel) * math.sin(turn), height])
        away = float(np.linalg.norm(middle - np.array([tank, 0.0, 0.0])))
        assert away == pytest.approx(math.hypot(wheel, 2 * track), rel=1e-12)
    # In a plane, the circle of radius 2 b, where the print has an ellipse.
    assert pivot(0.06 / 1e4, 1e4, wheel, track) == pytest.approx(math.sqrt(4 * track**2 - 0.06**2), rel=1e-4)


@pytest.mark.parametrize(("ratio", "share"), [(20.0, 0.02), (200.0, 2.5e-3)])
def test_the_robot_pivots_as_the_reduced_solution_says(ratio: float, share: float) -> None:
    tank = ratio * P["half_track"]
    for row in rolled(lambda _: 0.0, lambda _: 1.0, 4.0, {"tank_radius": tank}):
        turn = (row["arc_right"] - row["arc_left"]) / tank
        height = row["height_right"] - row["height_left"]
        if height > P["half_track"]:
            expected = pivot(turn, tank, P["wheel_radius"], P["half_track"])
            assert height == pytest.approx(expected, abs=share * 2 * P["half_track"])
    assert height > 1.5 * P["half_track"]


def test_the_planar_model_is_good_above_a_ratio_of_500_only() -> None:
    def drift(ratio: float) -> float:
        tank = ratio * P["half_track"]
        *_, last = rolled(lambda _: 2.0, lambda _: 4.0, 4.0, {"tank_radius": tank})
        turned = P["wheel_radius"] * 2.0 * 4.0 / (2 * P["half_track"])
        curve = P["half_track"] * 3.0
        height = (last["height_left"] + last["height_right"]) / 2
        arc = (last["arc_left"] + last["arc_right"]) / 2
        return math.hypot(height - curve * math.sin(turned), arc + curve * (1 - math.cos(turned)))

    assert drift(500.0) < 2e-4
    assert drift(15.0) > 2e-3


def test_at_rest_on_the_wall_nothing_creeps() -> None:
    with ModelBench(MODEL) as bench:
        settled = bench.runs(1.0)
        assert abs(settled["height"]) < 1e-4
        later = bench.runs(2.0)
        assert later == pytest.approx(settled, rel=0, abs=1e-11)


def test_without_friction_the_weight_drives_it_down() -> None:
    loose = {"gear_friction": 0.0, "coulomb_wheel": 0.0, "viscous_wheel": 0.0, "torque_constant_wheel": 0.0}
    with ModelBench(MODEL, loose) as bench:
        now = bench.runs(0.5)
    rotor = P["wheel_inertia"] + P["rotor_inertia_wheel"] * GEAR**2
    total = P["mass"] + 2 * rotor / P["wheel_radius"] ** 2
    assert now["speed"] == pytest.approx(-0.5 * 9.81 * P["mass"] / total, rel=1e-9)


@pytest.mark.parametrize("tilt", [math.pi / 2, 0.3])
def test_without_losses_energy_stays(tilt: float) -> None:
    free = {"gear_friction": 0.0, "coulomb_wheel": 0.0, "viscous_wheel": 0.0, "torque_constant_wheel": 0.0}
    free |= {"resistance_wheel": 0.0, "axis_tilt": tilt, "speed_left": 300.0, "speed_right": 500.0}
    with ModelBench(MODEL, free) as bench:
        before = bench.energy()
        energies = [bench.runs(0.05) and bench.energy() for _ in range(16)]
        assert abs(bench.now()["heading"] - math.pi / 2) > 0.1
    assert energies == pytest.approx([before] * 16, rel=1e-8)


@pytest.mark.parametrize("seed", range(2))
def test_energy_never_grows(seed: int) -> None:
    generator = np.random.default_rng(seed)
    given = {f"speed_{axis}": generator.uniform(-500, 500) for axis in ("left", "right")}
    with ModelBench(MODEL, given | {"axis_tilt": generator.uniform(-1.5, 1.5)}) as bench:
        only_loses(bench, 3000)


def test_left_and_right_are_mirror_images() -> None:
    with ModelBench(MODEL) as one, ModelBench(MODEL) as other:
        for left, right in ((12.0, 8.0), (-4.0, 10.0)):
            a, b = one.runs(0.4, left=left, right=right), other.runs(0.4, left=right, right=left)
            pairs = [
                ("height", "height", 1),
                ("arc", "arc", -1),
                ("speed", "speed", 1),
                ("joint", "joint", 1),
            ]
            pairs += [("tube_left", "tube_right", -1), ("speed_left", "speed_right", 1)]
            pairs += [("height_left", "height_right", 1), ("arc_left", "arc_right", -1)]
            for name, image, sign in pairs:
                assert a[name] == pytest.approx(sign * b[image], rel=1e-7, abs=1e-10), name
            assert a["psi_left"] - math.pi == pytest.approx(math.pi - b["psi_right"], abs=1e-9)


def test_reversing_mirrors_driving() -> None:
    with ModelBench(MODEL, {"gravity": 0.0}) as one, ModelBench(MODEL, {"gravity": 0.0}) as other:
        ahead, back = one.runs(0.5, left=9.0, right=9.0), other.runs(0.5, left=-9.0, right=-9.0)
    assert ahead["height"] == pytest.approx(-back["height"], rel=1e-9)
    assert ahead["height"] > 0.01
