"""The arm on stepper motors: mass and weight by other ways, energy, holding, lost steps, the fall."""

import math
from pathlib import Path

import numpy as np
import pytest

from emulators.arduino_omni.ar2.axes import JOINTS as BOARD
from emulators.arduino_omni.ar2.gravity import LINKS, weight
from firmware_bridge.motion.chain import Matrix
from firmware_bridge.robots.ar2.arm import AR2
from fmu.ar2 import equations
from fmu.ar2.equations import model
from fmu.ar2.parameters import AXES, JOINTS, PARAMETERS, SETS
from hil_tests.fmu.model_bench import ModelBench

MODEL = model()
PAGE = Path(equations.__file__).with_name("README.md").read_text(encoding="utf-8")
P = {row.name: row.start for row in PARAMETERS}
STRETCHED = {"rest_j2": 0.0, "rest_j3": math.radians(2.0), "rest_j5": 0.0}
FIELD = math.tau / 50.0
"""A turn of the field, at the motor."""
HALF_STEP = math.pi / 200.0


def at(degrees: tuple[float, ...]) -> dict[str, float]:
    return {f"rest_{axis}": math.radians(it) for axis, it in zip(AXES, degrees, strict=True)}


def inertia(angles: Matrix) -> Matrix:
    """Return the mass matrix from the bridge's kinematics, by differences of the middles of the links."""

    def middles(turned: Matrix) -> Matrix:
        places = np.array([frame[:3, 3] for frame in AR2.frames(turned)])
        between: Matrix = (places[1:] + places[:-1]) / 2.0
        return between

    step = 1e-6
    moved = np.array([(middles(angles + step * it) - middles(angles - step * it)) for it in np.eye(6)])
    jacobians = moved.transpose(1, 2, 0) / (2.0 * step)
    links: Matrix = sum(link[4] * it.T @ it for link, it in zip(LINKS, jacobians, strict=True))
    return links + np.diag([joint.rotor * joint.gear**2 for joint in JOINTS])


def test_gears_and_places_of_rest_are_the_boards() -> None:
    assert [joint.gear for joint in JOINTS] == pytest.approx([axis.gear for axis in BOARD])
    rest = [math.degrees(joint.rest_rad) for joint in JOINTS]
    assert rest == pytest.approx([axis.angle(axis.rest) for axis in BOARD])
    assert [joint.holding for joint in JOINTS] == [axis.torque_nm for axis in BOARD]
    assert [joint.mass for joint in JOINTS] == [link[4] for link in LINKS]


@pytest.mark.parametrize(
    "degrees", [(20.0, -50.0, 70.0, 40.0, 30.0, -20.0), (-90.0, -10.0, 20.0, -80.0, -60.0, 5.0)]
)
def test_let_go_it_begins_to_fall_as_mass_and_weight_say(degrees: tuple[float, ...]) -> None:
    angles = np.radians(degrees)
    meant = np.linalg.solve(inertia(angles), -np.array(weight(degrees)))
    with ModelBench(MODEL, {**SETS["free"], **at(degrees)}) as bench:
        now = bench.now()
        place = (now["tool_x"], now["tool_y"], now["tool_z"])
        assert place == pytest.approx(AR2.pose(angles)[:3, 3], abs=1e-12)
        now = bench.runs(1e-3)
    rates = [now[f"speed_{axis}"] / 1e-3 for axis in AXES]
    assert rates == pytest.approx(meant, rel=1e-3, abs=1e-3)


def test_its_energy_stays_while_all_joints_swing() -> None:
    speeds = {f"speed_{axis}": it for axis, it in zip(AXES, (1.0, -0.5, 0.8, 2.0, -1.0, 3.0), strict=True)}
    start = {**SETS["free"], **SETS["loaded"], **at((0.0, -100.0, 60.0, 10.0, 20.0, 0.0)), **speeds}
    with ModelBench(MODEL, start) as bench:
        first = bench.energy()
        now = bench.runs(0.2)
        assert bench.energy() == pytest.approx(first, abs=1e-9)
        before = bench.energy()
        for _ in range(20):  # one joint after the other meets its stop, and loses some of it
            now = bench.runs(0.01)
            assert bench.energy() <= before + 1e-6
            before = bench.energy()
        assert before < first - 1.0
    assert now["angle_j3"] > JOINTS[2].most * math.pi / 180.0


def test_stretched_out_it_hangs_on_its_fields_by_the_lag_that_its_weight_needs() -> None:
    with ModelBench(MODEL, {**STRETCHED, "friction": 0.0}) as bench:
        now = bench.runs(2.0, current_on=1.0)
    angles = [math.degrees(now[f"angle_{axis}"]) for axis in AXES]
    for axis, joint, load in zip(AXES, JOINTS, weight(angles), strict=True):
        needed = math.asin(load / (0.7 * joint.gear * joint.holding)) / 50.0
        assert now[f"lag_{axis}"] == pytest.approx(needed, abs=2e-5)


def driven(bench: ModelBench, full_steps_per_s: float, half_steps: int) -> dict[str, float]:
    """Turn the first joint's field by half steps at a rate, and let it come to rest."""
    ticks = round(half_steps / (2.0 * full_steps_per_s) / 1e-4)
    for tick in range(1, ticks + 1):
        now = bench.runs(1e-4, field_j1=tick * half_steps // ticks * HALF_STEP, current_on=1.0)
    return bench.runs(0.3, field_j1=half_steps * HALF_STEP, current_on=1.0) if ticks else now


def test_slowly_every_step_is_done_and_at_once_too_fast_whole_turns_of_the_field_are_lost() -> None:
    with ModelBench(MODEL, at((0.0, -90.0, 60.0, 0.0, 0.0, 0.0))) as bench:
        slow = driven(bench, 150.0, 100)
    assert slow["lag_j1"] == pytest.approx(0.0, abs=HALF_STEP / 4.0)
    assert slow["angle_j1"] == pytest.approx(100 * HALF_STEP / JOINTS[0].gear, abs=1e-4)
    with ModelBench(MODEL, at((0.0, -90.0, 60.0, 0.0, 0.0, 0.0))) as bench:
        fast = driven(bench, 2_500.0, 400)
    lost = fast["lag_j1"] / FIELD
    assert lost > 30.0
    assert lost == pytest.approx(round(lost), abs=0.1)


def test_without_current_it_falls_to_its_stop_and_stays_there() -> None:
    with ModelBench(MODEL, at((0.0, -40.0, 60.0, 0.0, 0.0, 0.0))) as bench:
        held = bench.runs(0.2, current_on=1.0)
        assert held["angle_j2"] == pytest.approx(math.radians(-40.0), abs=1e-3)
        fallen = bench.runs(1.5, current_on=0.0)
        energy = bench.energy()
        later = bench.runs(0.3, current_on=0.0)
        assert bench.energy() <= energy + 1e-9
    assert fallen["tool_z"] < held["tool_z"] - 0.1
    assert later["angle_j2"] == pytest.approx(P["stop_high_j2"], abs=0.02)


@pytest.mark.parametrize(
    ("degrees", "after"),
    [
        ((0.0, -90.0, 90.0, 0.0, 60.0, 0.0), ((0.1, 13), (0.3, 54), (1.0, 148))),
        ((0.0, -45.0, 45.0, 0.0, 0.0, 0.0), ((0.1, 27), (0.3, 172), (1.0, 455))),
        ((0.0, -30.0, 60.0, 0.0, 0.0, 0.0), ((0.1, 32), (0.3, 173), (1.0, 268))),
    ],
)
def test_it_falls_as_its_page_states(
    degrees: tuple[float, ...], after: tuple[tuple[float, int], ...]
) -> None:
    with ModelBench(MODEL, at(degrees)) as bench:
        begin, seconds = bench.now()["tool_z"], 0.0
        for until, millimeters in after:
            now = bench.runs(until - seconds, current_on=0.0)
            seconds = until
            assert 1000.0 * (begin - now["tool_z"]) == pytest.approx(millimeters, abs=1.5)
            assert f" {millimeters} mm" in PAGE
