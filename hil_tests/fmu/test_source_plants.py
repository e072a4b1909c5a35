"""Plants of the sources' other models beside ways written apart: castors, nine coordinates, tires, springs.

[R] is A. P. Das, PhD thesis, IIT Delhi, 2018. What it does not print is assumed, and named so in each plant.
"""

import math
from functools import cache

import numpy as np
import pytest
from fmpy.validation import validate_fmu

from firmware_bridge.units import MILLISECOND
from fmu.build import ensure
from fmu.export.model import Model
from fmu.plants import find
from fmu.rars.interface import INPUTS, OUTPUTS
from hil_tests.fmu.model_bench import ModelBench, formula, only_loses, rates
from validation.rars.castors import Castored
from validation.rars.magic_formula import NEAREST, THROUGH, friction
from validation.rars.nine_coordinates import Nine
from validation.rars.step import Sprung
from validation.studies.solve import Floats, integrate

PLANTS = ("castors", "nine_coordinates", "rars_magic", "rars_sprung")
WHEELS = ("front_left", "front_right", "rear_left", "rear_right")
RATES = (
    *("spin_rear_left", "spin_rear_right", "ahead_left", "ahead_right", "aside"),
    *("steer_rate_left", "steer_rate_right", "spin_front_left", "spin_front_right"),
)
"""q' of [R] (3.46), in its order."""


@cache
def model_of(name: str) -> Model:
    return find(name).model()


def on_bench(name: str, **values: float) -> ModelBench:
    return ModelBench(model_of(name), values, step=MILLISECOND)


@pytest.mark.long(beside="test_castors_with_mass_accelerate_so")
@pytest.mark.parametrize("name", PLANTS)
def test_fmpy_finds_nothing_wrong(name: str) -> None:
    assert validate_fmu(str(ensure(name))) == []


@pytest.mark.parametrize("name", PLANTS)
def test_every_number_has_its_source(name: str) -> None:
    plant = find(name)
    assert all("assumed" in row.source or "[R]" in row.source for row in plant.parameters)
    assert {key for chosen in plant.sets.values() for key in chosen} <= {row.name for row in plant.parameters}


@pytest.mark.parametrize("name", ["rars_magic", "rars_sprung"])
def test_a_robot_file_of_rars_may_name_it(name: str) -> None:
    outputs = {row.name: row.unit for row in model_of(name).outputs if not row.local}
    assert outputs == OUTPUTS
    assert {row.name: row.unit for row in model_of(name).inputs} == INPUTS


def test_castors_with_mass_accelerate_so() -> None:
    """(3.31)-(3.40), corrected: the supplement's check vector."""
    found = rates(model_of("castors"))(
        swivel_left=0.3, swivel_right=-0.2, spin_left=4.0, spin_right=6.0, torque_left=0.5, torque_right=0.8
    )
    swivels = [found["swivel_left"], found["swivel_right"]]
    assert swivels == pytest.approx([-1.671923, -4.776649], abs=5e-7)
    assert [found["spin_left"], found["spin_right"]] == pytest.approx([7.554313, 7.695937], abs=5e-7)


@pytest.mark.parametrize("across", [0.0, 0.01])
def test_castors_swing_round_as_the_balance_of_masses_has_it(across: float) -> None:
    """The FMU beside the numbers of the study, which d'Alembert confirms, over three seconds of pushing."""
    robot, push = Castored(across=across), 0.2

    def moves(_: float, state: Floats) -> Floats:
        swivels, spins = state[:2], state[2:]
        pushed = robot.accelerations(swivels, spins, np.array([push, push]))
        return np.concatenate([robot.rates(swivels, spins)[0], pushed])

    wanted = integrate(moves, np.array([0.3, -0.2, 0.0, 0.0]), np.linspace(0.0, 3.0, 601), 4)[-1]
    values = {"swivel_left": 0.3, "swivel_right": -0.2, "castor_across": across}
    with on_bench("castors", **values) as bench:
        bench.runs(3.0, torque_left=push, torque_right=push)
        names = ("swivel_left", "swivel_right", "spin_left", "spin_right")
        assert [bench.plant.read(name) for name in names] == pytest.approx(list(wanted), abs=1e-6)
        energy, free = bench.energy(), bench.runs(2.0)
        assert bench.energy() == pytest.approx(energy, rel=1e-9), f"nothing rubs: {free}"


def test_nine_coordinates_accelerate_by_the_printed_matrices() -> None:
    """(3.46)-(3.72) with abar_2 corrected, at random rates, on a floor without friction."""
    robot, chance = Nine(), np.random.default_rng(3)
    mass = robot.inertia()
    # Tires as soft as nothing: the floor gives no force.
    free = rates(model_of("nine_coordinates"), {"tyre_stiffness": 1e-12, "tyre_damping": 0.0})
    for _ in range(50):
        moving, steers, wheels = (chance.uniform(-2.0, 2.0, size) for size in (9, 2, 2))
        tau = np.array([*wheels, 0.0, 0.0, 0.0, *steers, 0.0, 0.0])
        torques = {"torque_left": wheels[0], "torque_right": wheels[1]}
        torques |= {"torque_steer_left": steers[0], "torque_steer_right": steers[1]}
        found = free(**dict(zip(RATES, moving, strict=True)), **torques)
        wanted = np.linalg.solve(mass, tau - robot.coriolis(moving) @ moving)
        assert [found[name] for name in RATES] == pytest.approx(list(wanted), rel=1e-9, abs=1e-6)


@pytest.mark.long(beside="test_nine_coordinates_accelerate_by_the_printed_matrices")
def test_nine_coordinates_on_tires_lose_energy_and_turn_as_they_steer() -> None:
    turning, rolling = 0.2, {f"spin_{wheel}": 10.0 for wheel in WHEELS}
    start = {"ahead_left": 0.5, "ahead_right": 0.5, "steer_left": turning, "steer_right": turning}
    with on_bench("nine_coordinates", **start, **rolling, floor_friction=1.0) as bench:
        bench.runs(0.1)
        read = bench.plant.read
        curvature = read("yaw_rate") / read("speed")
        # No trail and no torque: a steered wheel keeps its way over the floor, its angle what is left of it.
        assert read("steer_left") + read("heading") == pytest.approx(turning, abs=1e-9)
        assert curvature == pytest.approx(math.tan(read("steer_left")) / 0.515, rel=0.05)
        only_loses(bench, 500)


@pytest.mark.parametrize("way", ["through", "nearest"])
@pytest.mark.parametrize("slip", [0.02, 0.1, 0.15, 0.3, 0.7, 1.0])
def test_a_steady_slide_has_the_magic_formula_s_friction(way: str, slip: float) -> None:
    """(3.45); coefficients assumed, through (3.83)'s peak and end, or nearest to it over all."""
    coefficients = THROUGH if way == "through" else NEAREST
    values = dict(zip(("magic_b", "magic_c", "magic_e"), coefficients, strict=True))
    model = model_of("rars_magic")
    load = 9.81 * (70.0 * (1 - 0.22 / 0.515) + 0.6) / 2
    force, rim = 0.3 * load * float(friction(coefficients, slip)), 0.4
    given = {"speed_left": 26 * rim / 0.05, "speed": rim * (1 - slip), "tyre_ahead_rear_left": force / 5e5}
    found = rates(model, values | {"cg_height": 0.0})(**given)
    assert found["tyre_ahead_rear_left"] == pytest.approx(0.0, abs=1e-7)


def test_at_small_forces_the_magic_formula_slips_a_third_as_much() -> None:
    """Its slope at 0 is 18.6, that of (3.83) 6.67."""
    model, force = model_of("rars_magic"), 2.0
    rim = 0.4
    slipping = formula(
        model, {"slip": next(it.rate for it in model.states if it.name == "tyre_ahead_rear_left")}
    )
    load = 9.81 * (70.0 * (1 - 0.22 / 0.515) + 0.6) / 2
    slip = force / (0.3 * load) / (THROUGH.b * THROUGH.c)
    given = {"speed_left": 26 * rim / 0.05, "speed": rim * (1 - slip), "tyre_ahead_rear_left": force / 5e5}
    assert slipping(**given)["slip"] == pytest.approx(0.0, abs=1e-5)
    assert slip == pytest.approx(force / (0.3 * load) * 0.15 / 2.8, rel=0.01)


@pytest.mark.long(beside="test_a_steady_slide_has_the_magic_formula_s_friction")
def test_on_the_magic_formula_nothing_creeps_at_rest() -> None:
    braked = {f"coulomb_{axis}": 50.0 for axis in ("left", "right")}
    with on_bench("rars_magic", **braked, slope=0.1, rolling_resistance=0.0) as bench:
        before = bench.runs(1.0)["x"]
        assert bench.runs(2.0)["x"] == pytest.approx(before, abs=1e-9)
        only_loses(bench, 200)


def test_on_springs_it_stands_as_the_levers_have_it() -> None:
    """2.3: 293 N on the front pair and 399 N on the rear one, Tab. 3.1."""
    found = rates(model_of("rars_sprung"))()
    body = ("heave_rate", "roll_rate", "pitch_rate", "speed", "drift", "yaw_rate")
    assert [found[name] for name in body] == pytest.approx([0.0] * len(body), abs=1e-12)
    model = model_of("rars_sprung")
    loads = {row.name: row.expression for row in model.outputs if row.name.startswith("load_")}
    standing = formula(model, loads)()
    pairs = [sum(standing[f"load_{axle}_{side}"] for side in ("left", "right")) for axle in ("front", "rear")]
    assert pairs == pytest.approx([293.35, 399.24], abs=0.01)


@pytest.mark.long(beside="test_on_springs_it_stands_as_the_levers_have_it")
def test_a_wheel_on_the_step_twists_the_loads() -> None:
    """2.3, springs assumed: the diagonal of the raised wheel bears more, as least squares have it."""
    wanted = Sprung().resting(np.array([0.02, 0.0, 0.0, 0.0]))
    with on_bench("rars_sprung", edge_x=0.45, step_right=0.0) as bench:
        bench.runs(3.0)
        found = [bench.plant.read(f"load_{wheel}") for wheel in WHEELS]
    weights = np.array([0.0, 0.0, 1.0, 1.0]) * 0.3 * 9.81
    assert np.array(found) - weights == pytest.approx(wanted, abs=1e-3)
    # Above 29.3 kN/m of a rectangle the lightest wheel leaves the floor.
    with on_bench("rars_sprung", edge_x=0.45, step_right=0.0, spring_stiffness=6e4) as bench:
        bench.runs(3.0)
        stiff = {wheel: bench.plant.read(f"load_{wheel}") for wheel in WHEELS}
    assert stiff["front_right"] == 0.0
    assert min(load for wheel, load in stiff.items() if wheel != "front_right") > 0.0
    assert sum(stiff.values()) == pytest.approx(70.6 * 9.81, rel=1e-3)


CLIMBS = [
    # Friction, rear axle to center of mass, step under the right wheels, do the front wheels come up.
    (0.30, 0.220, 0.020, False),
    (0.60, 0.220, 0.020, False),
    (1.00, 0.220, 0.020, True),
    (0.30, 0.141, 0.020, False),
    (0.55, 0.141, 0.020, True),
    (0.20, 0.141, 0.000, False),
    (0.40, 0.141, 0.000, True),
]


@pytest.mark.long(beside="test_on_springs_it_stands_as_the_levers_have_it")
@pytest.mark.parametrize(("grip", "offset", "right", "comes_up"), CLIMBS)
def test_from_standstill_the_front_climbs_where_the_friction_suffices(
    grip: float, offset: float, right: float, *, comes_up: bool
) -> None:
    """2.3: both wheels at once need 0.98 or 0.50, one alone 0.49 or 0.25; springs and loads give way, too."""
    values = {"floor_friction": grip, "centre_offset": offset, "step_right": right, "edge_x": 0.5601}
    with on_bench("rars_sprung", **values) as bench:
        highest = 0.0
        for _ in range(200):
            bench.runs(0.02, left=4.0, right=4.0)
            highest = max(highest, bench.plant.read("floor_front_left"))
    assert (highest > 0.0199) == comes_up, f"it came up by {1e3 * highest:.1f} mm"


@pytest.mark.long(beside="test_on_springs_it_stands_as_the_levers_have_it")
def test_with_a_run_up_it_drives_over_and_a_wheel_in_the_air_turns_free() -> None:
    """2.3: each rear wheel has a motor, so the other drives on; the load far ahead, so that one leaves it."""
    ahead = {"centre_offset": 0.35, "floor_friction": 1.0}
    with on_bench("rars_sprung", spring_stiffness=6e4, step_right=0.0, **ahead) as bench:
        least, faster = math.inf, 0.0
        for _ in range(400):
            now = bench.runs(0.01, left=14.0, right=14.0)
            for side in ("left", "right"):
                load = bench.plant.read(f"load_rear_{side}")
                least = min(least, load)
                if load == 0.0:
                    faster = max(faster, now[f"speed_{side}"] / 26.0 * 0.05 - now["speed"])
        assert bench.plant.read("floor_rear_left") == pytest.approx(0.02)
    assert least == 0.0
    assert faster > 0.0
    assert now["speed"] == pytest.approx(0.697, abs=0.02), "it drives on"


@pytest.mark.long(beside="test_on_springs_it_stands_as_the_levers_have_it")
def test_rolling_over_the_step_gains_no_energy() -> None:
    with on_bench("rars_sprung", speed_left=416.0, speed_right=416.0, edge_x=0.7) as bench:
        only_loses(bench, 1500)
