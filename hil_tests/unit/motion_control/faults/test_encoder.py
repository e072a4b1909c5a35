"""The encoders: cut, swapped, losing counts or index pulses, and settings that do not fit them."""

from typing import TYPE_CHECKING

import pytest

from emulators.servo.axis_faults import AxisFaults, IndexPulse, SensorWires
from firmware_bridge.canopen import objects as od
from firmware_bridge.families.epos2.wire import address as at
from hil_tests.unit.motion_control.faults.conftest import (
    DENOMINATOR,
    MISCELLANEOUS,
    NUMERATOR,
    POLARITY,
    SENSOR_TYPE,
    SOUND,
    SSI,
    STRUCTURE,
    WITH_INDEX,
    WITHOUT_INDEX,
    falls,
    moving,
    resets,
    resets_after,
)

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive


@pytest.mark.emergency(0xFF0A)
def test_a_cut_cable_is_a_breach_of_an_incremental_encoder(drive: "Drive") -> None:
    moving(drive)
    AxisFaults(drive.axis).wires(SensorWires(broken=True))
    falls(drive, 0xFF0A, within_ms=2)
    resets_after(drive, lambda: AxisFaults(drive.axis).wires(SOUND))


@pytest.mark.emergency(0x7320)
def test_a_cut_cable_makes_the_position_of_an_absolute_encoder_invalid(drive: "Drive") -> None:
    drive.write(SENSOR_TYPE, SSI)
    moving(drive)
    AxisFaults(drive.axis).wires(SensorWires(broken=True))
    falls(drive, 0x7320, within_ms=2)
    assert not resets(drive)


def test_supervision_of_the_position_sensor_can_be_switched_off(drive: "Drive") -> None:
    # 0x2008 bit 0: then only the following error is left to notice it.
    drive.write(MISCELLANEOUS, 1)
    drive.enable(mode=1)
    AxisFaults(drive.axis).wires(SensorWires(broken=True))
    drive.write(od.TARGET_POSITION, 20_000)
    drive.command(0x1F)
    drive.runs_until(lambda: bool(drive.reported))
    assert drive.reported == [0x8611]


@pytest.mark.parametrize("index", [IndexPulse.MISSING, IndexPulse.SPURIOUS])
@pytest.mark.emergency(0xFF02)
def test_an_index_that_is_missing_or_comes_too_often(drive: "Drive", index: IndexPulse) -> None:
    drive.write(SENSOR_TYPE, WITH_INDEX)
    moving(drive)
    drive.run(200)
    assert drive.reported == []
    AxisFaults(drive.axis).wires(SensorWires(index=index))
    falls(drive, 0xFF02, within_ms=65)  # three turns at 3000 rpm
    assert resets(drive)


def test_an_encoder_without_index_needs_none(drive: "Drive") -> None:
    drive.write(SENSOR_TYPE, WITHOUT_INDEX)
    moving(drive)
    AxisFaults(drive.axis).wires(SensorWires(index=IndexPulse.MISSING))
    drive.run(500)
    assert drive.reported == []


@pytest.mark.emergency(0xFF03)
def test_counts_that_get_lost_do_not_fit_the_resolution(drive: "Drive") -> None:
    moving(drive)
    before = drive.axis.position
    turned = drive.plant.outputs[1]
    AxisFaults(drive.axis).wires(SensorWires(lost_per_mille=50))
    falls(drive, 0xFF03, within_ms=65)
    counted = drive.axis.position - before
    assert counted < 0.97 * (drive.plant.outputs[1] - turned) * 2000 / 6.2831853
    assert resets(drive)


@pytest.mark.emergency(0xFF03)
def test_a_pulse_number_that_is_not_the_encoder_s(drive: "Drive") -> None:
    drive.write(at.ENCODER_PULSES, 400)
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 1000)
    falls(drive, 0xFF03, within_ms=300)


@pytest.mark.parametrize("rpm", [3000, -3000])
@pytest.mark.emergency(0xFF11)
def test_an_encoder_that_counts_against_the_motor(drive: "Drive", rpm: int) -> None:
    drive.enable(mode=3)
    AxisFaults(drive.axis).wires(SensorWires(swapped=True))
    drive.write(od.TARGET_VELOCITY, rpm)
    falls(drive, 0xFF11, within_ms=1000)
    assert resets(drive)


@pytest.mark.emergency(0xFF11)
def test_a_wrong_polarity_is_as_bad_as_swapped_channels_and_makes_up_for_them(drive: "Drive") -> None:
    drive.write(POLARITY, 1)
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 3000)
    falls(drive, 0xFF11, within_ms=1000)
    assert resets(drive)
    drive.run(2000)
    AxisFaults(drive.axis).wires(SensorWires(swapped=True))
    drive.control.reset()
    drive.run(20)
    moving(drive)
    assert drive.reported == [0xFF11, 0]
    assert drive.rpm == pytest.approx(3000, abs=30)


def test_a_load_that_wins_is_no_wrong_direction(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.plant.load[0] = -0.15
    drive.write(od.TARGET_VELOCITY, 1000)
    drive.run(400)
    assert drive.rpm < -1000
    assert drive.reported == []


@pytest.mark.emergency(0xFF12)
def test_an_auxiliary_encoder_that_counts_against_the_main_one(drive: "Drive") -> None:
    for address, value in ((STRUCTURE, 1), (NUMERATOR, 1), (DENOMINATOR, 1)):
        drive.write(address, value)
    moving(drive)
    drive.write(od.TARGET_VELOCITY, 0)
    drive.run(300)
    drive.command(0)
    AxisFaults(drive.axis).wires(SensorWires(auxiliary_swapped=True))
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 1000)
    falls(drive, 0xFF12, within_ms=150)


def test_cables_and_sensors_that_there_are_not_are_refused() -> None:
    with pytest.raises(ValueError, match="0 to 1000"):
        SensorWires(lost_per_mille=1001)
    with pytest.raises(ValueError, match=r"1, 2 and 3, not \[4\]"):
        SensorWires(hall_low=(4,))
