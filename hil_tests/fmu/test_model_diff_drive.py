"""The diff_drive robot's plant, as a third party would write it: made of parts, held to closed forms."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace

import diff_drive.plant
import numpy as np
import pytest
from diff_drive.plant import reference
from diff_drive.plant.parameters import LEFT, PARAMETERS, PLANT, RIGHT, SETS
from fmpy.validation import validate_fmu

from fmu.build import ensure
from fmu.interface import inputs, outputs, units
from fmu.plant import FmuPlant
from fmu.verify import ComparisonResult

P = {row.name: row.start for row in PARAMETERS}
MASS = P["body_mass"] + 2 * P["wheel_mass"]
CASTOR_LOAD = 9.81 * P["body_mass"] * P["centre_offset"] / P["castor_ahead"] / 2
WHEEL_LOAD = 9.81 * MASS / 2 - CASTOR_LOAD
AXES = (LEFT, RIGHT)
REQUESTED = (*outputs(AXES), "x", "y", "heading", "speed", "yaw_rate", "battery_voltage")


class Bench:
    """The plant with its outputs by name."""

    def __init__(self, parameters: Mapping[str, float] = {}) -> None:
        self.plant = FmuPlant(ensure(PLANT), list(inputs(AXES)), REQUESTED, parameters, units=units(AXES))

    def runs(self, seconds: float, left: float = 0.0, right: float = 0.0) -> dict[str, float]:
        self.plant.inputs[:] = [left, right]
        for _ in range(round(seconds * 10_000)):
            self.plant.step()
        return dict(zip(REQUESTED, self.plant.outputs, strict=True))


@pytest.fixture
def bench() -> Iterator[Bench]:
    one = Bench()
    yield one
    one.plant.close()


def resisted(axis: str) -> float:
    """Return what holds one motor back in straight motion, in N.m at the motor, without viscous friction."""
    floor = P["rolling_resistance"] * WHEEL_LOAD + P["castor_resistance"] * CASTOR_LOAD
    return P[f"coulomb_{axis}"] + floor * P["wheel_radius"] / P[f"gear_{axis}"]


def steady(voltage: float, push: float = 0.0) -> float:
    """Return the shaft's steady speed: k (V - k w) / R = d w + what resists - what pushes."""
    k, resistance = P["torque_constant_left"], P["resistance_left"]
    torque = k * voltage / resistance - resisted("left") + push
    return torque / (k**2 / resistance + P["viscous_left"])


@pytest.mark.long(keeps=["3"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_it_is_built_for_both_versions_and_gives_its_bits(fmi: int) -> None:
    path = ensure(PLANT, fmi)
    assert validate_fmu(str(path)) == []
    with FmuPlant(path, list(inputs(AXES)), REQUESTED, units=units(AXES)) as plant:
        assert plant.fingerprint is ComparisonResult.SAME
        reported = {name for name, variable in plant.variables.items() if variable.causality == "output"}
    assert reported == set(REQUESTED)


def test_the_reference_trajectory_holds_in_both_versions() -> None:
    written = np.loadtxt(reference.FILE, delimiter=",", skiprows=1)
    second, third = (reference.rows(ensure(PLANT, fmi)) for fmi in (2, 3))
    assert second == third
    assert np.array(third) == pytest.approx(written, rel=1e-7, abs=1e-9)


def test_readme_sources_and_sets_are_whole() -> None:
    text = (Path(diff_drive.plant.__file__).parent / "README.md").read_text(encoding="utf-8")
    model = PLANT.model()
    for name in (*(row.name for row in model.inputs), *(row.name for row in model.outputs)):
        families = (name, f"{name.rpartition('_')[0]}_*", f"{name.split('_wheel_')[0]}_*")
        assert any(f"`{family}`" in text for family in families), name
    assert all("assumed" in row.source for row in PARAMETERS)
    assert all(set(values) <= set(P) for values in SETS.values())


def test_straight_on_it_is_as_fast_as_motors_and_floor_allow(bench: Bench) -> None:
    now = bench.runs(2.0, 12.0, 12.0)
    assert now["speed_left"] == pytest.approx(steady(12.0), rel=1e-3)
    rolled = P["wheel_radius"] * now["speed_left"] / P["gear_left"]
    slip = bench.plant.read("slip_ahead_wheel_left")
    assert 0.0 < slip < 0.01
    assert now["speed"] == pytest.approx(rolled * (1 - slip), rel=1e-6)
    assert (now["y"], now["heading"]) == pytest.approx((0.0, 0.0), abs=1e-12)


def test_downhill_with_shorted_motors_it_rolls_as_fast_as_they_brake() -> None:
    bench = Bench({"slope": 0.05})
    try:
        push = MASS * 9.81 * math.sin(0.05) * P["wheel_radius"] / P["gear_left"] / 2
        assert push > resisted("left"), "steep enough to roll"
        now = bench.runs(4.0)
    finally:
        bench.plant.close()
    # Backwards, and the castors' loads are those of a slope: a part in a thousand.
    assert now["speed_left"] == pytest.approx(-steady(0.0, push), rel=5e-3)


def rolled(bench: Bench, now: Mapping[str, float], side: str) -> float:
    """Return how fast a wheel's middle moves: its rim, less the slip of its force, 15 % at the peak."""
    rim = P["wheel_radius"] * now[f"speed_{side}"] / P[f"gear_{side}"]
    grip = P["floor_friction"] * bench.plant.read(f"load_wheel_{side}")
    slip = P["peak_slip"] * bench.plant.read(f"force_ahead_wheel_{side}") / grip
    return rim * (1 - slip) if slip > 0 else rim / (1 + slip)


def test_on_a_circle_wheels_and_their_slip_give_its_radius_and_castors_point_along_theirs(
    bench: Bench,
) -> None:
    now = bench.runs(4.0, 9.0, 15.0)
    left, right = (rolled(bench, now, side) for side in ("left", "right"))
    assert now["yaw_rate"] == pytest.approx((right - left) / P["track"], rel=1e-3)
    assert now["speed"] == pytest.approx((right + left) / 2, rel=1e-3)
    # The center of mass ahead of the axle wants to run straight on; the castors add what they can.
    twist = bench.plant.read("force_ahead_wheel_right") - bench.plant.read("force_ahead_wheel_left")
    wanted = P["body_mass"] * P["centre_offset"] * now["speed"] * now["yaw_rate"]
    castors = P["castor_resistance"] * CASTOR_LOAD + P["swivel_torque"] / P["castor_trail"]
    most = 2 * (castors * math.hypot(P["castor_ahead"], P["castor_track"] / 2) + P["swivel_torque"])
    assert twist * P["track"] / 2 == pytest.approx(wanted, abs=most)
    for side, sign in (("left", 1), ("right", -1)):
        across = sign * P["castor_track"] / 2
        ahead = now["speed"] - now["yaw_rate"] * across
        aside = bench.plant.read("drift") + now["yaw_rate"] * P["castor_ahead"]
        lag = math.asin(now["yaw_rate"] * P["castor_trail"] / math.hypot(ahead, aside))
        wanted = math.atan2(aside, ahead) - lag
        assert bench.plant.read(f"swivel_castor_{side}") == pytest.approx(wanted, abs=1e-6)


def test_backwards_the_castors_turn_over(bench: Bench) -> None:
    bench.runs(0.5, 6.0, 6.5)
    bench.runs(3.0, -8.0, -8.0)
    for side in ("left", "right"):
        assert abs(bench.plant.read(f"swivel_castor_{side}")) == pytest.approx(math.pi, abs=0.05)


def test_the_loads_are_shared_by_moments_and_shifted_by_pulling(bench: Bench) -> None:
    assert bench.plant.read("load_wheel_left") == pytest.approx(WHEEL_LOAD, rel=1e-12)
    bench.runs(0.1, 12.0, 12.0)
    pull = 2 * bench.plant.read("force_ahead_wheel_left")
    shifted = bench.plant.read("load_wheel_left") - WHEEL_LOAD
    # Springs alone count, and forces have their dampers' parts.
    assert shifted == pytest.approx(P["centre_height"] / P["castor_ahead"] / 2 * pull, rel=0.02)
    assert shifted > 0.0


def test_without_voltage_it_only_loses_energy(bench: Bench) -> None:
    bench.runs(0.6, 10.0, -4.0)
    before = bench.plant.read("energy")
    for _ in range(5000):
        bench.runs(1e-4)
        after = bench.plant.read("energy")
        assert after <= before + 1e-12 * (1.0 + before)
        before = after


def test_at_rest_it_stays_at_rest(bench: Bench) -> None:
    still = bench.runs(0.0001)
    assert bench.runs(1.0) == still


def test_the_robot_file_sets_wheels_track_gears_and_battery() -> None:
    robot = SimpleNamespace(
        geometry=SimpleNamespace(base=SimpleNamespace(wheel_radius_m=0.1, track_m=0.5)),
        axes={LEFT: SimpleNamespace(ratio=20.0), RIGHT: SimpleNamespace(ratio=21.0)},
        battery=SimpleNamespace(nominal_v=36.0),
    )
    found = PLANT.parameters_of(robot)
    assert found == {
        "wheel_radius": 0.1,
        "track": 0.5,
        f"gear_{LEFT}": 20.0,
        f"gear_{RIGHT}": 21.0,
        "battery_emf": 36.0,
    }
    bench = Bench(found)
    try:
        now = bench.runs(1.0, -6.0, 6.0)
    finally:
        bench.plant.close()
    rims = 0.1 * (now["speed_right"] / 21.0 - now["speed_left"] / 20.0)
    assert now["yaw_rate"] == pytest.approx(rims / 0.5, rel=1e-2)
