"""The climbing robot's forces: weight at the contacts, magnets that let go, slip, stops, coupled wheels."""

import math
from collections.abc import Mapping
from typing import Any, Self

import numpy as np
import pytest

from fmu.build import ensure
from fmu.climber.parameters import SETS
from fmu.plant import FmuPlant
from hil_tests.fmu.climber_rolled import NUMBERS
from validation.climber.constraints import Robot

WHEELS = ("left", "right", "caster")
CONTACTS = tuple(f"{what}_{side}" for side in WHEELS for what in ("tube", "arc", "height", "psi"))
READ = (
    *CONTACTS,
    "swivel",
    "arc",
    "height",
    "heading",
    "speed",
    "joint",
    "pitch",
    "fallen",
    "fall",
    "angle_left",
    "angle_right",
)
FREE = {"gear_friction": 0.0, "coulomb_wheel": 0.0, "viscous_wheel": 0.0, "torque_constant_wheel": 0.0}
CEILING = {"axis_tilt": 0.0, "start_arc": math.pi * NUMBERS["tank_radius"], "start_heading": 0.0}
"""Start below a tank that lies: all of the weight pulls it off."""


class Bench:
    """The FMU in co-simulation."""

    def __init__(self, parameters: Mapping[str, float], step: int = 100_000) -> None:
        inputs = ("voltage_left", "voltage_right")
        self.plant = FmuPlant(ensure("climber", 3), inputs, READ, parameters, step)
        self._in_second = 1_000_000_000 // step

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.plant.close()

    def runs(self, seconds: float, left: float = 0.0, right: float = 0.0) -> dict[str, float]:
        self.plant.inputs[0], self.plant.inputs[1] = left, right
        for _ in range(round(seconds * self._in_second)):
            self.plant.step()
        return dict(zip(READ, self.plant.outputs, strict=True))

    def reads(self, *names: str) -> list[float]:
        return [self.plant.read(name) for name in names]


@pytest.mark.parametrize("heading", [math.pi / 2, math.pi / 4, -2.0])
@pytest.mark.parametrize("tilt", [math.pi / 2, 0.3])
@pytest.mark.parametrize("side", [1.0, -1.0], ids=["joint left", "joint right"])
def test_forces_at_the_contacts_are_those_of_virtual_work(heading: float, tilt: float, side: float) -> None:
    given = {"axis_tilt": tilt, "start_heading": heading, "start_joint": 0.05, "joint_side": side}
    p = {**NUMBERS, **given}
    with Bench(given) as bench:
        read = {wheel: bench.reads(f"pull_{wheel}", f"across_{wheel}") for wheel in WHEELS}
    robot = Robot.standing(p, heading, 0.0, 0.05)
    weight = -p["mass"] * p["gravity"] * np.array([math.cos(tilt), 0.0, math.sin(tilt)])
    place = np.array([-p["mass_behind"], 0.0, p["mass_height"] - p["wheel_radius"]])
    forces = robot.forces(weight, place, -p["joint_spring"] * robot.joint)
    assert forces.sum(axis=0) == pytest.approx(-weight, abs=1e-9)
    for wheel, force, each in zip(WHEELS, forces, robot.touches(), strict=True):
        pull = -float(force @ each.normal)
        across = float(np.linalg.norm(force + pull * each.normal))
        assert read[wheel] == pytest.approx([pull, across], abs=2e-3), wheel


def test_at_rest_on_the_wall_nothing_creeps() -> None:
    with Bench({}) as bench:
        settled = bench.runs(0.6)
        assert abs(settled["height"]) < 5e-4
        assert bench.runs(0.6) == pytest.approx(settled, rel=0, abs=1e-10)


@pytest.mark.parametrize(("share", "falls"), [(1.02, False), (0.98, True)])
@pytest.mark.parametrize("side", ["wheel", "caster"])
def test_a_magnet_holds_up_to_its_pull_off_force(side: str, share: float, falls: bool) -> None:  # noqa: FBT001
    with Bench(CEILING) as bench:
        pulls = bench.reads(*(f"pull_{each}" for each in WHEELS))
        assert sum(pulls) == pytest.approx(NUMBERS["mass"] * NUMBERS["gravity"], rel=0.01)
    pull = max(pulls[:2]) if side == "wheel" else pulls[2]
    firm = {"slip_damping": 1e9}
    with Bench({**CEILING, **firm, f"magnet_{side}": share * pull}) as bench:
        assert bench.runs(0.0)["fallen"] == 0.0
        now = bench.runs(0.6)
        later = bench.runs(0.3)
    assert now["fallen"] == later["fallen"] == float(falls)
    if falls:
        # Free fall, and the place where it left the wall stays reported.
        root = math.sqrt(2 / NUMBERS["gravity"])
        fallen_for = root * (math.sqrt(later["fall"]) - math.sqrt(now["fall"]))
        assert fallen_for == pytest.approx(0.3, abs=1e-6)
        assert later["arc"] == now["arc"]
    else:
        assert later["fall"] == 0.0


def test_a_wheel_that_has_fallen_turns_alone() -> None:
    """And no voltage brings the robot back."""
    with Bench({**CEILING, "magnet_wheel": 0.0}) as bench:
        bench.runs(0.2)
        before = bench.runs(0.1)
        after = bench.runs(0.3, 6.0, 6.0)
    assert after["angle_left"] > before["angle_left"] + 20.0
    assert after["arc"] == before["arc"]
    assert after["fallen"] == 1.0


@pytest.mark.parametrize(("share", "slides"), [(1.02, False), (0.98, True)])
def test_it_slides_where_friction_does_not_hold_its_weight(share: float, slides: bool) -> None:  # noqa: FBT001
    around = {"axis_tilt": math.pi / 2, "start_heading": 0.0}
    with Bench(around) as bench:
        pairs = [bench.reads(f"across_{side}", f"load_{side}") for side in WHEELS]
    needed = max(across / load for across, load in pairs)
    with Bench({**around, "wall_friction": share * needed}) as bench:
        start = bench.runs(0.0)["height"]
        sliding = max(bench.reads(*(f"slide_{side}" for side in WHEELS)))
        moved = bench.runs(0.3)["height"] - start
    assert (sliding > 1e-4) == slides
    assert (moved < -1e-4) == slides


@pytest.mark.long(keeps=["joint left-0.7853981633974483", "joint right-2.356194490192345"])
@pytest.mark.parametrize("heading", [math.pi / 2, math.pi / 4, 3 * math.pi / 4])
@pytest.mark.parametrize("side", [1.0, -1.0], ids=["joint left", "joint right"])
def test_the_joint_meets_its_stop_and_goes_no_further(heading: float, side: float) -> None:
    """The caster trailing, it runs away; then wheels slide, and the stop holds it."""
    with Bench({"start_heading": heading, "start_joint": 0.15, "joint_side": side}) as bench:
        most = [bench.runs(0.25, 8.0, 8.0)["joint"] for _ in range(12)]
        now = bench.runs(0.0)
        assert now["fallen"] == 0.0
        assert max(bench.reads(*(f"slide_{wheel}" for wheel in WHEELS))) > 0.0
    # A sliding robot stays joined: the chassis's wheel, joint and swivel give the other wheels' contacts.
    robot = Robot.placed({**NUMBERS, "joint_side": side}, now)
    assert [each.gap for each in robot.touches()] == pytest.approx([0.0] * 3, abs=1e-7)
    for name, value in robot.readings().items():
        assert math.remainder(now[name] - value, 2 * math.pi) == pytest.approx(0.0, abs=1e-6), name
    stop = NUMBERS["joint_stop"]
    assert stop < max(most) < stop + math.radians(0.5)


def test_coupled_wheels_turn_as_one_and_cannot_steer() -> None:
    flat = {**SETS["plane"], "coupled": 1.0, "gravity": 0.0}
    with Bench(flat) as bench:
        before = bench.runs(0.0)
        now = bench.runs(1.0, 16.0, 8.0)
    assert now["angle_left"] == now["angle_right"] > 50.0
    assert now["heading"] == pytest.approx(before["heading"], abs=1e-6)


def test_without_friction_the_weight_drives_it_down() -> None:
    """On a wall that is all but a plane: mass and rotors under the weight."""
    with Bench({**FREE, **SETS["plane"], "start_heading": math.pi / 2, "gear_friction": 0.0}) as bench:
        now = bench.runs(0.3)
    p = {**NUMBERS, **SETS["plane"]}
    rotor = p["wheel_inertia"] + p["rotor_inertia_wheel"] * p["gear_wheel"] ** 2
    total = p["mass"] + 2 * rotor / p["wheel_radius"] ** 2
    assert now["speed"] == pytest.approx(-0.3 * 9.81 * p["mass"] / total, rel=1e-6)


@pytest.mark.parametrize(
    "more", [{}, {"axis_tilt": 0.3}, {"ring_radius": 0.0, "tank_radius": 1.0}, {"joint_side": -1.0}]
)
def test_without_losses_energy_stays(more: dict[str, float]) -> None:
    free = {**FREE, "resistance_wheel": 0.0, "joint_damping": 0.0, "start_heading": 0.8}
    moving = {"speed_left": 150.0, "speed_right": 300.0}
    with Bench({**free, **moving, **more}, 1_000_000) as bench:
        before = bench.plant.read("energy")
        energies = [bench.runs(0.05) and bench.plant.read("energy") for _ in range(8)]
        assert abs(bench.runs(0.0)["heading"] - 0.8) > 0.1
        assert bench.reads(*(f"slide_{side}" for side in WHEELS)) == [0.0] * 3
    assert energies == pytest.approx([before] * 8, rel=1e-8)


@pytest.mark.long(keeps=["0"])
@pytest.mark.parametrize("seed", range(3))
def test_energy_never_grows(seed: int) -> None:
    """In sliding, in a fall, and at a stop."""
    draw = np.random.default_rng(seed).uniform
    given: dict[str, Any] = {f"speed_{axis}": draw(-300, 300) for axis in ("left", "right")}
    given |= {"axis_tilt": draw(-1.5, 1.5), "start_heading": draw(-3, 3), "wall_friction": draw(0.05, 0.5)}
    given |= {"start_arc": draw(-1, 1), "magnet_wheel": draw(5, 60)}
    with Bench(given) as bench:
        before = bench.plant.read("energy")
        for _ in range(1500):
            bench.plant.step()
            after = bench.plant.read("energy")
            assert after <= before + 1e-9 * (1.0 + abs(before))
            before = after
