"""The path: the documented sequence, exact knots, what begins it and what ends it."""

from itertools import pairwise
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.epos2.modes.interpolation_buffer import BUFFER_POSITION
from emulators.epos2.objects.device_profile import BUFFER_FREE
from emulators.servo.scaling import speed_units
from emulators.servo.spline import Knot, segment
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from hil_tests.lanes import examples
from hil_tests.unit.motion_control.conftest import make_drive
from hil_tests.unit.motion_control.interpolated_position.conftest import (
    ACTIVE,
    ACTIVE_BIT,
    ENABLED,
    ERROR,
    REACHED,
    UNDERFLOW_WARNING,
    feed,
    prepared,
    status,
)

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive


def test_the_documented_sequence(ready: "Drive") -> None:
    assert status(ready) == ENABLED | UNDERFLOW_WARNING
    feed(ready, (0, 0, 50), (100, 120, 50), (300, 120, 100), (500, 0, 0))
    assert ready.read(BUFFER_FREE) == 60
    assert ready.read(BUFFER_POSITION) == 4
    assert status(ready) == ENABLED
    ready.command(0x1F)
    assert ready.statusword & (ACTIVE_BIT | REACHED) == ACTIVE_BIT
    assert status(ready) & (ACTIVE | ENABLED) == ACTIVE | ENABLED
    seen = {}
    for ms in range(1, 220):
        ready.run(1)
        seen[ms] = ready.read(od.POSITION_DEMAND)
        # The run begins in the midst of a ms.
        if ms == 199:
            assert ready.statusword & ACTIVE_BIT
    begun = next(ms for ms in range(1, 10) if seen[ms + 49] == 100)
    assert [seen[begun - 1 + ms] for ms in (50, 100, 200)] == [100, 300, 500]
    assert ready.statusword & (ACTIVE_BIT | REACHED) == REACHED
    assert status(ready) == ENABLED | UNDERFLOW_WARNING
    assert ready.read(BUFFER_FREE) == 64
    assert ready.reported == []
    assert ready.stands_in(PowerState.OPERATION_ENABLED)


@pytest.mark.parametrize("word", [0x011F, 0x000F])
def test_halt_and_bit_4_end_the_path_with_the_profile_deceleration(ready: "Drive", word: int) -> None:
    feed(ready, (0, 0, 100), *[(1000 + 2000 * k, 600, 100) for k in range(20)])
    ready.command(0x1F)
    ready.run(250)
    ready.command(word)
    assert not ready.statusword & (ACTIVE_BIT | REACHED)
    assert status(ready) == ENABLED | UNDERFLOW_WARNING
    # 15 000 rpm/s bring 600 rpm to rest in 40 ms.
    assert ready.runs_until(lambda: bool(ready.statusword & REACHED)) == pytest.approx(40, abs=2)
    ready.command(0x1F & ~0x10)
    here = ready.read(od.POSITION_DEMAND)
    ready.run(200)
    assert ready.read(od.POSITION_DEMAND) == here
    assert ready.reported == []


def test_a_high_bit_4_does_not_run_what_is_fed_later(ready: "Drive") -> None:
    feed(ready, (0, 0, 20), (100, 0, 0))
    ready.command(0x1F)
    ready.run(60)
    here = ready.read(od.POSITION_DEMAND)
    assert here == 100
    feed(ready, (100, 0, 20), (200, 0, 0))
    ready.run(60)
    assert ready.read(od.POSITION_DEMAND) == here
    ready.command(0x0F, 0x1F)
    ready.run(60)
    assert ready.read(od.POSITION_DEMAND) == 200


KNOTS = st.lists(
    st.tuples(st.integers(-400, 400), st.integers(-900, 900), st.integers(1, 60)), min_size=1, max_size=20
)


@settings(max_examples=examples(60))
@given(steps=KNOTS, ahead=st.integers(2, 6))
def test_any_path_within_the_limits_passes_every_knot_and_is_continuous(
    steps: list[tuple[int, int, int]], ahead: int
) -> None:
    drive = prepared(make_drive())
    drive.write(od.MAX_FOLLOWING_ERROR, 0xFFFFFFFF)
    records, position = [(0, 0, 1 + steps[0][2])], 0
    for way, velocity, ms in steps:
        position += way
        records.append((position, velocity, ms))
    records.append((position, 0, 0))
    waiting = list(records)
    feed(drive, *waiting[:ahead])
    del waiting[:ahead]
    drive.command(0x1F)
    demands: list[int] = []
    while drive.statusword & ACTIVE_BIT:
        if waiting and drive.read(BUFFER_POSITION) < ahead:
            feed(drive, waiting.pop(0))
        drive.run(1)
        demands.append(drive.axis.position_demand)
    if drive.reported:
        # A segment was faster than 25 000 rpm.
        assert drive.reported == [ERROR]
        return
    fraction, at_ms = drive.axis.fraction, 0
    knots = [Knot(knot << fraction, speed_units(drive.axis, rpm)) for knot, rpm, _ in records]
    segments = [segment(a, b, ms) for (a, b), (_, _, ms) in zip(pairwise(knots), records, strict=False)]
    speeds = [after - before for before, after in pairwise([0, *demands])]
    # No step of the velocity is larger than the path's accelerations make it; 4 units are rounding.
    sharpest = max(each.sharpest() for each in segments) + 4
    first_and_last = abs(speeds[0]), abs(knots[-1].velocity)
    assert max(abs(b - a) for a, b in pairwise([0, *speeds])) <= max(sharpest, *first_and_last)
    assert max(map(abs, speeds)) <= max(each.fastest() for each in segments) + 4
    begun = next(ms for ms in (0, 1) if demands[ms + records[0][2] - 1] == records[1][0] << fraction)
    for (_, _, ms), (knot, _, _) in pairwise(records):
        at_ms += ms
        assert demands[begun + at_ms - 1] == knot << fraction
    assert drive.axis.position_demand == position << fraction


def test_a_rising_bit_4_in_a_halt_starts_nothing(ready: "Drive") -> None:
    feed(ready, (0, 0, 20), (100, 0, 0))
    for words, position in (((0x010F, 0x011F), 0), ((0x001F,), 0), ((0x000F, 0x001F), 100)):
        for word in words:
            ready.carries((od.CONTROLWORD, word))
        ready.run(60)
        assert ready.read(od.POSITION_DEMAND) == position


def test_a_written_word_with_bit_4_starts_the_path_once_the_halt_is_over(ready: "Drive") -> None:
    feed(ready, (0, 0, 20), (100, 0, 0))
    for word, position in ((0x010F, 0), (0x011F, 0), (0x001F, 100)):
        ready.command(word)
        ready.run(60)
        assert ready.read(od.POSITION_DEMAND) == position


def test_a_last_record_with_a_velocity_brakes_from_there(ready: "Drive") -> None:
    feed(ready, (0, 0, 100), (1000, 600, 0))
    ready.command(0x1F)
    ready.run(101)
    assert ready.read(od.POSITION_DEMAND) == pytest.approx(1000, abs=21)
    # 15 000 rpm/s bring 20 qc/ms to rest in 40 ms and 400 qc.
    ms = ready.runs_until(lambda: bool(ready.statusword & REACHED))
    assert ms == pytest.approx(40, abs=3)
    assert ready.read(od.POSITION_DEMAND) == pytest.approx(1400, abs=15)
    assert ready.reported == []
