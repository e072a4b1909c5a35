"""A plant goes back to its own states, and reports clearly when it cannot."""

import gc
from collections.abc import Callable
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import pytest

from emulators.devices import devices
from emulators.epos2.drive import Epos2
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.node import CAN
from firmware_bridge.robot_types import find
from fmu.plant import PlantError
from fmu.rars.interface import INPUTS
from hil_tests.fmu.conftest import Bench, PlantMaker

VERSIONS = pytest.mark.parametrize("fmi", [2, 3])


def rows(bench: Bench, count: int) -> list[tuple[float, ...]]:
    """Step with voltages that depend on the plant's own count of steps."""
    found = []
    for _ in range(count):
        for place in range(len(INPUTS)):
            bench.plant.inputs[place] = float((bench.plant.steps_done * (7 + place)) % 24)
        bench.plant.step()
        found.append((*bench.plant.outputs[:], bench.energy()))
    return found


@VERSIONS
def test_from_each_state_the_plant_goes_on_as_it_went(bench: PlantMaker, fmi: int) -> None:
    plant = bench(fmi=fmi)
    states, straight = [], []
    for _ in range(20):
        states.append(plant.plant.save_state())
        straight.append(rows(plant, 13))
    for place in (19, 0, 7, 7, 12, 3):
        plant.plant.restore_state(states[place])
        assert plant.plant.steps_done == 13 * place
        assert rows(plant, 13) == straight[place]


@VERSIONS
def test_inputs_and_outputs_go_back_in_their_arrays(bench: PlantMaker, fmi: int) -> None:
    plant = bench(fmi=fmi).plant
    inputs, outputs = plant.inputs, plant.outputs
    plant.inputs[0] = 3.0
    plant.step()
    before, state = outputs[:], plant.save_state()
    plant.inputs[0] = -9.0
    for _ in range(50):
        plant.step()
    assert outputs[:] != before
    plant.restore_state(state)
    assert plant.inputs is inputs
    assert (inputs[0], outputs[:]) == (3.0, before)


@VERSIONS
def test_states_die_with_their_objects_or_with_the_plant(bench: PlantMaker, fmi: int) -> None:
    plant = bench(fmi=fmi).plant
    kept = plant.save_state()
    for _ in range(2000):
        plant.save_state()
    gc.collect()
    assert plant._vault is not None  # noqa: SLF001 - what is not freed shows nowhere else
    assert len(plant._vault._copies) == 1  # noqa: SLF001
    plant.close()
    with pytest.raises(PlantError, match="closed"):
        plant.restore_state(kept)
    with pytest.raises(PlantError, match="closed"):
        plant.save_state()


def test_a_state_of_another_plant_is_refused(bench: PlantMaker) -> None:
    one, other = bench().plant, bench().plant
    with pytest.raises(PlantError, match="saved by another plant"):
        one.restore_state(other.save_state())


@pytest.fixture
def incapable(fmu_file: dict[int, Path], tmp_path: Path) -> Callable[[int], Path]:
    """Our own FMU, which denies that it can save its state."""

    def make(fmi: int) -> Path:
        target = tmp_path / f"incapable{fmi}.fmu"
        with ZipFile(fmu_file[fmi]) as source, ZipFile(target, "w", ZIP_DEFLATED) as archive:
            for entry in source.infolist():
                content = source.read(entry)
                if entry.filename == "modelDescription.xml":
                    for name in (b"canGetAndSetFMUstate", b"canGetAndSetFMUState", b"canSerializeFMUstate"):
                        content = content.replace(name + b'="true"', name + b'="false"')
                    content = content.replace(b'canSerializeFMUState="true"', b'canSerializeFMUState="false"')
                archive.writestr(entry, content)
        return target

    return make


@VERSIONS
def test_a_plant_that_cannot_save_its_state_runs_but_is_not_rewound(
    incapable: Callable[[int], Path], fmi: int
) -> None:
    found = devices(find("rars"), incapable(fmi))
    world, wire = World(found.physics), CanWire(1_000_000)
    for name, drive in found.nodes(Epos2).items():
        world.attach(name, drive, {CAN: wire})
    world.run(5_000_000)
    assert found.plant.steps_done == 50
    with pytest.raises(PlantError, match=rf"incapable{fmi}\.fmu.*cannot be rewound.*canGetAndSetFMUState"):
        world.snapshot()
    world.run(6_000_000)
    assert found.plant.steps_done == 60
    found.plant.close()
