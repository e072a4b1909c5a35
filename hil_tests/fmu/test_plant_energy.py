"""The plant makes no energy: it keeps it where nothing rubs, and loses it where something does."""

from typing import Any

import numpy as np
import pytest

from fmu.rars.interface import AXES
from hil_tests.fmu.conftest import FINE

LOSSLESS = {f"{part}_{axis}": 0.0 for part in ("resistance", "coulomb", "viscous") for axis in AXES} | {
    "floor_friction": 1e12,  # tyres that never let go, and no damping in them: springs
    "tyre_damping": 0.0,
    "rolling_resistance": 0.0,
    "cg_height": 0.0,
    "tyre_torque": 0.0,
    "screw_friction": 1e-12,
    "rack_stop_damping": 0.0,
    "lift_stop_damping": 0.0,
}


def random_start(seed: int) -> dict[str, float]:
    generator = np.random.default_rng(seed)
    start = {f"speed_{axis}": generator.uniform(-500, 500) for axis in AXES}
    start |= {f"current_{axis}": generator.uniform(-10, 10) for axis in AXES}
    start |= {"angle_steer": generator.uniform(-400, 400), "angle_lift": generator.uniform(500, 8500)}
    return start | {"heading": generator.uniform(-3, 3)}


@pytest.mark.parametrize("seed", range(6))
def test_shorted_motors_only_lose_energy(bench: Any, seed: int) -> None:
    plant = bench(random_start(seed))
    before = plant.energy()
    for _ in range(5000):
        plant.plant.step()
        after = plant.energy()
        assert after <= before + 1e-12 * abs(before)
        before = after


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("slope", [0.0, 0.1])
def test_without_any_loss_energy_stays(bench: Any, seed: int, slope: float) -> None:
    # Convective terms, M(x) of the rack, the scissor's gain and the elastic stops must all fit each other.
    generator = np.random.default_rng(seed)
    start = {f"speed_{axis}": generator.uniform(-300, 300) for axis in AXES}
    start |= {"angle_lift": 4000.0, "angle_steer": generator.uniform(-300, 300), "slope": slope}
    plant = bench(LOSSLESS | start, step=FINE)
    before = plant.energy()
    energies = []
    for _ in range(20):
        plant.runs(0.05)
        energies.append(plant.energy())
    assert energies == pytest.approx([before] * 20, rel=1e-6)


def test_the_stops_are_reached_in_the_lossless_run(bench: Any) -> None:
    plant = bench(LOSSLESS | {"speed_steer": 300.0, "angle_steer": 430.0, "torque_constant_steer": 0.0})
    before = plant.energy()
    racks = [plant.runs(0.001)["rack"] for _ in range(100)]
    assert max(racks) > 0.042
    assert racks[-1] < 0.042
    # Meeting the stop is a kink, where the integrator is of lower order.
    assert plant.energy() == pytest.approx(before, rel=1e-4)


@pytest.mark.parametrize(
    ("axis", "damping", "angle", "speed"),
    [
        ("steer", "rack_stop_damping", 440.0, 400.0),
        ("steer", "rack_stop_damping", -440.0, -400.0),
        ("lift", "lift_stop_damping", 20.0, -700.0),
        ("lift", "lift_stop_damping", 9070.0, 700.0),
    ],
)
def test_a_damped_stop_throws_back_more_slowly(
    bench: Any, axis: str, damping: str, angle: float, speed: float
) -> None:
    free = LOSSLESS | {f"torque_constant_{axis}": 0.0, f"angle_{axis}": angle, f"speed_{axis}": speed}
    elastic = bench(free | {"lift_mass": 1e-3}).runs(0.08)[f"speed_{axis}"]
    damped = bench(free | {"lift_mass": 1e-3, damping: 50.0}).runs(0.08)[f"speed_{axis}"]
    assert elastic == pytest.approx(-speed, rel=0.05)
    assert 0.1 < damped / elastic < 0.95


@pytest.mark.parametrize("axis", AXES)
def test_a_motor_takes_no_more_energy_than_it_is_given(bench: Any, axis: str) -> None:
    plant = bench({"angle_lift": 1000.0})
    before, given = plant.energy(), 0.0
    for _ in range(3000):
        last = plant.now()[f"current_{axis}"]
        now = plant.runs(0.0001, **{axis: 12.0})
        given += 12.0 * 0.5 * (last + now[f"current_{axis}"]) * 1e-4
    assert 0.0 < plant.energy() - before < given
