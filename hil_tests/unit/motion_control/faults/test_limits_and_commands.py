"""Faults of a drive that is sound: positions beyond their limits, settings and commands that cannot be."""

from typing import TYPE_CHECKING

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from hil_tests.unit.motion_control.faults.conftest import (
    DENOMINATOR,
    NUMERATOR,
    STRUCTURE,
    falls,
    fell,
    moving,
    resets,
)

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive


@pytest.mark.parametrize("rpm", [1000, -1000])
@pytest.mark.emergency(0xFF09)
def test_a_shaft_that_runs_past_its_limit_is_stopped_and_may_come_back(drive: "Drive", rpm: int) -> None:
    drive.write(od.MIN_POSITION_LIMIT, -3000)
    drive.write(od.MAX_POSITION_LIMIT, 3000)
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, rpm)
    falls(drive, 0xFF09, within_ms=200)
    assert 3000 < abs(drive.axis.position) < 3700
    drive.write(od.TARGET_VELOCITY, 0)
    assert resets(drive)
    drive.enable()
    drive.run(100)
    drive.write(od.TARGET_VELOCITY, -rpm)
    drive.run(100)
    assert drive.reported == [0xFF09, 0]
    assert abs(drive.axis.position) < 3000
    drive.write(od.TARGET_VELOCITY, rpm)
    drive.run(300)
    assert drive.reported == [0xFF09, 0, 0xFF09]


def test_a_shaft_beyond_its_limit_is_not_driven_further(drive: "Drive") -> None:
    moving(drive)
    drive.write(od.TARGET_VELOCITY, 0)
    drive.run(300)
    drive.write(od.MAX_POSITION_LIMIT, 1000)
    drive.run(50)
    assert drive.reported == []
    drive.write(od.TARGET_VELOCITY, 100)
    falls(drive, 0xFF09, within_ms=20)


def test_a_move_to_the_very_limit_is_no_fault_by_its_overshoot(drive: "Drive") -> None:
    drive.write(od.MAX_POSITION_LIMIT, 1000)
    drive.enable(mode=-1)
    furthest = 0
    drive.write(at.POSITION_MODE_SETTING, 1000)
    for _ in range(600):
        drive.run(1)
        furthest = max(furthest, drive.axis.position)
    assert furthest > 1000
    assert drive.reported == []


@pytest.mark.emergency(0x6320)
def test_a_target_too_far_for_a_low_velocity_contradicts_itself(drive: "Drive") -> None:
    drive.enable(mode=1)
    drive.write(od.PROFILE_VELOCITY, 1)
    drive.write(od.TARGET_POSITION, 2_000_000_000)
    drive.command(0x1F)
    fell(drive, 0x6320)
    assert drive.axis.position == pytest.approx(0, abs=5)
    drive.write(od.PROFILE_VELOCITY, 3000)
    assert resets(drive)
    drive.enable()
    drive.command(0x1F)
    drive.run(100)
    assert drive.axis.position > 1000


@pytest.mark.emergency(0xFF0B)
def test_a_master_that_floods_the_drive_with_targets_overloads_it(drive: "Drive") -> None:
    moving(drive)
    for rpm in range(8):
        drive.write(od.TARGET_VELOCITY, 3000 + rpm)
    assert drive.reported == []
    drive.write(od.TARGET_VELOCITY, 3000)
    assert drive.stands_in(PowerState.FAULT)
    fell(drive, 0xFF0B)
    assert resets(drive)


@pytest.mark.parametrize("start", [Address(0x2410, 1), Address(0x2400, 3)])
@pytest.mark.emergency(0xFF0D)
def test_an_identification_of_the_motor_fails_and_moves_nothing(drive: "Drive", start: Address) -> None:
    drive.enable(mode=3)
    drive.run(100)
    at_standstill = drive.plant.outputs[1]
    drive.write(start, 1)
    fell(drive, 0xFF0D)
    assert drive.plant.outputs[1] == pytest.approx(at_standstill, abs=0.01)
    assert resets(drive)


@pytest.mark.emergency(0x1000)
def test_a_download_of_firmware_cannot_be_begun(drive: "Drive") -> None:
    moving(drive)
    drive.write(Address(0x2FFF, 1), 1)
    assert drive.stands_in(PowerState.FAULT)
    fell(drive, 0x1000)


@pytest.mark.emergency(0xFF0F)
def test_a_dual_loop_without_a_gear_ratio_is_not_enabled(drive: "Drive") -> None:
    drive.write(STRUCTURE, 1)
    assert drive.read(NUMERATOR) == 0  # as read from a real 70/10
    drive.enable(mode=3)
    assert drive.stands_in(PowerState.FAULT)
    fell(drive, 0xFF0F)
    assert not resets(drive)
    drive.write(NUMERATOR, 26)
    assert resets(drive)
    moving(drive)
    assert drive.reported == [0xFF0F, 0]


@pytest.mark.emergency(0xFF10)
def test_gains_that_the_gear_makes_too_large_are_not_enabled(drive: "Drive") -> None:
    for address, value in ((STRUCTURE, 1), (NUMERATOR, 200), (DENOMINATOR, 1)):
        drive.write(address, value)
    drive.enable(mode=3)
    assert drive.stands_in(PowerState.FAULT)
    fell(drive, 0xFF10)
    assert not resets(drive)
    drive.write(NUMERATOR, 26)
    assert resets(drive)
