"""The course of a homing: its start, its end, its status bits, and all that cuts it short."""

import pytest

from emulators.epos2.modes.homing_methods import METHODS
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.functions import INPUT_EXECUTION, INPUT_PINS
from firmware_bridge.families.epos2.wire.modes import Mode
from hil_tests.rows import every
from hil_tests.unit.bench_axis.axis_bench import ENABLED, GEAR, START, TURN, AxisBench

REACHED, ATTAINED, FAILED, REFERENCED = 1 << 10, 1 << 12, 1 << 13, 1 << 15
BITS = REACHED | ATTAINED | FAILED | REFERENCED
HALT = 1 << 8


@pytest.fixture
def bench() -> AxisBench:
    made = AxisBench(0.2 * GEAR)
    made.enable()
    return made


def bits(bench: AxisBench) -> int:
    return bench.word & BITS


def test_the_status_of_a_homing_from_start_to_end(bench: AxisBench) -> None:
    bench.run(20)
    assert bits(bench) == REACHED, "at rest, nothing found yet"
    bench.starts(1)
    assert bits(bench) == 0
    bench.run(500)
    assert bits(bench) == 0
    bench.runs_until(lambda: bool(bits(bench)))
    assert bits(bench) == REACHED | ATTAINED | REFERENCED
    bench.write(od.CONTROLWORD, ENABLED)
    assert bits(bench) == REACHED | ATTAINED | REFERENCED


def test_nothing_moves_without_a_rising_edge_of_bit_4() -> None:
    bench = AxisBench()
    bench.write(od.MODE, Mode.HOMING)
    for word in (0x06, 0x07, START):
        bench.write(od.CONTROLWORD, word)
    before = bench.axis.encoder
    bench.write(od.CONTROLWORD, START)
    bench.run(300)
    assert abs(bench.axis.encoder - before) < 20


@pytest.mark.parametrize("word", [ENABLED, START | HALT], ids=["bit 4 off", "halt"])
def test_it_is_given_up_and_comes_to_rest_with_the_homing_acceleration(bench: AxisBench, word: int) -> None:
    bench.starts(1)
    bench.run(700)
    assert bench.axis.velocity_average < -(5 << bench.axis.fraction)
    bench.write(od.CONTROLWORD, word)
    # 300 rpm at 2000 rpm/s.
    assert bench.runs_until(lambda: bool(bench.word & REACHED)) in range(148, 153)
    bench.run(500)
    assert bits(bench) == REACHED
    bench.write(od.CONTROLWORD, START)
    bench.run(100)
    assert bits(bench) == (0 if word == ENABLED else REACHED), "a halt does not wait: it takes a new edge"
    bench.homes(1)


def test_a_start_in_a_halt_is_not_received(bench: AxisBench) -> None:
    bench.write(od.CONTROLWORD, ENABLED | HALT)
    bench.write(od.CONTROLWORD, START | HALT)
    bench.run(100)
    assert bits(bench) == REACHED


def test_a_disabled_drive_has_given_its_homing_up(bench: AxisBench) -> None:
    bench.starts(1)
    bench.run(500)
    bench.write(od.CONTROLWORD, 0)
    assert bench.axis.index_watched == bench.axis.current_watched_ma == 0
    bench.run(500)
    bench.enable()
    bench.run(500)
    assert bits(bench) == REACHED


def test_no_homing_needed_counts_as_referenced_where_it_is(bench: AxisBench) -> None:
    position = bench.read(od.POSITION_ACTUAL)
    bench.starts(0)
    assert bits(bench) & ~REACHED == ATTAINED | REFERENCED
    assert bench.read(od.POSITION_ACTUAL) == position


@every("method", sorted(set(range(-128, 128)) - set(METHODS)))
def test_other_methods_are_refused(method: int) -> None:
    bench = SHARED
    with pytest.raises(SdoAbort) as refusal:
        bench.write(od.HOMING_METHOD, method)
    assert refusal.value.code is AbortCode.RANGE
    assert bench.read(od.HOMING_METHOD) == 7


SHARED = AxisBench()


@pytest.mark.parametrize(
    ("method", "pin"), [(1, 6), (17, 6), (2, 5), (18, 5), (7, 4), (11, 4), (23, 4), (27, 4)]
)
def test_a_method_whose_switch_has_no_pin_fails_at_once(bench: AxisBench, method: int, pin: int) -> None:
    bench.write(INPUT_PINS[pin - 1], 15)
    before = bench.axis.encoder
    bench.starts(method)
    bench.run(500)
    assert bits(bench) == REACHED | FAILED
    assert abs(bench.axis.encoder - before) < 20


@pytest.mark.parametrize("method", [1, 2, 7, 11, 33, 34, -1, -2])
def test_a_method_by_the_index_needs_a_sensor_that_has_one(method: int) -> None:
    bench = AxisBench()
    bench.write(at.SENSOR_TYPE, 2)
    bench.enable()
    bench.starts(method)
    bench.run(100)
    assert bits(bench) == REACHED | FAILED


def test_values_that_only_an_edited_memory_can_hold_move_nothing(bench: AxisBench) -> None:
    bench.store.set(od.HOMING_METHOD, 5)
    bench.write(od.CONTROLWORD, START)
    bench.run(10)
    assert bits(bench) == REACHED | FAILED
    bench.store.set(od.MODE, 99)
    bench.control.reset()
    bench.run(20)
    for word in (0x06, 0x07, ENABLED, START):
        bench.write(od.CONTROLWORD, word)
    bench.run(100)
    assert bench.control.state is PowerState.OPERATION_ENABLED
    assert abs(bench.read(od.POSITION_ACTUAL)) < 20


def test_the_next_start_forgets_a_homing_error(bench: AxisBench) -> None:
    bench.write(INPUT_PINS[5], 15)
    bench.starts(17)
    assert bits(bench) & FAILED
    bench.starts(35)
    assert bits(bench) & ~REACHED == ATTAINED | REFERENCED


@pytest.mark.emergency(0xFF07)
def test_the_wrong_limit_switch_is_a_fault_and_a_homing_error(bench: AxisBench) -> None:
    # Someone has swapped the wires of the limit switches.
    bench.write(INPUT_PINS[4], 0)
    bench.write(INPUT_PINS[5], 1)
    bench.write(INPUT_EXECUTION, 0x0003)
    bench.starts(17)
    bench.runs_until(lambda: bench.control.state is PowerState.FAULT)
    assert bench.word & (ATTAINED | FAILED | REFERENCED) == FAILED
    assert bench.read(Address(0x1003, 1)) == 0xFF07


@pytest.mark.emergency(0x8611)
def test_a_stop_before_the_switch_is_a_following_error_and_a_homing_error(bench: AxisBench) -> None:
    bench.starts(11)
    bench.runs_until(lambda: bench.control.state is PowerState.FAULT)
    assert bench.word & (ATTAINED | FAILED | REFERENCED) == FAILED
    assert bench.read(Address(0x1003, 1)) == 0x8611


def test_software_position_limits_rest_in_a_homing(bench: AxisBench) -> None:
    bench.write(od.MIN_POSITION_LIMIT, -10)
    bench.write(od.MAX_POSITION_LIMIT, 10)
    bench.homes(1)
    assert bench.control.state is PowerState.OPERATION_ENABLED


def test_the_reference_outlives_modes_and_power_and_ends_with_a_reset(bench: AxisBench) -> None:
    bench.homes(34)
    bench.write(od.CONTROLWORD, 0)
    bench.run(500)
    bench.enable(Mode.PROFILE_VELOCITY)
    bench.run(200)
    assert bench.word & REFERENCED
    bench.write(od.CONTROLWORD, 0)
    bench.write(od.MODE, Mode.HOMING)
    assert bits(bench) == REACHED | ATTAINED | REFERENCED
    bench.control.reset()
    assert not bench.word & REFERENCED


@pytest.mark.parametrize("code", [0x7320, 0xFF02, 0xFF03, 0xFF0A])
def test_an_error_of_the_encoder_ends_the_reference(bench: AxisBench, code: int) -> None:
    bench.homes(34)
    bench.control.communication_fault(code)
    bench.run(10)
    assert not bench.word & (REFERENCED | ATTAINED)


def test_an_offset_out_of_the_count_is_a_homing_error(bench: AxisBench) -> None:
    bench.write(at.HOME_POSITION, 2**31 - 10)
    bench.homes(34)
    bench.write(od.HOME_OFFSET, 2**31 - 1)
    bench.starts(34)
    bench.runs_until(lambda: bool(bits(bench) & (FAILED | ATTAINED)))
    assert bits(bench) & (FAILED | ATTAINED) == FAILED


def test_positions_after_a_homing_count_from_home(bench: AxisBench) -> None:
    zero = bench.homes(2)
    assert zero == 7 * TURN
    bench.write(od.CONTROLWORD, ENABLED)
    bench.write(od.MODE, Mode.PROFILE_POSITION)
    bench.run(500)
    bench.write(od.PROFILE_ACCELERATION, 2000)
    bench.write(od.PROFILE_DECELERATION, 2000)
    bench.write(od.TARGET_POSITION, -3000)
    bench.write(od.CONTROLWORD, START)
    bench.runs_until(lambda: bool(bench.word & REACHED))
    bench.run(500)
    assert bench.axis.encoder == pytest.approx(zero - 3000, abs=20)
