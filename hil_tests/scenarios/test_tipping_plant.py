"""The plant that can tip over behind RARS's emulated drives: chosen by the robot file, moved as it drives."""

import math
from typing import Final

import pytest

from emulators.robot_plant import plant_of, plant_parameters
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find, parse, robots
from fmu.rars_tipping.interface import STANDING
from hil_tests.scenarios.ride import ARMED, Ridden, step

TEXT: Final = robots()["rars"].read_text(encoding="utf-8")
LOADS: Final = tuple(name for name in STANDING if name.startswith("load_"))


def tipping(offset_m: float | None = None, **parameters: float) -> AnyRobot:
    """RARS by its robot file, with the plant that can tip over."""
    text = TEXT.replace('fmu = "rars"', 'fmu = "rars_tipping"')
    if offset_m is not None:
        text = text.replace("[geometry.lift]", f"centre_offset_m = {offset_m}\n\n[geometry.lift]")
    robot = parse(text, "tipping.toml")
    plant = robot.plant.model_copy(update={"parameters": parameters})
    return robot.model_copy(update={"plant": plant})


@pytest.mark.parametrize(("given", "taken"), [(None, 0.220), (0.220, 0.220), (0.141, 0.141)])
def test_the_robot_file_places_the_centre_of_mass(given: float | None, taken: float) -> None:
    robot = tipping(given)
    assert plant_of(robot).name == "rars_tipping"
    assert plant_parameters(robot)["centre_offset"] == taken
    assert plant_parameters(find("rars"))["centre_offset"] == 0.220


def test_the_bridge_drives_it_as_the_plain_plant(rides: Ridden) -> None:
    ends = []
    for robot in (find("rars"), tipping()):
        one = rides(ARMED, step(4.0, speed_mps=0.3), step(6.0, speed_mps=0.0), seconds=8, robot=robot)
        one.runs_until(8.0)
        ends.append(one.now)
    assert ends[0]["x_m"] > 0.5
    assert ends[1]["x_m"] == pytest.approx(ends[0]["x_m"], abs=1e-3)


def test_slope_and_payload_change_while_it_drives(rides: Ridden) -> None:
    robot = tipping(0.141, floor_friction=1.0)
    one = rides(ARMED, step(4.0, speed_mps=0.2), seconds=9, robot=robot)
    one.runs_until(5.0)
    plant = one.rig.devices.plant
    level = plant.read("zmp_margin")
    plant.change("lift_payload", 10.0)
    for degree in range(21):
        plant.change("slope", math.radians(degree))
        one.runs(0.1)
    one.runs_until(8.5)
    assert one.now["speed_mps"] == pytest.approx(0.2, abs=0.02)
    # Uphill, with 10 kg: x_cg - z tan(20 degrees).
    assert plant.read("zmp_margin") == pytest.approx(level - 0.229 * math.tan(math.radians(20)), abs=5e-3)
    weight = 80.6 * 9.81 * math.cos(math.radians(20))
    assert sum(map(plant.read, LOADS)) == pytest.approx(weight, rel=1e-9)
    assert plant.read("tipped") == 0.0
