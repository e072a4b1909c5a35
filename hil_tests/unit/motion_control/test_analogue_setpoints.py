"""Analog set-points of current, velocity and position mode: scaling, offset, notation, input, limits."""

from typing import TYPE_CHECKING

import pytest

from emulators.epos2.modes.analogue import (
    CURRENT_SETPOINT,
    EXECUTION_MASK,
    FUNCTIONS,
    POSITION_SETPOINT,
    VELOCITY_SETPOINT,
    AnalogueSetpoint,
)
from firmware_bridge.canopen import objects as od
from firmware_bridge.families.epos2.wire import address as at

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

SETPOINTS = {-3: CURRENT_SETPOINT, -2: VELOCITY_SETPOINT, -1: POSITION_SETPOINT}
SETTINGS = {-3: at.CURRENT_MODE_SETTING, -2: at.VELOCITY_MODE_SETTING, -1: at.POSITION_MODE_SETTING}
DEMANDS = {-3: at.CURRENT_DEMAND, -2: od.VELOCITY_DEMAND, -1: od.POSITION_DEMAND}


def configure(
    drive: "Drive", setpoint: AnalogueSetpoint, scaling: int, offset: int = 0, notation: int = 0
) -> None:
    drive.write(setpoint.scaling, scaling)
    drive.write(setpoint.offset, offset)
    drive.write(setpoint.notation, notation)
    drive.write(FUNCTIONS[1], setpoint.function)
    drive.write(EXECUTION_MASK, 1 << setpoint.function)


@pytest.mark.parametrize("mode", [-3, -2, -1])
@pytest.mark.parametrize(
    ("scaling", "offset", "notation", "millivolts", "expected"),
    [
        (100, 0, 0, 2000, 200),
        (100, 0, 0, -2000, -200),
        (100, -50, 0, 2000, 150),
        (10, 0, 1, 2500, 250),
        (1000, 7, -1, 1000, 107),
        (-100, 0, 0, 2000, -200),
        (0, 33, 0, 9999, 33),
    ],
)
def test_volts_are_scaled(  # noqa: PLR0917 - a row of the table
    drive: "Drive", mode: int, scaling: int, offset: int, notation: int, millivolts: int, expected: int
) -> None:
    configure(drive, SETPOINTS[mode], scaling, offset, notation)
    drive.axis.analogue_2_mv = millivolts
    assert drive.read(SETPOINTS[mode].value) == expected
    drive.enable(mode=mode)
    drive.run(2)
    assert drive.read(DEMANDS[mode]) == expected


@pytest.mark.parametrize("mode", [-3, -2, -1])
def test_the_mask_chooses_between_input_and_set_value_at_once(drive: "Drive", mode: int) -> None:
    drive.axis.analogue_2_mv = 1500
    configure(drive, SETPOINTS[mode], 100)
    drive.write(EXECUTION_MASK, 0)
    drive.enable(mode=mode)
    drive.write(SETTINGS[mode], 60)
    drive.run(2)
    assert drive.read(DEMANDS[mode]) == 60
    drive.write(EXECUTION_MASK, 7)
    drive.run(2)
    assert drive.read(DEMANDS[mode]) == 150
    drive.write(SETTINGS[mode], 70)
    drive.run(2)
    assert drive.read(DEMANDS[mode]) == 150
    drive.write(EXECUTION_MASK, 0)
    drive.run(2)
    assert drive.read(DEMANDS[mode]) == 70


def test_the_input_counts_every_millisecond_without_an_event(drive: "Drive") -> None:
    configure(drive, VELOCITY_SETPOINT, 1000)
    drive.enable(mode=-2)
    for millivolts in (0, 500, 1000, -300):
        drive.axis.analogue_2_mv = millivolts
        drive.run(2)
        assert drive.read(od.VELOCITY_DEMAND) == millivolts


def test_the_first_input_with_the_function_counts(drive: "Drive") -> None:
    configure(drive, VELOCITY_SETPOINT, 100)
    drive.axis.analogue_1_mv, drive.axis.analogue_2_mv = 3000, 1000
    assert drive.read(VELOCITY_SETPOINT.value) == 100
    drive.write(FUNCTIONS[0], 1)
    assert drive.read(VELOCITY_SETPOINT.value) == 300


def test_without_an_input_of_that_function_the_set_value_counts(drive: "Drive") -> None:
    configure(drive, VELOCITY_SETPOINT, 100, offset=5)
    drive.write(FUNCTIONS[1], 14)
    drive.axis.analogue_1_mv = drive.axis.analogue_2_mv = 3000
    drive.enable(mode=-2)
    drive.write(at.VELOCITY_MODE_SETTING, 40)
    drive.run(2)
    assert drive.read(od.VELOCITY_DEMAND) == 40


def test_limits_hold_for_volts_too(drive: "Drive") -> None:
    drive.axis.analogue_2_mv = 10_000
    drive.write(od.MAX_PROFILE_VELOCITY, 800)
    configure(drive, VELOCITY_SETPOINT, 1000)
    drive.enable(mode=-2)
    drive.run(2)
    assert drive.read(od.VELOCITY_DEMAND) == 800
    drive.write(at.VELOCITY_MODE_SETTING, 0)
    drive.write(EXECUTION_MASK, 0)
    drive.run(100)
    drive.write(od.MIN_POSITION_LIMIT, -100)
    drive.write(od.MAX_POSITION_LIMIT, drive.read(od.POSITION_ACTUAL) + 50)
    configure(drive, POSITION_SETPOINT, 30_000)
    drive.write(od.MODE, -1)
    drive.run(2)
    assert drive.read(od.POSITION_DEMAND) == drive.read(od.MAX_POSITION_LIMIT)


def test_current_by_volts_stays_within_the_output_limit(drive: "Drive") -> None:
    configure(drive, CURRENT_SETPOINT, 30_000)
    drive.axis.analogue_2_mv = 10_000
    drive.enable(mode=-3)
    drive.run(2)
    assert drive.read(at.CURRENT_DEMAND) == 3000


def test_no_volts_move_a_drive_that_is_not_enabled_or_brakes(drive: "Drive") -> None:
    configure(drive, VELOCITY_SETPOINT, 1000)
    drive.axis.analogue_2_mv = 2000
    drive.write(od.MODE, -2)
    drive.run(20)
    assert drive.axis.voltage_mv == 0
    drive.enable()
    drive.run(50)
    assert drive.read(od.VELOCITY_DEMAND) == 2000
    drive.command(0x02)
    drive.run(100)
    assert drive.read(od.VELOCITY_DEMAND) == 0
    drive.command(0x00)
    drive.write(od.MODE, 3)
    drive.enable()
    drive.run(50)
    assert drive.read(od.VELOCITY_DEMAND) == 0
