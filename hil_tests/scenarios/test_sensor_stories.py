"""Stories of cables and sensors that fail while the robot drives."""

import pytest

from emulators.epos2.drive import Epos2
from emulators.servo.axis import ServoAxis
from emulators.servo.axis_faults import AxisFaults, SensorWires
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen.objects import ERROR_HISTORY_COUNT, STATUSWORD
from firmware_bridge.families.epos2.wire.emergency import SENSOR_BREACH
from firmware_bridge.families.epos2.wire.power_states import state_of
from hil_tests.scenarios.ride import ARMED, Ridden, step


@pytest.mark.long(keeps=["left"])
@pytest.mark.parametrize("wheel", ["left", "right"])
def test_a_wheel_whose_encoder_is_cut_off_stops_the_robot(rides: Ridden, wheel: str) -> None:
    ride = rides(ARMED, step(4.0, speed_mps=0.3), seconds=20)
    ride.runs_until(7.0)
    assert ride.now["speed_mps"] == pytest.approx(0.3, rel=0.02)
    axes = {axis.name: axis for axis in [*ride.rig.devices.motors(ServoAxis).values()]}
    AxisFaults(axes[wheel]).wires(SensorWires(broken=True))
    ride.runs_until(7.1)
    drive = ride.rig.devices.nodes(Epos2)[wheel]
    assert state_of(drive.store.get(STATUSWORD)) is PowerState.FAULT
    assert drive.store.get(ERROR_HISTORY_COUNT) == 1
    assert not axes[wheel].powered
    ride.runs_until(12.0)
    assert ride.held("axis fault")
    assert f"0x{SENSOR_BREACH:04X}" in " ".join(ride.held("axis fault"))
    assert ride.stands_from(7.0) < 9.0
    assert ride.fastest(9.0) < 0.002
