"""Outputs that are only looked at: right whenever they are read, and never paid for in a step."""

import pytest

from emulators.devices import needs_of
from emulators.robot_plant import plant_named
from firmware_bridge.robot_types import find
from fmu.build import ensure
from fmu.export.blocks import ModelCode
from fmu.plant import FmuPlant, PlantError
from hil_tests.rows import every

MODEL = "rome_arm"
SHOWN = ("tool_x", "load_one", "angle_j1", "energy", "speed_j2")


def plant(fmi: int) -> FmuPlant:
    found = FmuPlant(
        ensure(MODEL, fmi), ("voltage_one", "current_on"), ("current_one", "angle_j1"), shown=SHOWN
    )
    found.inputs[0], found.inputs[1] = 9.0, 1.0
    return found


@every("fmi", [2, 3])
def test_a_look_gives_what_a_reading_of_each_gives_at_every_instant(fmi: int) -> None:
    with plant(fmi) as one:
        assert one.shown_names == ("tool_x", "load_one", "energy", "speed_j2"), "others come with a step"
        saved, seen = one.save_state(), []
        for _ in range(20):
            seen.append(tuple(one.look()))
            assert seen[-1] == tuple(map(one.read, one.shown_names))
            one.step()
        assert len(set(seen)) == len(seen)
        one.restore_state(saved)
        assert tuple(one.look()) == seen[0]


def test_a_look_leaves_the_run_as_it_is() -> None:
    with plant(3) as looked_at, plant(3) as alone:
        for _ in range(20):
            looked_at.look()
            looked_at.step()
            alone.step()
            assert looked_at.outputs[:] == alone.outputs[:]


def test_a_closed_plant_has_nothing_to_look_at() -> None:
    one = plant(3)
    one.close()
    with pytest.raises(PlantError, match="the plant is closed"):
        one.look()


@every("name", ["rars", "diff_drive", "rome", "climber", "rome_arm"])
def test_no_device_needs_in_each_step_what_costs_as_much_as_the_step(name: str) -> None:
    robot = find(name)
    program = ModelCode(plant_named(robot).model())
    derived = {row.name for row in program.outputs[program.prompt :]}
    assert not derived & {name for need in needs_of(robot) for name in need.outputs}
