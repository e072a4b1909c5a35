"""Each homing method on an axis whose switches, stops and index lie at known counts."""

from typing import Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.epos2.modes.homing_methods import METHODS
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.functions import INPUT_EXECUTION
from firmware_bridge.families.epos2.wire.modes import Mode
from hil_tests.lanes import examples
from hil_tests.unit.bench_axis.axis_bench import (
    GEAR,
    HOME_IN,
    HOME_OUT,
    NEGATIVE,
    POSITIVE,
    STOP_HIGH,
    STOP_LOW,
    TURN,
    AxisBench,
)

STIFF: Final = {"backlash": 0.0}
"""No play: motor and load are at the same angle, but for the gear's twist."""
STICKING: Final = 20
"""Range in counts within which a position regulator hunts: the motor's dry friction builds up over 16."""
EDGE: Final = 6
"""Tolerance in counts: a creeping shaft slips up to 5 in the ms of an edge; the gear twists by 1."""
BELOW, ON_HOME, ABOVE = 0.2, 0.5, 0.8
ON_NEGATIVE, ON_POSITIVE = -0.95, 1.95

# method, load's angle at the start (rad), the motor's count that is to be 0, and how far off it may be
ROWS: Final = (
    (1, BELOW, -3 * TURN, 0),
    (1, ON_NEGATIVE, -3 * TURN, 0),
    (2, BELOW, 7 * TURN, 0),
    (2, ON_POSITIVE, 7 * TURN, 0),
    (7, BELOW, 1 * TURN, 0),
    (7, ON_HOME, 1 * TURN, 0),
    (11, ABOVE, 3 * TURN, 0),
    (11, ON_HOME, 3 * TURN, 0),
    (17, BELOW, NEGATIVE, EDGE),
    (17, ON_NEGATIVE, NEGATIVE, EDGE),
    (18, BELOW, POSITIVE, EDGE),
    (18, ON_POSITIVE, POSITIVE, EDGE),
    (23, BELOW, HOME_IN, EDGE),
    (23, ON_HOME, HOME_IN, EDGE),
    (27, ABOVE, HOME_OUT, EDGE),
    (27, ON_HOME, HOME_OUT, EDGE),
    (33, BELOW, 0, 0),
    (34, BELOW, TURN, 0),
    (-1, BELOW, 8 * TURN, 0),
    (-2, BELOW, -4 * TURN, 0),
    # By what the current bends gear and stop: 4 A are 4 N m at the load, and the impact adds to it.
    (-3, BELOW, STOP_HIGH + 50, 30),
    (-4, BELOW, STOP_LOW - 50, 30),
    (35, BELOW, round(BELOW * GEAR * TURN / 6.283185307), 1),
)


def test_every_method_that_moves_stands_in_the_table() -> None:
    assert {row[0] for row in ROWS} | {0} == set(METHODS)


@pytest.mark.parametrize(("method", "start", "zero", "off"), ROWS)
def test_home_is_where_the_method_states(method: int, start: float, zero: int, off: int) -> None:
    bench = AxisBench(start * GEAR, STIFF)
    bench.enable()
    assert bench.homes(method) == pytest.approx(zero, abs=off)
    bench.run(500)
    assert abs(bench.read(od.POSITION_ACTUAL)) <= STICKING, "the shaft has come to rest there"
    assert bench.word & 0xB400 == 0x9400


@pytest.mark.parametrize("method", [1, 2, 7, -1, -2])
def test_homing_by_the_index_repeats_to_the_count(method: int) -> None:
    bench = AxisBench(BELOW * GEAR)
    bench.enable()
    zero = bench.homes(method)
    assert [bench.homes(method) for _ in range(3)] == [zero] * 3


@pytest.mark.parametrize("method", [17, 18, 23])
def test_homing_by_a_switch_repeats_to_what_gear_and_friction_leave(method: int) -> None:
    bench = AxisBench(BELOW * GEAR, STIFF)
    bench.write(od.HOMING_SPEED_ZERO, 10)
    bench.enable()
    first = bench.homes(method)
    for _ in range(3):
        assert abs(bench.homes(method) - first) <= 4


@pytest.mark.parametrize(
    ("method", "offset"),
    [(1, 700), (1, -200), (2, -700), (17, 700), (18, -700), (34, 700), (34, -700), (-2, 700), (-3, -700)],
)
def test_the_offset_is_gone_and_the_home_position_counts_there(method: int, offset: int) -> None:
    plain, moved = AxisBench(BELOW * GEAR), AxisBench(BELOW * GEAR)
    moved.write(od.HOME_OFFSET, offset)
    moved.write(at.HOME_POSITION, -123_456)
    for bench in (plain, moved):
        bench.enable()
    assert moved.homes(method) == plain.homes(method) + offset + 123_456
    moved.run(500)
    assert moved.read(od.POSITION_ACTUAL) == pytest.approx(-123_456, abs=STICKING)
    assert moved.read(od.POSITION_DEMAND) == -123_456


@pytest.mark.parametrize(
    ("method", "start", "zero", "off"), [(23, BELOW, HOME_IN, EDGE), (7, BELOW, TURN, 0)]
)
def test_a_cam_that_is_overrun_is_left_on_the_side_it_was_met(
    method: int, start: float, zero: int, off: int
) -> None:
    # 83 counts wide; from 300 rpm it takes 750 to turn round.
    bench = AxisBench(start * GEAR, {**STIFF, "home_high": 0.41})
    bench.enable()
    assert bench.homes(method) == pytest.approx(zero, abs=off)


@pytest.mark.parametrize(("method", "rpm"), [(33, 600), (34, -600)])
def test_an_index_that_is_passed_before_the_shaft_has_turned_round_does_not_count(
    method: int, rpm: int
) -> None:
    bench = AxisBench(ON_HOME * GEAR, STIFF)
    bench.write(od.HOMING_ACCELERATION, 1000)
    bench.write(od.PROFILE_ACCELERATION, 5000)
    bench.write(od.PROFILE_DECELERATION, 1000)
    bench.enable(Mode.PROFILE_VELOCITY)
    bench.write(od.TARGET_VELOCITY, rpm)
    bench.run(200)
    bench.write(od.MODE, Mode.HOMING)
    bench.starts(method)
    ends = []
    while not bench.word & 0x3000:
        bench.run(1)
        ends.append(bench.axis.encoder)
    farthest = max(ends) // TURN if rpm > 0 else -(-min(ends) // TURN)
    assert -bench.offset == farthest * TURN


@pytest.mark.parametrize("method", [-3, -4])
def test_the_demand_does_not_run_on_into_a_stop_that_is_found(method: int) -> None:
    bench = AxisBench(BELOW * GEAR, STIFF)
    bench.enable()
    bench.starts(method)
    ahead = 0
    while not bench.word & 0x3000:
        bench.run(1)
        ahead = max(ahead, abs(bench.read(at.FOLLOWING_ERROR)))
    # 150 ms of deceleration after that would be 750 counts.
    assert ahead < 500


@settings(max_examples=examples(40))
@given(start=st.floats(-0.98, 1.98), method=st.sampled_from((1, 2, -1, -2)))
def test_wherever_it_starts_the_same_index_is_found(start: float, method: int) -> None:
    bench = AxisBench(start * GEAR)
    bench.enable()
    assert bench.homes(method) == {1: -3, 2: 7, -1: 8, -2: -4}[method] * TURN


@settings(max_examples=examples(25))
@given(start=st.floats(-0.85, 1.85), method=st.sampled_from((33, 34)))
def test_the_next_index_in_the_direction_is_taken(start: float, method: int) -> None:
    bench = AxisBench(start * GEAR)
    bench.enable()
    count = bench.axis.encoder
    zero = bench.homes(method)
    assert zero % TURN == 0
    below = count // TURN * TURN
    # The shaft may stir by a few counts before it moves off.
    nearby = {below, below + TURN} if count - below < 5 or below + TURN - count < 5 else set()
    assert zero in nearby | {below if method == 33 else below + TURN}


@pytest.mark.parametrize("method", [1, 2, 17, 18])
def test_the_limit_switch_that_is_looked_for_is_no_fault(method: int) -> None:
    bench = AxisBench(BELOW * GEAR)
    bench.write(INPUT_EXECUTION, 0x0003)
    bench.write(od.HOME_OFFSET, 1500 if method in {1, 17} else -1500)
    bench.enable()
    bench.homes(method)
    assert bench.control.state is PowerState.OPERATION_ENABLED
