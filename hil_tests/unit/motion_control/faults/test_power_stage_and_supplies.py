"""The power stage and its supplies: too much current, too much heat, too little voltage."""

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from emulators.servo.axis_faults import AxisFaults
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from hil_tests.unit.motion_control.conftest import STEERING
from hil_tests.unit.motion_control.faults.conftest import (
    falls,
    moving,
    resets,
    resets_after,
    stays_without_current,
)

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive


@pytest.mark.emergency(0x2310)
def test_a_short_in_the_winding_is_an_over_current(drive: "Drive") -> None:
    moving(drive)
    drive.plant.becomes(0, replace(STEERING, resistance=0.02, inductance=5e-6))
    drive.runs_until(lambda: bool(drive.reported), 50)
    assert drive.reported == [0x2310]
    assert drive.stands_in(PowerState.FAULT)
    drive.plant.becomes(0, STEERING)
    stays_without_current(drive)
    assert resets(drive)


@pytest.mark.emergency(0x4210)
def test_a_current_heats_the_power_stage_until_it_switches_off(drive: "Drive") -> None:
    AxisFaults(drive.axis).air(99.995)
    drive.plant.load[0] = -1.2 * STEERING.torque_constant
    drive.enable(mode=-3)
    drive.write(at.CURRENT_MODE_SETTING, 1200)
    drive.run(300)
    assert drive.reported == []
    falls(drive, 0x4210, within_ms=3000)
    resets_after(drive, lambda: AxisFaults(drive.axis).air(60.0))


@pytest.mark.emergency(0x4210)
def test_hot_surroundings_are_enough(drive: "Drive") -> None:
    AxisFaults(drive.axis).air(101.0)
    drive.run(2)
    assert drive.reported == [0x4210]
    assert drive.stands_in(PowerState.FAULT)


@pytest.mark.emergency(0x5113)
def test_a_short_in_a_sensor_cable_pulls_the_5_v_supply_down(drive: "Drive") -> None:
    moving(drive)
    AxisFaults(drive.axis).logic_supply(3.0)
    falls(drive, 0x5113, within_ms=2)
    resets_after(drive, lambda: AxisFaults(drive.axis).logic_supply(4.5))


@pytest.mark.emergency(0x5114)
def test_gates_that_lack_voltage_are_not_driven(drive: "Drive") -> None:
    moving(drive)
    AxisFaults(drive.axis).gate_supply(8.9)
    falls(drive, 0x5114, within_ms=2)
    resets_after(drive, lambda: AxisFaults(drive.axis).gate_supply(9.0))
