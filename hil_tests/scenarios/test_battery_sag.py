"""The battery's sag under load: the drives see it at their supply, and the left one at its analog input."""

import pytest

from emulators.servo.axis import ServoAxis
from firmware_bridge.families.epos2.settings import Epos2AnalogueInput
from firmware_bridge.motion.ramp import MARGIN
from firmware_bridge.robot_types import find
from hil_tests.scenarios.ride import ARMED, ride, step

RARS = find("rars")
assert RARS.battery is not None
EMPTY_V = RARS.battery.nominal_v
DIVIDER = Epos2AnalogueInput.of(RARS.sensors[0]).per_volt
BATTERY_OHM = 0.050
"""`battery_resistance` of the plant."""


@pytest.mark.long(keeps=["30.0"])
@pytest.mark.parametrize("payload_kg", [0.0, 30.0])
def test_a_loaded_robot_lowers_the_voltage_that_its_drives_see(payload_kg: float) -> None:
    plant = RARS.plant.model_copy(
        update={"parameters": {"platform_mass": 70.0 + payload_kg, "floor_friction": 0.9}}
    )
    robot = RARS.model_copy(update={"plant": plant})
    bench = ride(ARMED, step(4.0, speed_mps=0.5), seconds=8.0, robot=robot)
    lowest = 1e9
    bench.runs_until(3.9)
    axes = [*bench.rig.devices.motors(ServoAxis).values()]
    standing = axes[0].supply_mv
    assert standing == pytest.approx(1000 * EMPTY_V, abs=60)
    for millisecond in range(900):
        bench.runs(0.001)
        supply = {axis.supply_mv for axis in axes}
        assert len(supply) == 1, "one battery feeds all drives"
        (now,) = supply
        # Each millisecond, behind the divider: what the bridge reads as its battery.
        assert axes[0].analogue_1_mv == pytest.approx(now / DIVIDER, abs=1.0), millisecond
        lowest = min(lowest, now)
    assert bench.fastest() > 0.3
    # Accelerating takes m a v out of 50 mOhm; the windings' heat and friction do not take as much again.
    power = (70.0 + payload_kg) * MARGIN * RARS.geometry.limits.acceleration_mps2 * bench.fastest()
    mechanical_mv = 1000 * BATTERY_OHM * power / EMPTY_V
    assert mechanical_mv < standing - lowest < 2 * mechanical_mv
    bench.rig.finish()
