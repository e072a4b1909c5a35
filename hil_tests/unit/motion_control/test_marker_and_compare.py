"""Position marker and position compare: an edge keeps a position, a position gives a pulse."""

from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.servo.axis import ServoAxis
from emulators.servo.compare import compare
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.units import MILLISECOND

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

CAPTURED, EDGE, MODE, COUNTER, NEWER, OLDER = (Address(0x2074, sub) for sub in range(1, 7))
WORD, REFERENCE, WIDTH, REPETITIONS, PULSE = (Address(0x207A, sub) for sub in range(1, 6))
PIN, MARKER, COMPARE = 1 << 0, 3, 1
BOTH, RISING, FALLING = 0, 1, 2
CONTINUOUS, SINGLE, MULTIPLE = 0, 1, 2
ENABLED, SEQUENCE = 1, 1 << 1
POSITIVE_SIDE, BOTH_SIDES = 1 << 3, 2 << 3
UPWARDS, BOTH_WAYS = 1 << 5, 2 << 5


def edges(drive: "Drive", count: int) -> list[int]:
    """Turn the shaft, give so many edges 7 ms apart, and return where it was at each."""
    seen = []
    for _ in range(count):
        drive.axis.pins ^= PIN
        drive.run(1)
        seen.append(drive.axis.position)
        drive.run(6)
    return seen


@pytest.fixture
def turning(drive: "Drive") -> "Drive":
    drive.write(Address(0x2070, 1), MARKER)
    drive.write(Address(0x2079, 1), COMPARE)
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 600)
    drive.run(100)
    return drive


def history(drive: "Drive") -> list[int]:
    return [drive.read(address) for address in (CAPTURED, NEWER, OLDER)]


@pytest.mark.parametrize(("edge", "counting"), [(BOTH, (0, 1, 2, 3)), (RISING, (0, 2)), (FALLING, (1, 3))])
def test_the_marker_keeps_the_exact_count_of_the_edges_that_count(
    turning: "Drive", edge: int, counting: tuple[int, ...]
) -> None:
    turning.write(EDGE, edge)
    seen = edges(turning, 4)
    wanted = [seen[at] for at in counting][::-1]
    assert turning.read(COUNTER) == len(counting)
    assert history(turning)[: len(wanted)] == wanted[:3]


@pytest.mark.parametrize(("mode", "counted"), [(CONTINUOUS, 6), (SINGLE, 1), (MULTIPLE, 3)])
def test_the_modes_count_so_far_and_the_counter_arms_again(turning: "Drive", mode: int, counted: int) -> None:
    turning.write(MODE, mode)
    seen = edges(turning, 6)
    assert turning.read(COUNTER) == counted
    assert turning.read(CAPTURED) == seen[counted - 1]
    turning.write(COUNTER, 0)
    (later,) = edges(turning, 1)
    assert (turning.read(COUNTER), turning.read(CAPTURED)) == (1, later)


def test_the_counter_takes_nothing_but_0_and_a_reset_clears_it(turning: "Drive") -> None:
    edges(turning, 3)
    with pytest.raises(SdoAbort):
        turning.write(COUNTER, 1)
    turning.control.reset()
    assert [turning.read(address) for address in (COUNTER, CAPTURED, NEWER)] == [0, 0, 0]


def test_the_marker_needs_its_bit_in_the_execution_mask(turning: "Drive") -> None:
    turning.write(Address(0x2071, 4), 0)
    edges(turning, 2)
    assert turning.read(COUNTER) == 0


def pulses(drive: "Drive", milliseconds: int) -> list[tuple[int, int]]:
    """Return where the output went up, and for how many ms it stayed."""
    found: list[tuple[int, int]] = []
    up = False
    for _ in range(milliseconds):
        drive.run(1)
        level = bool(drive.axis.outputs & PIN)
        if level and not up:
            found.append((drive.axis.position, 1))
        elif level:
            found[-1] = (found[-1][0], found[-1][1] + 1)
        up = level
    return found


def set_up(
    drive: "Drive", word: int, *, reference: int, width: int = 0, times: int = 0, us: int = 1000
) -> None:
    values = ((REFERENCE, reference), (WIDTH, width), (REPETITIONS, times), (PULSE, us), (WORD, word))
    for address, value in values:
        drive.write(address, value)


def test_a_single_position_gives_one_pulse_of_its_width(turning: "Drive") -> None:
    ahead = turning.axis.position + 900
    set_up(turning, ENABLED | UPWARDS, reference=ahead, us=4_500)
    ((where, width),) = pulses(turning, 200)
    assert ahead <= where <= ahead + 21  # 600 rpm are 20 qc in each ms
    assert width == 5


def test_a_sequence_gives_pulses_at_its_intervals_on_its_side(turning: "Drive") -> None:
    ahead = turning.axis.position + 500
    set_up(turning, ENABLED | SEQUENCE | POSITIVE_SIDE | UPWARDS, reference=ahead, width=300, times=3)
    found = pulses(turning, 300)
    assert [(where - ahead) // 300 for where, _ in found] == [0, 1, 2, 3]
    assert all((where - ahead) % 300 < 21 for where, _ in found)


def test_directions_that_do_not_count_give_none(turning: "Drive") -> None:
    set_up(turning, ENABLED, reference=turning.axis.position + 500)  # downwards only
    assert pulses(turning, 60) == []
    turning.write(od.TARGET_VELOCITY, -600)
    assert len(pulses(turning, 200)) == 1
    turning.write(WORD, 0)
    turning.write(od.TARGET_VELOCITY, 600)
    assert pulses(turning, 300) == []


def test_both_edges_of_a_pulse_are_events_at_their_tick(turning: "Drive") -> None:
    set_up(turning, ENABLED | BOTH_WAYS, reference=turning.axis.position + 700, us=3_000)
    begun = turning.bank.now
    events = []
    while turning.bank.now < begun + 100 * MILLISECOND:
        now, woken = turning.bank.advance(begun + 100 * MILLISECOND)
        if woken:
            events.append(now)
    assert len(events) == 2
    assert events[1] - events[0] == 3 * MILLISECOND


@given(
    steps=st.lists(st.integers(-50, 50), max_size=60),
    reference=st.integers(-100, 100),
    width=st.integers(0, 40),
    times=st.integers(0, 5),
    direction=st.integers(1, 3),
)
def test_a_position_is_met_by_the_step_that_arrives_at_it(
    steps: list[int], reference: int, width: int, times: int, direction: int
) -> None:
    axis = ServoAxis("one", 2000)
    axis.compare_reference, axis.compare_width, axis.compare_direction = reference, width, direction
    axis.compare_first, axis.compare_last, axis.compare_pulse_ms = -times, times, 1
    marks = {reference + width * k for k in range(-times, times + 1)} if width else {reference}
    for step in steps:
        way = (
            range(axis.position + 1, axis.position + step + 1)
            if step > 0
            else range(axis.position + step, axis.position)
        )
        axis.step, axis.position = step, axis.position + step
        counts = bool(direction & (2 if step > 0 else 1))
        before = axis.compare_hits
        compare(axis)
        assert (axis.compare_hits > before) is (counts and not marks.isdisjoint(way))
