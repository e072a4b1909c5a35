"""Each move of the arm ends in its time on the emulated sketch, with all of its steps done."""

from hypothesis import example, given, settings
from hypothesis import strategies as st

from firmware_bridge.families.ar2.driver.slices import Slice, slice_of
from firmware_bridge.families.ar2.guard import LONGEST_MS, SHORTEST_MS, SLOWEST, move_of
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.lanes import examples
from hil_tests.unit.arduino.ar2_bench import Bench

MOST = (57, 71, 72, 59, 28, 28)
"""Steps of 0.2 rad/s in 100 ms, and one."""
counts = st.tuples(*(st.integers(-3 * high, 3 * high) for high in MOST))


@settings(max_examples=examples(200))
@given(wanted=counts, move_ms=st.integers(10, 100))
@example(wanted=MOST, move_ms=10)
@example(wanted=(1, 0, 0, 0, 0, 0), move_ms=100)
@example(wanted=(0, -1, 72, 0, 0, 0), move_ms=60)
def test_a_move_ends_in_its_time_and_the_guard_thinks_so_too(wanted: tuple[int, ...], move_ms: int) -> None:
    found = slice_of(wanted, MOST, move_ms * MILLISECOND)
    if found is None:
        assert max(map(abs, wanted)) == 0 or move_ms < 20
        return
    assert all(
        0 <= abs(it) <= min(abs(all_), high) for it, all_, high in zip(found.steps, wanted, MOST, strict=True)
    )
    assert all(it * all_ >= 0 for it, all_ in zip(found.steps, wanted, strict=True))
    bench = Bench()
    stated = bench.ask(found.line, within=SECOND)
    assert stated == b"command recieved"
    assert bench.moved()[:6] == list(found.steps)
    assert bench.span_us() <= 1_000 * move_ms
    read = move_of(found.line)
    assert read is not None
    assert read.steps == found.steps
    assert SLOWEST <= read.percent <= 100.0
    assert read.pulse_ms >= SHORTEST_MS
    assert read.lasts_ms <= min(move_ms, LONGEST_MS) + 1e-6


def test_what_is_too_far_for_one_move_is_cut_for_all_joints_alike() -> None:
    found = slice_of((100, -50, 10, 0, 0, 0), (20, 71, 72, 59, 28, 28), 100 * MILLISECOND)
    assert found is not None
    assert found.steps == (20, -10, 2, 0, 0, 0)


def test_who_is_there_is_reported_nothing() -> None:
    assert slice_of((0,) * 6, MOST, 60 * MILLISECOND) is None


def test_one_step_is_as_slow_as_the_board_can_count() -> None:
    assert slice_of((1, 0, 0, 0, 0, 0), MOST, 100 * MILLISECOND) == Slice(
        (1, 0, 0, 0, 0, 0), 20_000.0 / 15_000.0
    )
