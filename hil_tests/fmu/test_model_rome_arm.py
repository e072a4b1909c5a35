"""Base and arm in one plant: mass and momentum by other ways, energy, what the wheels carry."""

import math
from collections.abc import Iterator

import numpy as np
import pytest

from emulators.arduino_omni.ar2.gravity import LINKS, weight
from firmware_bridge.motion.chain import Matrix
from firmware_bridge.motion.omni import ANGLES
from firmware_bridge.robot_types import find
from firmware_bridge.robots.ar2.arm import AR2
from firmware_bridge.robots.rome_arm.balance import balance
from fmu.ar2.parameters import AXES, JOINTS
from fmu.rome_arm.equations import model
from fmu.rome_arm.parameters import PARAMETERS, SETS
from fmu.rome_base.parameters import AXES as WHEELS
from hil_tests.fmu.model_bench import ModelBench

MODEL = model()
P = {row.name: row.start for row in PARAMETERS}
MASSES = [link[4] for link in LINKS]
FREE = {**SETS["free"], "resistance_wheel": 0.0, "torque_constant_wheel": 0.0}
"""Nothing rubs, and no motor brakes."""
BENT = (20.0, -70.0, 80.0, 40.0, 50.0, -20.0)
WAYS = 3
STEP = 1e-6
SPEEDS = dict(zip(AXES, (0.6, -0.4, 0.5, 1.0, -0.8, 1.5), strict=True))


def at(degrees: tuple[float, ...]) -> dict[str, float]:
    return {f"rest_{axis}": math.radians(it) for axis, it in zip(AXES, degrees, strict=True)}


def middles(angles: Matrix) -> Matrix:
    """Return the places of the links' masses, in the base's frame, by the bridge's kinematics."""
    places = np.array([frame[:3, 3] for frame in AR2.frames(angles)])
    between: Matrix = (places[1:] + places[:-1]) / 2.0
    return between


def jacobians(angles: Matrix) -> Iterator[Matrix]:
    """Yield for each mass how it moves with the base's three ways and the six joints, by differences."""
    turned = [(middles(angles + STEP * it) - middles(angles - STEP * it)) / (2.0 * STEP) for it in np.eye(6)]
    for place, point in enumerate(middles(angles)):
        round_about = np.array([-point[1], point[0], 0.0])
        joints = [it[place] for it in turned]
        yield np.array([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), round_about, *joints]).T


def inertia(angles: Matrix, rim_mass: float) -> Matrix:
    found: Matrix = sum(mass * it.T @ it for mass, it in zip(MASSES, jacobians(angles), strict=True))  # type: ignore[assignment] # a sum of matrices
    around = 3.0 * P["wheel_distance"] ** 2 * rim_mass
    own = (P["mass"] + 1.5 * rim_mass, P["mass"] + 1.5 * rim_mass, P["yaw_inertia"] + around)
    rotors = [joint.rotor * joint.gear**2 for joint in JOINTS]
    return found + np.diag([*own, *rotors])


def test_let_go_the_arm_falls_and_pushes_the_base_as_mass_and_weight_say() -> None:
    angles = np.radians(BENT)
    rim_mass = (P["wheel_inertia"] + P["rotor_inertia_wheel"] * P["gear_wheel"] ** 2) / P["wheel_radius"] ** 2
    pulls = np.array([0.0, 0.0, 0.0, *(-it for it in weight(BENT))])
    meant = np.linalg.solve(inertia(angles, rim_mass), pulls)
    with ModelBench(MODEL, {**FREE, **at(BENT)}) as bench:
        now = bench.runs(1e-3)
    rates = [now[name] / 1e-3 for name in ("speed", "speed_sideways", "yaw_rate")]
    assert rates == pytest.approx(meant[:WAYS], rel=2e-3, abs=1e-3)
    assert abs(meant[0]) > 0.01, "the base is pushed"
    rates = [now[f"speed_{axis}"] / 1e-3 for axis in AXES]
    assert rates == pytest.approx(meant[WAYS:], rel=2e-3, abs=1e-3)


def moving() -> dict[str, float]:
    start = {**FREE, **at(BENT), "rotor_inertia_wheel": 1e-9, "wheel_inertia": 0.0, "gravity": 0.0}
    start |= {f"speed_{axis}": speed for axis, speed in SPEEDS.items()}
    return start | {f"speed_{wheel}": 40.0 * it for wheel, it in zip(WHEELS, (1.0, -2.0, 2.5), strict=True)}


def momentum(now: dict[str, float]) -> tuple[float, float, float]:
    """Return the momentum in the world, kg m/s, and about its origin, kg m2/s, of wheels without mass."""
    angles = np.array([now[f"angle_{axis}"] for axis in AXES])
    speeds = np.array(
        [now["speed"], now["speed_sideways"], now["yaw_rate"], *(now[f"speed_{axis}"] for axis in AXES)]
    )
    sine, cosine = math.sin(now["heading"]), math.cos(now["heading"])
    turn = np.array([[cosine, -sine], [sine, cosine]])
    here = np.array([now["x"], now["y"]])
    rows = [(P["mass"], np.zeros(2), speeds[:2])]
    rows += [
        (mass, place[:2], (it @ speeds)[:2])
        for mass, place, it in zip(MASSES, middles(angles), jacobians(angles), strict=True)
    ]
    linear, about = np.zeros(2), P["yaw_inertia"] * now["yaw_rate"]
    for mass, place, velocity in rows:
        away, moves = here + turn @ place, turn @ velocity
        linear += mass * moves
        about += mass * float(away[0] * moves[1] - away[1] * moves[0])
    return float(linear[0]), float(linear[1]), about


def test_without_a_push_from_outside_the_momentum_stays_while_everything_moves() -> None:
    """Joints turn rotors, whose own turning the model leaves to the gears: they take no part in it."""
    with ModelBench(MODEL, moving()) as bench:
        first = momentum(bench.now())
        begun = bench.energy()
        now = bench.runs(0.3)
        assert momentum(now) == pytest.approx(first, abs=2e-5)
        assert bench.energy() == pytest.approx(begun, abs=1e-7)
    assert abs(now["yaw_rate"]) > 0.1
    assert max(abs(it) for it in first) > 0.1


def test_with_weight_and_wheels_its_energy_stays_too() -> None:
    start = {**FREE, **at(BENT)} | {f"speed_{axis}": speed for axis, speed in SPEEDS.items()}
    start |= {f"speed_{wheel}": 60.0 * it for wheel, it in zip(WHEELS, (1.0, -2.0, 2.5), strict=True)}
    with ModelBench(MODEL, start) as bench:
        first = bench.energy()
        bench.runs(0.2)
        assert bench.energy() == pytest.approx(first, abs=1e-7)


@pytest.mark.parametrize(
    "degrees", [(0.0, -90.0, 90.0, 0.0, 60.0, 0.0), (60.0, -60.0, 60.0, 20.0, 30.0, 0.0)]
)
def test_at_rest_the_wheels_carry_what_the_bridge_works_out(degrees: tuple[float, ...]) -> None:
    with ModelBench(MODEL, {**SETS["kit"], **at(degrees)}) as bench:
        now = bench.runs(1.5, current_on=1.0)
    angles = tuple(now[f"angle_{axis}"] for axis in AXES)
    loads = [now[f"load_{wheel}"] for wheel in WHEELS]
    whole = (P["mass"] + sum(MASSES)) * P["gravity"]
    assert sum(loads) == pytest.approx(whole, rel=1e-4)
    seen = balance(find("rome_arm").geometry, angles)
    distance = SETS["kit"]["wheel_distance"]
    for load, angle in zip(loads, ANGLES, strict=True):
        share = (seen.x_m * math.cos(angle) + seen.y_m * math.sin(angle)) / distance
        assert load == pytest.approx(whole * (1.0 + 2.0 * share) / 3.0, abs=0.05)


def test_where_the_base_speeds_up_the_load_goes_back_by_the_height_of_its_mass() -> None:
    degrees = (0.0, -90.0, 90.0, 0.0, 60.0, 0.0)
    with ModelBench(MODEL, {**SETS["kit"], **at(degrees), "inductance_wheel": 1e-3}) as bench:
        bench.runs(1.0, current_on=1.0)
        rows = [bench.runs(1e-3, two=-3.0, three=3.0, current_on=1.0) for _ in range(120)]
    gained = (rows[-1]["speed"] - rows[20]["speed"]) / (1e-3 * (len(rows) - 21))
    ahead = float(np.mean([row["load_one"] for row in rows[20:]]))
    whole = (P["mass"] + sum(MASSES)) * P["gravity"]
    seen = balance(find("rome_arm").geometry, tuple(map(math.radians, degrees)))
    place = seen.x_m - gained * seen.height_m / P["gravity"]
    assert gained > 0.3
    assert ahead == pytest.approx(whole * (1.0 + 2.0 * place / SETS["kit"]["wheel_distance"]) / 3.0, rel=0.1)
