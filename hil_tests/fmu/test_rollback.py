"""Saved states: going back replays the same bits, across instances and as bytes; other bytes are refused."""

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from fmu.rars.interface import INPUTS, OUTPUTS
from hil_tests.fmu.instance import VERSIONS, Instance, Maker

READ = (*OUTPUTS, "energy", "friction_lift", "time")


def drive(plant: Instance, first: int, count: int) -> list[list[float]]:
    """Step with voltages that depend on the step alone; return what every step read."""
    rows = []
    for step in range(first, first + count):
        generator = np.random.default_rng(step // 10)
        plant.write(**dict(zip(INPUTS, map(float, generator.uniform(-24, 24, 4)), strict=True)))
        plant.step(step * 1e-4)
        rows.append(plant.read(*READ))
    return rows


@VERSIONS
def test_going_back_to_any_instant_replays_the_same_bits(made: Maker, fmi: int) -> None:
    plant, other = made(fmi), made(fmi)
    plant.initialize()
    other.initialize()
    states, straight = [], []
    for step in range(300):
        if step % 10 == 0:
            states.append(plant.save())
        straight += drive(plant, step, 1)
    for index in np.random.default_rng(1).permutation(len(states)):
        first = 10 * int(index)
        plant.restore(states[index])
        assert drive(plant, first, 10) == straight[first : first + 10]
        # As bytes, and into an instance that was never there.
        other.restore(again := other.from_bytes(plant.to_bytes(states[index])))
        assert drive(other, first, 5) == straight[first : first + 5]
        other.release(again)
    for state in states:
        plant.release(state)


@VERSIONS
@pytest.mark.parametrize("kind", ["slave", "model"])
def test_a_state_carries_the_phase_and_the_parameters(made: Maker, fmi: int, kind: str) -> None:
    plant = made(fmi, kind)
    new = plant.save()
    plant.write(platform_mass=20.0)
    plant.initialize()
    running = plant.save()
    plant.restore(new)
    assert plant.read("platform_mass") == [70.0]
    plant.initialize()
    plant.restore(running)
    assert plant.read("platform_mass") == [20.0]
    if kind == "model":
        assert plant.rates()
    else:
        plant.step(0.0)
    for state in (new, running):
        plant.release(state)


@VERSIONS
def test_a_state_brings_a_failed_plant_back(made: Maker, fmi: int) -> None:
    plant = made(fmi)
    plant.initialize()
    state = plant.save()
    with pytest.raises(FMICallException):
        plant.step(5.0)
    plant.restore(state)
    plant.step(0.0)
    plant.release(state)


@VERSIONS
def test_bytes_of_another_kind_are_refused(made: Maker, fmi: int) -> None:
    plant, model, other = made(fmi), made(fmi, "model"), made(5 - fmi)
    state = plant.save()
    good = plant.to_bytes(state)
    for wrong in (b"", good[:-1], good + b"\0", b"{other" + good[6:]):
        with pytest.raises(FMICallException):
            plant.from_bytes(wrong)
        assert "no saved state of this model and version" in plant.logged[-1][2]
    # The other version of FMI is the same model: it may go on from there.
    other.restore(there := other.from_bytes(good))
    other.initialize()
    other.release(there)
    with pytest.raises(FMICallException):
        model.restore(taken := model.from_bytes(good))
    assert "by an instance of the other interface" in model.logged[-1][2]
    model.release(taken)
    model.initialize()
    plant.release(state)
