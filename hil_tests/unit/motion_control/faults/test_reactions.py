"""Faults: what is reported, how the motor stops, and what lets the drive out again."""

from typing import TYPE_CHECKING

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from hil_tests.unit.motion_control.faults.conftest import RESET, moving

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive


@pytest.mark.emergency(0x3220)
def test_loss_of_power_is_reported_at_once_and_switches_off(drive: "Drive") -> None:
    # Recorded from an EPOS2 at loss of power: 081 [8] 20 32 04 ..., code 0x3220.
    moving(drive)
    drive.axis.supply_mv = 5_000
    drive.run(1)
    assert drive.reported == [0x3220]
    assert drive.stands_in(PowerState.FAULT)
    assert drive.statusword & 0x417F == 0x0108
    assert not drive.axis.powered


@pytest.mark.emergency(0x3210)
def test_a_fault_without_power_passes_through_the_disabled_reaction(drive: "Drive") -> None:
    drive.axis.supply_mv = 80_000
    drive.run(2)
    assert drive.reported == [0x3210]
    assert drive.stands_in(PowerState.FAULT)


def test_fault_reset_needs_a_rising_edge_and_a_cause_that_is_gone(drive: "Drive") -> None:
    drive.axis.supply_mv = 5_000
    drive.run(2)
    drive.command(RESET)
    assert drive.stands_in(PowerState.FAULT)
    drive.axis.supply_mv = 24_000
    drive.run(2)
    drive.command(RESET)
    assert drive.stands_in(PowerState.FAULT)
    drive.command(0, RESET)
    assert drive.stands_in(PowerState.SWITCH_ON_DISABLED)
    assert drive.reported == [0x3220, 0x0000]
    drive.command(0)
    assert drive.statusword == 0x1740 if drive.read(od.MODE) == 3 else 0x0740


def test_a_fault_that_comes_back_is_reported_again(drive: "Drive") -> None:
    for _ in range(2):
        drive.axis.supply_mv = 5_000
        drive.run(10)
        drive.axis.supply_mv = 24_000
        drive.run(10)
        drive.command(0, RESET)
    assert drive.reported == [0x3220, 0x0000] * 2


@pytest.mark.parametrize(
    ("option", "milliseconds"),
    [(0, 0), (1, 200), (2, 50), (7, 50)],
    ids=["off", "slow down 6084", "quick stop 6085", "unknown value"],
)
def test_the_fault_reaction_option_chooses_the_ramp(drive: "Drive", option: int, milliseconds: int) -> None:
    moving(drive)
    drive.write(od.FAULT_REACTION_OPTION, option)
    drive.control.communication_fault(0x8210)
    if milliseconds:
        assert drive.stands_in(PowerState.FAULT_REACTION_ENABLED)
        assert drive.statusword & 0x417F == 0x011F
    assert drive.runs_until(lambda: drive.stands_in(PowerState.FAULT)) == pytest.approx(milliseconds, abs=3)
    assert drive.reported == [0x8210]


def test_signal_only_reports_and_goes_on(drive: "Drive") -> None:
    moving(drive)
    drive.write(od.FAULT_REACTION_OPTION, -1)
    drive.control.communication_fault(0x8210)
    drive.run(100)
    assert drive.reported == [0x8210]
    assert drive.stands_in(PowerState.OPERATION_ENABLED)


def test_an_error_without_a_reaction_is_only_reported(drive: "Drive") -> None:
    moving(drive)
    drive.control.communication_fault(0x8150)
    assert drive.reported == [0x8150]
    assert drive.stands_in(PowerState.OPERATION_ENABLED)


@pytest.mark.parametrize(
    ("option", "milliseconds", "end"),
    [
        (0, 0, PowerState.OPERATION_ENABLED),
        (1, 50, PowerState.FAULT),
        (2, 0, PowerState.FAULT),
        (3, 50, PowerState.FAULT),
    ],
    ids=["none", "fault", "disable voltage", "quick stop"],
)
@pytest.mark.emergency(0x8130)
def test_a_lost_connection_reacts_as_0x6007_states(
    drive: "Drive", option: int, milliseconds: int, end: PowerState
) -> None:
    moving(drive)
    drive.write(od.ABORT_CONNECTION_OPTION, option)
    drive.control.connection_lost()
    assert drive.reported == [0x8130]
    assert drive.runs_until(lambda: drive.stands_in(end)) == pytest.approx(milliseconds, abs=3)
    drive.run(300)
    assert drive.stands_in(end)


@pytest.mark.emergency(0x8611)
def test_a_shaft_that_cannot_follow_raises_the_following_error(drive: "Drive") -> None:
    drive.enable(mode=1)
    drive.plant.load[0] = -0.08
    drive.write(od.TARGET_POSITION, 50_000)
    drive.command(0x1F)
    drive.runs_until(lambda: bool(drive.reported))
    assert drive.reported == [0x8611]
    assert abs(drive.read(at.FOLLOWING_ERROR)) == pytest.approx(2000, rel=0.1)
    drive.plant.load[0] = 0.0
    drive.runs_until(lambda: drive.stands_in(PowerState.FAULT))
    assert drive.statusword & 0x2000
    drive.command(0, RESET)
    assert drive.stands_in(PowerState.SWITCH_ON_DISABLED)
    assert not drive.statusword & 0x2000


def test_the_following_error_can_be_switched_off(drive: "Drive") -> None:
    drive.write(od.MAX_FOLLOWING_ERROR, 0xFFFF_FFFF)
    drive.enable(mode=1)
    drive.plant.load[0] = -0.08
    drive.write(od.TARGET_POSITION, 50_000)
    drive.command(0x1F)
    drive.run(500)
    assert drive.reported == []
    assert drive.read(at.FOLLOWING_ERROR) == 0x7FFF


def test_an_error_that_only_the_network_cures_stays_until_then(drive: "Drive") -> None:
    drive.control.communication_fault(0x8120)
    drive.command(RESET)
    assert drive.stands_in(PowerState.FAULT)
    drive.control.communication_reset()
    drive.command(0, RESET)
    assert drive.stands_in(PowerState.SWITCH_ON_DISABLED)


def test_a_worse_fault_during_a_ramp_switches_off_at_once(drive: "Drive") -> None:
    moving(drive)
    drive.control.communication_fault(0x8210)
    drive.run(10)
    drive.axis.supply_mv = 5_000
    drive.run(2)
    assert drive.stands_in(PowerState.FAULT)
    assert drive.reported == [0x8210, 0x3220]


def test_the_thermal_limit_shows_in_bit_11(drive: "Drive") -> None:
    drive.write(at.CURRENT_MODE_SETTING, 3000)
    drive.write(at.MAX_MOTOR_SPEED, 25_000)
    drive.plant.load[0] = -3.0 * 0.0234
    drive.enable(mode=-3)
    ms = drive.runs_until(lambda: bool(drive.statusword & 0x0800))
    assert ms == pytest.approx(200, abs=5)  # a twentieth of 4 s
    drive.run(5)
    assert drive.read(at.CURRENT_DEMAND) == 1200
