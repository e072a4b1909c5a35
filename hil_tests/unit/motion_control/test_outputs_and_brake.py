"""Output pins, and the holding brake on one of them: who may be active when."""

from typing import TYPE_CHECKING

import pytest

from emulators.epos2.io.holding_brake import FALL_TIME, RISE_TIME, STANDSTILL_TIMEOUT, TIMEOUT
from emulators.servo.pins import BRAKE_CLOSED
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.functions import (
    INPUT_EXECUTION,
    INPUT_PINS,
    OUTPUT_MASK,
    OUTPUT_PINS,
    OUTPUT_POLARITY,
    OUTPUT_STATE,
)

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

GENERAL = 0xFF00
BRAKE = 2


def test_a_write_reaches_the_general_bits_that_the_mask_lets_through(drive: "Drive") -> None:
    drive.write(OUTPUT_STATE, 0xFFFF)
    assert drive.read(OUTPUT_STATE) & GENERAL == 0
    drive.write(OUTPUT_MASK, 0xC0FF)
    drive.write(OUTPUT_STATE, 0xFFFF)
    assert drive.read(OUTPUT_STATE) == 0xC001, "and not the functions of the drive"
    assert drive.axis.outputs == 0b00011
    drive.write(OUTPUT_MASK, 0x4000)
    drive.write(OUTPUT_STATE, 0)
    assert drive.read(OUTPUT_STATE) == 0x8001
    assert drive.axis.outputs == 0b00001


def test_the_polarity_turns_pins_round(drive: "Drive") -> None:
    drive.write(OUTPUT_POLARITY, 0xF800)
    assert drive.axis.outputs == 0b11111
    assert drive.read(OUTPUT_STATE) == 0x0001


def test_ready_is_active_until_a_fault(drive: "Drive") -> None:
    drive.write(OUTPUT_PINS[3], 0)
    assert drive.axis.outputs == 0b01000
    drive.axis.supply_mv = 5_000
    drive.run(2)
    assert drive.axis.outputs == 0
    assert drive.read(OUTPUT_STATE) == 0
    drive.axis.supply_mv = 24_000
    drive.run(2)
    drive.command(0, 0x80)
    assert drive.axis.outputs == 0b01000


def with_brake(drive: "Drive") -> None:
    drive.write(OUTPUT_PINS[0], BRAKE)
    drive.write(RISE_TIME, 30)
    drive.write(FALL_TIME, 40)
    assert drive.axis.outputs == BRAKE_CLOSED


def closed(drive: "Drive") -> bool:
    """Return True if the brake is closed; its pin and the plant's input must agree."""
    held = bool(drive.axis.outputs & BRAKE_CLOSED)
    assert held != bool(drive.axis.outputs & 1)
    return held


def test_setpoints_wait_until_the_brake_is_open(drive: "Drive") -> None:
    with_brake(drive)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.enable(mode=3)
    assert drive.stands_in(PowerState.OPERATION_ENABLED)
    assert not closed(drive)
    drive.run(29)
    assert drive.axis.velocity_demand == 0
    drive.run(3)
    assert drive.axis.velocity_demand > 0


def test_a_command_on_the_way_waits_for_the_brake(drive: "Drive") -> None:
    with_brake(drive)
    drive.enable(mode=1)
    drive.write(od.TARGET_POSITION, 1000)
    drive.command(0x1F)
    drive.run(20)
    assert not drive.statusword & 0x1000
    drive.run(300)
    assert drive.axis.position == pytest.approx(1000, abs=20)


@pytest.mark.parametrize(
    ("word", "state"),
    [
        (0x00, PowerState.SWITCH_ON_DISABLED),
        (0x06, PowerState.READY_TO_SWITCH_ON),
        (0x07, PowerState.SWITCHED_ON),
    ],
)
def test_power_goes_when_the_shaft_rests_and_the_brake_holds(
    drive: "Drive", word: int, state: PowerState
) -> None:
    with_brake(drive)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.enable(mode=3)
    drive.run(400)
    drive.command(word)
    # 3000 rpm at 15 000 rpm/s, then the standstill's 50 ms.
    stopped = drive.runs_until(lambda: closed(drive))
    assert stopped in range(250, 350)
    assert abs(drive.rpm) < 30
    assert drive.stands_in(PowerState.OPERATION_ENABLED)
    assert drive.axis.powered
    assert drive.runs_until(lambda: drive.stands_in(state)) in range(39, 42)
    assert not drive.axis.powered


def test_a_quick_stop_keeps_its_ramp_and_the_brake_open(drive: "Drive") -> None:
    with_brake(drive)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.enable(mode=3)
    drive.run(400)
    drive.command(0x02)
    drive.run(5)
    drive.command(0x00)
    assert drive.runs_until(lambda: closed(drive)) < 200, "with 0x6085, not 0x6084"
    drive.runs_until(lambda: drive.stands_in(PowerState.SWITCH_ON_DISABLED))


def test_a_fault_with_a_ramp_closes_the_brake_after_it(drive: "Drive") -> None:
    with_brake(drive)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.enable(mode=3)
    drive.run(400)
    drive.control.communication_fault(0x8210)
    assert not closed(drive)
    drive.runs_until(lambda: closed(drive))
    assert drive.stands_in(PowerState.FAULT_REACTION_ENABLED)
    drive.runs_until(lambda: drive.stands_in(PowerState.FAULT))
    assert closed(drive)


def test_a_fault_without_a_ramp_closes_it_at_once(drive: "Drive") -> None:
    with_brake(drive)
    drive.enable(mode=3)
    drive.run(100)
    drive.axis.supply_mv = 5_000
    drive.run(1)
    assert drive.stands_in(PowerState.FAULT)
    assert closed(drive)


def test_a_fault_while_the_brake_opens_ends_in_fault(drive: "Drive") -> None:
    with_brake(drive)
    drive.enable(mode=3)
    drive.run(10)
    drive.control.communication_fault(0x8210)
    drive.runs_until(lambda: drive.stands_in(PowerState.FAULT), 300)
    assert closed(drive)


@pytest.mark.parametrize(
    ("word", "state"),
    [
        (0x00, PowerState.SWITCH_ON_DISABLED),
        (0x06, PowerState.READY_TO_SWITCH_ON),
        (0x07, PowerState.SWITCHED_ON),
        (0x02, PowerState.QUICK_STOP_ACTIVE),
    ],
)
def test_the_way_out_does_not_wait_for_the_brake_to_open(
    drive: "Drive", word: int, state: PowerState
) -> None:
    with_brake(drive)
    drive.write(RISE_TIME, 65_535)
    drive.enable(mode=3)
    drive.run(10)
    drive.command(word)
    # The standstill's 50 ms are over; the brake falls in 40.
    assert drive.runs_until(lambda: drive.stands_in(state)) < 100


def test_a_quick_stop_while_the_brake_opens_waits_for_it_no_longer(drive: "Drive") -> None:
    with_brake(drive)
    drive.write(INPUT_PINS[0], 5)
    drive.write(INPUT_EXECUTION, 1 << 5)
    drive.enable(mode=3)
    drive.run(10)
    drive.axis.pins = 1
    drive.run(100)
    assert drive.stands_in(PowerState.QUICK_STOP_ACTIVE)
    assert not closed(drive)
    assert drive.control.wake_at() > drive.now, "nothing is overdue"


@pytest.mark.parametrize(("object_", "milliseconds"), [(STANDSTILL_TIMEOUT, 120), (TIMEOUT, 80)])
def test_a_shaft_that_does_not_rest_is_waited_for_only_so_long(
    drive: "Drive", object_: Address, milliseconds: int
) -> None:
    with_brake(drive)
    drive.write(object_, milliseconds)
    drive.enable(mode=-3)
    drive.run(100)
    # Someone turns the shaft, and no regulator may say how much current that takes.
    drive.write(Address(0x2101, 1), 0)
    drive.write(at.OUTPUT_CURRENT_LIMIT, 0)
    drive.plant.load[0] = 0.002
    drive.run(50)
    drive.command(0x00)
    begun = drive.now
    drive.runs_until(lambda: drive.stands_in(PowerState.SWITCH_ON_DISABLED), 1500)
    fall = 40 if object_ == STANDSTILL_TIMEOUT else 0
    assert (drive.now - begun) / 1e6 == pytest.approx(milliseconds + fall, abs=12)


def test_a_reset_closes_the_brake(drive: "Drive") -> None:
    with_brake(drive)
    drive.enable(mode=3)
    drive.run(100)
    assert not closed(drive)
    drive.control.reset()
    assert closed(drive)


def test_without_a_brake_nothing_waits(drive: "Drive") -> None:
    drive.write(RISE_TIME, 1000)
    drive.write(FALL_TIME, 1000)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.enable(mode=3)
    drive.run(2)
    assert drive.axis.velocity_demand > 0
    drive.command(0x00)
    assert drive.stands_in(PowerState.SWITCH_ON_DISABLED)
    assert drive.axis.outputs == 0
