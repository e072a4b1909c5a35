"""Profile velocity mode, and the bare velocity and current modes."""

from typing import TYPE_CHECKING

import pytest

from emulators.epos2.control import value_ranges
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

REACHED, ZERO = 0x0400, 0x1000


def test_ramps_up_with_6083_and_down_with_6084(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 3000)
    assert not drive.statusword & REACHED
    up = drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert up == pytest.approx(100, abs=2)
    drive.run(200)
    assert drive.rpm == pytest.approx(3000, abs=60)
    assert not drive.statusword & ZERO
    drive.write(od.TARGET_VELOCITY, 0)
    down = drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert down == pytest.approx(200, abs=2)
    drive.run(400)
    assert drive.statusword == 0x1737


def test_runs_backwards(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, -2000)
    drive.run(500)
    assert drive.rpm == pytest.approx(-2000, abs=60)
    assert drive.read(od.VELOCITY_DEMAND) == -2000


@pytest.mark.parametrize("limit", [od.MAX_PROFILE_VELOCITY, at.MAX_MOTOR_SPEED])
def test_the_speed_is_limited(drive: "Drive", limit: Address) -> None:
    drive.write(limit, 1500)
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 4000)
    drive.run(300)
    assert drive.read(od.VELOCITY_DEMAND) == 1500


def test_a_target_written_before_enabling_is_driven_after_it(drive: "Drive") -> None:
    drive.write(od.MODE, 3)
    drive.write(od.TARGET_VELOCITY, 1000)
    drive.run(100)
    assert drive.rpm == 0
    drive.enable()
    drive.run(300)
    assert drive.rpm == pytest.approx(1000, abs=60)


def test_enabled_with_halt_it_stands_until_the_halt_ends(drive: "Drive") -> None:
    drive.write(od.MODE, 3)
    drive.write(od.TARGET_VELOCITY, 1000)
    drive.command(0x06, 0x010F)
    drive.run(200)
    assert drive.rpm == 0
    drive.command(0x000F)
    drive.run(300)
    assert drive.rpm == pytest.approx(1000, abs=60)


def test_halt_ramps_with_6084_and_its_end_resumes(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.run(300)
    drive.command(0x010F)
    drive.write(od.TARGET_VELOCITY, 2000)
    down = drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert down == pytest.approx(200, abs=2)
    drive.run(200)
    assert abs(drive.rpm) < 30
    drive.command(0x000F)
    drive.run(300)
    assert drive.rpm == pytest.approx(2000, abs=60)


def test_a_velocity_window_waits_for_the_shaft(drive: "Drive") -> None:
    drive.write(od.VELOCITY_WINDOW, 60)
    drive.write(od.VELOCITY_WINDOW_TIME, 20)
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 3000)
    reached = drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert reached >= 119


def test_the_mode_changes_under_way_and_comes_to_rest(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.run(300)
    drive.write(od.MODE, 1)
    assert drive.read(od.MODE_DISPLAY) == 1
    drive.run(400)
    assert drive.stands_in(PowerState.OPERATION_ENABLED)
    assert drive.reported == []
    assert abs(drive.read(at.FOLLOWING_ERROR)) <= 10
    assert drive.rpm == pytest.approx(0, abs=5)


def test_a_halt_outlives_a_change_of_mode(drive: "Drive") -> None:
    drive.enable(mode=1)
    drive.command(0x010F)
    drive.write(od.MODE, 3)
    drive.write(od.TARGET_VELOCITY, 1000)
    drive.run(200)
    assert drive.rpm == pytest.approx(0, abs=5)
    drive.command(0x000F)
    drive.run(300)
    assert drive.rpm == pytest.approx(1000, abs=60)


def test_velocity_mode_takes_its_set_value_without_a_ramp(drive: "Drive") -> None:
    drive.write(at.VELOCITY_MODE_SETTING, 1000)
    drive.enable(mode=-2)
    assert drive.read(od.VELOCITY_DEMAND) == 1000
    drive.run(300)
    assert drive.rpm == pytest.approx(1000, abs=60)
    drive.write(at.VELOCITY_MODE_SETTING, -500)
    assert drive.read(od.VELOCITY_DEMAND) == -500


def test_current_mode_drives_its_current(drive: "Drive") -> None:
    drive.write(at.CURRENT_MODE_SETTING, 300)
    drive.enable(mode=-3)
    drive.run(50)
    assert drive.read(at.CURRENT_AVERAGED) == pytest.approx(300, abs=15)  # the speed's rise takes a little
    drive.command(0x02)
    drive.run(500)
    assert drive.stands_in(PowerState.QUICK_STOP_ACTIVE)
    assert abs(drive.rpm) < 60


@pytest.mark.parametrize("mode", [7, -4, -5, -6])
def test_other_listed_modes_are_shown_and_hold_still(drive: "Drive", mode: int) -> None:
    drive.write(od.MODE, mode)
    assert drive.read(od.MODE_DISPLAY) == mode
    drive.enable()
    drive.write(od.TARGET_VELOCITY, 1000)
    drive.command(0x1F)
    drive.run(200)
    assert abs(drive.read(od.POSITION_ACTUAL)) <= 1


@pytest.mark.parametrize("mode", [0, 2, 4, 5, 8, 127, -7, -128])
def test_unlisted_modes_are_refused(drive: "Drive", mode: int) -> None:
    with pytest.raises(SdoAbort) as refused:
        drive.write(od.MODE, mode)
    assert refused.value.code in (AbortCode.RANGE, AbortCode.TOO_HIGH, AbortCode.TOO_LOW)
    assert drive.read(od.MODE_DISPLAY) == 1


@pytest.mark.parametrize("shape", [-1, 2, 3])
def test_profile_types_but_trapezoid_and_sinusoid_are_refused(drive: "Drive", shape: int) -> None:
    value_ranges.keep(drive.store)
    drive.write(od.MOTION_PROFILE_TYPE, 1)
    with pytest.raises(SdoAbort) as refused:
        drive.write(od.MOTION_PROFILE_TYPE, shape)
    assert refused.value.code is AbortCode.RANGE
    assert drive.read(od.MOTION_PROFILE_TYPE) == 1


@pytest.mark.parametrize("address", [at.ENCODER_PULSES, at.SENSOR_TYPE, od.MOTOR_TYPE])
def test_what_the_motor_is_cannot_change_under_power(drive: "Drive", address: Address) -> None:
    value = drive.read(address)
    drive.write(address, value)
    drive.enable()
    with pytest.raises(SdoAbort) as refused:
        drive.write(address, value)
    assert refused.value.code is AbortCode.DEVICE_STATE
