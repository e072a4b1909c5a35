"""The hall sensors of a brushless motor: missing, impossible, or against the rotor's angle."""

from typing import TYPE_CHECKING

import pytest

from emulators.servo.axis_faults import AxisFaults, SensorWires
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from hil_tests.unit.motion_control.conftest import SETTINGS
from hil_tests.unit.motion_control.faults.conftest import (
    BLOCK,
    POLE_PAIRS,
    SENSOR_TYPE,
    SINUS,
    SOUND,
    WITHOUT_INDEX,
    falls,
    moving,
    resets,
)

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive


def brushless(drive: "Drive", motor: int = BLOCK) -> None:
    drive.write(od.MOTOR_TYPE, motor)


@pytest.mark.parametrize("wires", [SensorWires(hall_high=(1, 2, 3)), SensorWires(hall_low=(2,))])
@pytest.mark.emergency(0xFF01)
def test_hall_sensors_that_cannot_be_under_way(drive: "Drive", wires: SensorWires) -> None:
    brushless(drive)
    moving(drive)
    AxisFaults(drive.axis).wires(wires)
    falls(drive, 0xFF01, within_ms=25)
    AxisFaults(drive.axis).wires(SOUND)
    drive.run(2)
    assert resets(drive)


@pytest.mark.emergency(0xFF04)
def test_hall_sensors_that_are_not_there_when_the_drive_looks_for_them(drive: "Drive") -> None:
    brushless(drive)
    AxisFaults(drive.axis).wires(SensorWires(hall_high=(1, 2, 3)))
    drive.enable(mode=3)
    falls(drive, 0xFF04)
    AxisFaults(drive.axis).wires(SOUND)
    drive.run(2)
    assert not resets(drive)
    drive.control.reset()  # only the network's node reset leads out
    drive.run(20)
    moving(drive)
    assert drive.reported == [0xFF04]


@pytest.mark.parametrize("wrong", ["pole pairs", "counts"])
@pytest.mark.emergency(0xFF08)
def test_a_rotor_angle_that_does_not_fit_the_hall_sensors(drive: "Drive", wrong: str) -> None:
    drive.write(SENSOR_TYPE, WITHOUT_INDEX)
    brushless(drive, SINUS)
    drive.write(POLE_PAIRS, 2)
    if wrong == "pole pairs":
        AxisFaults(drive.axis).motor(pole_pairs=3)
        drive.enable(mode=3)
        drive.run(20)
        drive.write(od.TARGET_VELOCITY, 1000)
    else:
        moving(drive)
        assert drive.reported == []
        AxisFaults(drive.axis).wires(SensorWires(lost_per_mille=60))
    falls(drive, 0xFF08, within_ms=300)
    assert resets(drive)


@pytest.mark.parametrize("motor", [SINUS, BLOCK])
@pytest.mark.parametrize("pairs", [1, 7])
def test_a_brushless_motor_that_is_sound_turns_both_ways(drive: "Drive", motor: int, pairs: int) -> None:
    drive.write(POLE_PAIRS, pairs)
    brushless(drive, motor)
    moving(drive, 4000)
    moving(drive, -4000)
    assert drive.reported == []
    assert drive.read(Address(0x2022)) in range(1, 7)


def test_a_brushed_motor_has_no_hall_sensors(drive: "Drive") -> None:
    assert SETTINGS[od.MOTOR_TYPE] == 1
    AxisFaults(drive.axis).wires(SensorWires(hall_high=(1, 2, 3)))
    moving(drive)
    assert drive.reported == []
    assert drive.read(Address(0x2022)) == 0
