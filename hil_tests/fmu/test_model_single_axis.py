"""The bench axis: motor and load by closed form, backlash, stops, energy, rest, mirror."""

import math

import numpy as np
import pytest

from fmu.single_axis.equations import model
from fmu.single_axis.parameters import PARAMETERS, SETS
from hil_tests.fmu.model_bench import ModelBench, only_loses

MODEL = model()
P = {row.name: row.start for row in PARAMETERS}
FREE = {f"{part}_axis": 0.0 for part in ("resistance", "coulomb", "viscous", "torque_constant")}
LOSSLESS = FREE | dict.fromkeys(("load_coulomb", "load_viscous", "flank_damping", "stop_damping"), 0.0)


def test_it_runs_at_the_speed_of_the_loaded_motor() -> None:
    with ModelBench(MODEL) as bench:
        now = bench.runs(1.5, axis=12.0)
    # k i = d w + T_c + (T_load + d_load w / n) / n, 12 = R i + k w
    gear, constant = P["gear_axis"], P["torque_constant_axis"]
    dry = P["coulomb_axis"] + P["load_coulomb"] / gear
    viscous = P["viscous_axis"] + P["load_viscous"] / gear**2
    speed = (12.0 - P["resistance_axis"] * dry / constant) / (
        constant + P["resistance_axis"] * viscous / constant
    )
    assert now["speed_axis"] == pytest.approx(speed, rel=1e-6)
    assert now["load_speed"] == pytest.approx(speed / gear, rel=1e-6)


def test_the_load_waits_until_the_backlash_is_crossed() -> None:
    with ModelBench(MODEL, {"backlash": 0.2}) as bench:
        while True:
            now = bench.runs(0.0005, axis=1.0)
            if now["angle_axis"] / 26 > 0.1:
                break
            assert now["load_angle"] == 0.0
        assert bench.runs(0.1, axis=1.0)["load_angle"] > 0.01
        # Reversed, the motor has the whole backlash to cross before the load is pushed back.
        before = bench.runs(1.0, load_torque=-0.5)
        while bench.plant.read("gear_torque") >= 0.0:
            now = bench.runs(0.001, axis=-1.0)
        load = before["load_angle"] - now["load_angle"]
        assert before["angle_axis"] / 26 - now["angle_axis"] / 26 == pytest.approx(0.2 + load, abs=0.01)


def test_at_rest_nothing_creeps_even_under_a_torque_that_friction_holds() -> None:
    with ModelBench(MODEL, {"backlash": 0.0, "load_coulomb": 1.0}) as bench:
        settled = bench.runs(3.0, load_torque=0.5)
        later = bench.runs(3.0, load_torque=0.5)
        assert later == pytest.approx(settled, rel=0, abs=1e-10)
        assert abs(settled["load_angle"]) < 1e-2
        assert bench.runs(1.0, load_torque=3.0)["load_angle"] > 0.1


@pytest.mark.parametrize(("voltage", "stop"), [(6.0, 2.0), (-6.0, -1.0)])
def test_the_stops_hold_the_load(voltage: float, stop: float) -> None:
    with ModelBench(MODEL, SETS["between_stops"]) as bench:
        now = bench.runs(3.0, axis=voltage)
    torque = P["torque_constant_axis"] * now["current_axis"] * 26
    pressed = (now["load_angle"] - stop) * P["stop_stiffness"]
    assert abs(now["load_speed"]) < 1e-3
    assert abs(pressed) == pytest.approx(abs(torque), abs=P["load_coulomb"] + 26 * P["coulomb_axis"] + 0.01)


def test_a_hanging_arm_swings_with_its_period() -> None:
    # Small swings of the load with the rotor on a stiff, lossless gear: T = 2 pi sqrt(J / U).
    start = LOSSLESS | {"backlash": 0.0, "unbalance": 3.0, "flank_stiffness": 1e5, "angle_axis": 26 * 0.01}
    inertia = P["load_inertia"] + P["rotor_inertia_axis"] * 26**2
    with ModelBench(MODEL, start) as bench:
        period = 2 * math.pi * math.sqrt(inertia / 3.0)
        assert bench.runs(round(period / 4, 4))["load_angle"] == pytest.approx(0.0, abs=2e-5)
        assert bench.runs(round(period / 4, 4))["load_angle"] == pytest.approx(-0.01, rel=1e-3)


@pytest.mark.parametrize("seed", range(4))
def test_energy_never_grows(seed: int) -> None:
    generator = np.random.default_rng(seed)
    start = {"speed_axis": generator.uniform(-300, 300), "angle_axis": generator.uniform(-20, 20)}
    start |= {
        "current_axis": generator.uniform(-10, 10),
        "stop_low": -1.0,
        "stop_high": 1.0,
        "unbalance": 2.0,
    }
    with ModelBench(MODEL, start) as bench:
        only_loses(bench, 4000)


def test_without_losses_energy_stays() -> None:
    start = LOSSLESS | {"speed_axis": 100.0, "stop_low": -1.0, "stop_high": 1.0, "unbalance": 2.0}
    with ModelBench(MODEL, start) as bench:
        before = bench.energy()
        energies = [bench.runs(0.02) and bench.energy() for _ in range(40)]
    # Teeth and stops that are met are kinks, where the integrator is of lower order.
    assert energies == pytest.approx([before] * 40, rel=1e-4)


def test_forwards_and_backwards_are_mirror_images() -> None:
    with ModelBench(MODEL) as one, ModelBench(MODEL) as other:
        ahead, back = one.runs(0.5, axis=9.0, load_torque=-1.0), other.runs(0.5, axis=-9.0, load_torque=1.0)
    for name, value in ahead.items():
        assert back[name] == pytest.approx(value if name == "battery_voltage" else -value, rel=1e-12), name


def test_the_closed_brake_holds_what_it_can_and_the_open_one_nothing() -> None:
    # 60 N m at the load are 2.3 N m at the motor: more than the brake's 2 N m and the friction.
    with ModelBench(MODEL, {"backlash": 0.0}) as bench:
        held = bench.runs(1.0, load_torque=45.0, brake_axis=1.0)
        assert bench.runs(1.0, load_torque=45.0, brake_axis=1.0) == pytest.approx(held, abs=1e-3)
        assert abs(held["angle_axis"]) < 0.5
        assert bench.runs(0.1, load_torque=45.0)["angle_axis"] > 1.0
    with ModelBench(MODEL, {"backlash": 0.0}) as bench:
        assert bench.runs(1.0, load_torque=60.0, brake_axis=1.0)["angle_axis"] > 1.0


def test_the_switches_close_at_their_angles() -> None:
    with ModelBench(MODEL, SETS["between_stops"]) as bench:
        closed: dict[str, float] = {}
        now = bench.runs(0.001)
        while now["load_angle"] < 1.95:
            for name in ("negative_limit_axis", "positive_limit_axis", "home_axis"):
                if now[name] != closed.get(name, 0.0):
                    closed[name] = now[name]
                    closed[f"{name} {now[name]:g}"] = now["load_angle"]
            now = bench.runs(0.001, axis=3.0)
    assert closed["home_axis 1"] == pytest.approx(0.4, abs=0.01)
    assert closed["home_axis 0"] == pytest.approx(0.6, abs=0.01)
    assert closed["positive_limit_axis 1"] == pytest.approx(1.9, abs=0.01)
    assert "negative_limit_axis 1" not in closed
