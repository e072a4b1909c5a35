"""Input pins: what their functions show, and what those do that may act."""

from typing import TYPE_CHECKING

import pytest

from emulators.epos2.control import value_ranges
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.functions import (
    INPUT_EXECUTION,
    INPUT_MASK,
    INPUT_PINS,
    INPUT_POLARITY,
    INPUT_STATE,
    OUTPUT_PINS,
)

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

# maxon EDS for the 70/10: the default of 0x2070 for each pin.
DEFAULTS = {1: 15, 2: 14, 3: 13, 4: 2, 5: 1, 6: 0, 7: 9, 8: 8, 9: 7}
NEGATIVE_PIN, POSITIVE_PIN = 1 << 5, 1 << 4
LIMITS = 0x0003
ENABLE_BIT, QUICK_STOP_BIT = 1 << 4, 1 << 5


@pytest.mark.parametrize(("pin", "function"), DEFAULTS.items())
def test_a_closed_pin_shows_its_function(drive: "Drive", pin: int, function: int) -> None:
    assert drive.read(INPUT_STATE) == 0
    drive.axis.pins = 1 << pin - 1
    assert drive.read(INPUT_STATE) == 1 << function


def test_the_mask_hides_functions_from_the_reader_only(drive: "Drive") -> None:
    drive.axis.pins = 0x1FF
    assert drive.read(INPUT_STATE) == 0xE387
    drive.write(INPUT_MASK, 0x8001)
    assert drive.read(INPUT_STATE) == 0x8001
    drive.write(INPUT_MASK, 0)
    drive.write(INPUT_EXECUTION, LIMITS)
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, -1000)
    assert drive.reported == [0xFF06]


def test_the_polarity_turns_a_fitted_function_round(drive: "Drive") -> None:
    drive.write(INPUT_MASK, 0xFFFF)
    drive.write(INPUT_POLARITY, 0xFFFF)
    assert drive.read(INPUT_STATE) == 0xE387, "not those that no pin has"
    drive.axis.pins = NEGATIVE_PIN
    assert drive.read(INPUT_STATE) == 0xE386


def test_another_pin_may_have_the_function(drive: "Drive") -> None:
    drive.write(INPUT_PINS[0], 2)
    drive.axis.pins = 1
    assert drive.read(INPUT_STATE) == 1 << 2


@pytest.mark.parametrize("address", [*INPUT_PINS, *OUTPUT_PINS], ids=str)
def test_there_are_no_other_functions(drive: "Drive", address: Address) -> None:
    value_ranges.keep(drive.store)
    for value in (16, 0xFFFF, *((3, 7) if address in OUTPUT_PINS else ())):
        with pytest.raises(SdoAbort) as refusal:
            drive.write(address, value)
        assert refusal.value.code is AbortCode.RANGE


def runs_at(drive: "Drive", rpm: int) -> None:
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, rpm)
    drive.run(300)


@pytest.mark.emergency(0xFF06, 0xFF07)
@pytest.mark.parametrize(
    ("pin", "rpm", "code"), [(NEGATIVE_PIN, -3000, 0xFF06), (POSITIVE_PIN, 3000, 0xFF07)]
)
def test_a_limit_switch_stops_by_the_quick_stop_ramp(drive: "Drive", pin: int, rpm: int, code: int) -> None:
    drive.write(INPUT_EXECUTION, LIMITS)
    runs_at(drive, rpm)
    drive.axis.pins = pin
    drive.run(1)
    assert drive.reported == [code]
    assert drive.stands_in(PowerState.FAULT_REACTION_ENABLED)
    # 3000 rpm at 60 000 rpm/s.
    assert drive.runs_until(lambda: drive.stands_in(PowerState.FAULT)) in range(48, 53)


@pytest.mark.parametrize("pin", [NEGATIVE_PIN, POSITIVE_PIN])
def test_a_limit_switch_that_may_not_act_does_not(drive: "Drive", pin: int) -> None:
    runs_at(drive, -3000)
    drive.axis.pins = pin
    drive.run(100)
    assert drive.reported == []
    assert drive.stands_in(PowerState.OPERATION_ENABLED)


def test_a_limit_switch_on_the_way_out_of_the_other_end_stops_too(drive: "Drive") -> None:
    drive.write(INPUT_EXECUTION, LIMITS)
    runs_at(drive, 3000)
    drive.axis.pins = NEGATIVE_PIN
    drive.run(1)
    assert drive.reported == [0xFF06]


def test_without_power_a_limit_switch_is_no_fault(drive: "Drive") -> None:
    drive.write(INPUT_EXECUTION, LIMITS)
    drive.axis.pins = NEGATIVE_PIN | POSITIVE_PIN
    drive.run(10)
    drive.enable(mode=1)
    drive.run(100)
    assert drive.reported == []
    assert drive.stands_in(PowerState.OPERATION_ENABLED)


MOVES = {
    "profile position": (1, od.TARGET_POSITION, 2000),
    "profile velocity": (3, od.TARGET_VELOCITY, 500),
    "position": (-1, at.POSITION_MODE_SETTING, 500),
    "velocity": (-2, at.VELOCITY_MODE_SETTING, 500),
    "current": (-3, at.CURRENT_MODE_SETTING, 100),
}


def sets_out(drive: "Drive", pin: int, move: str, direction: int) -> None:
    """Enable a drive on a closed limit switch, and command it to go."""
    mode, address, value = MOVES[move]
    drive.write(INPUT_EXECUTION, LIMITS)
    drive.axis.pins = pin
    drive.run(10)
    drive.enable(mode=mode)
    drive.write(address, direction * value)
    drive.command(0x1F)
    drive.run(20)


@pytest.mark.parametrize("move", MOVES)
@pytest.mark.parametrize(("pin", "outwards"), [(NEGATIVE_PIN, 1), (POSITIVE_PIN, -1)])
def test_a_closed_limit_switch_lets_the_shaft_out(drive: "Drive", move: str, pin: int, outwards: int) -> None:
    sets_out(drive, pin, move, outwards)
    assert drive.reported == []
    assert drive.axis.position * outwards > 0


@pytest.mark.parametrize("move", MOVES)
@pytest.mark.parametrize("pin", [NEGATIVE_PIN, POSITIVE_PIN])
def test_a_closed_limit_switch_lets_the_shaft_no_further_in(drive: "Drive", move: str, pin: int) -> None:
    sets_out(drive, pin, move, 1 if pin == POSITIVE_PIN else -1)
    assert drive.reported == [0xFF07 if pin == POSITIVE_PIN else 0xFF06]
    assert drive.stands_in(PowerState.FAULT)
    assert abs(drive.axis.position) <= 2


def with_pin(drive: "Drive", function: int, execution: int) -> None:
    drive.write(INPUT_PINS[0], function)
    drive.write(INPUT_EXECUTION, execution)


def test_the_device_enable_input_lets_the_drive_be_enabled_and_takes_it_away(drive: "Drive") -> None:
    with_pin(drive, 4, ENABLE_BIT)
    drive.enable(mode=3)
    assert drive.stands_in(PowerState.SWITCH_ON_DISABLED)
    drive.axis.pins = 1
    drive.run(1)
    assert drive.stands_in(PowerState.SWITCH_ON_DISABLED), "closing it is no command"
    runs_at(drive, 3000)
    assert drive.stands_in(PowerState.OPERATION_ENABLED)
    drive.axis.pins = 0
    drive.run(1)
    assert drive.stands_in(PowerState.SWITCH_ON_DISABLED)
    assert not drive.axis.powered


@pytest.mark.parametrize(
    ("function", "execution"), [(4, 0), (15, ENABLE_BIT)], ids=["not executed", "no pin"]
)
def test_a_device_enable_that_does_not_act_is_not_needed(
    drive: "Drive", function: int, execution: int
) -> None:
    with_pin(drive, function, execution)
    drive.enable(mode=3)
    assert drive.stands_in(PowerState.OPERATION_ENABLED)


def test_the_quick_stop_input_stops_and_holds_until_it_is_open(drive: "Drive") -> None:
    with_pin(drive, 5, QUICK_STOP_BIT)
    runs_at(drive, 3000)
    drive.axis.pins = 1
    drive.run(1)
    assert drive.stands_in(PowerState.QUICK_STOP_ACTIVE)
    assert drive.runs_until(lambda: abs(drive.rpm) < 30) in range(45, 60)
    drive.command(0x0F)
    assert drive.stands_in(PowerState.QUICK_STOP_ACTIVE)
    drive.axis.pins = 0
    drive.run(10)
    assert drive.stands_in(PowerState.QUICK_STOP_ACTIVE), "opening it is no command"
    drive.command(0x0F)
    assert drive.stands_in(PowerState.OPERATION_ENABLED)
    drive.axis.pins = 1
    drive.run(1)
    drive.command(0x00)
    assert drive.stands_in(PowerState.SWITCH_ON_DISABLED), "a master may always take the power away"
    drive.command(0x06, 0x07, 0x0F)
    assert drive.stands_in(PowerState.SWITCH_ON_DISABLED)


def test_a_change_of_the_configuration_acts_as_a_change_of_the_pin(drive: "Drive") -> None:
    runs_at(drive, 3000)
    with_pin(drive, 5, QUICK_STOP_BIT)
    assert drive.stands_in(PowerState.OPERATION_ENABLED)
    drive.write(INPUT_POLARITY, QUICK_STOP_BIT)
    assert drive.stands_in(PowerState.QUICK_STOP_ACTIVE)
