"""Interpolated position mode: the documented sequence, exact knots, the buffer's levels, errors."""

from itertools import pairwise
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.epos2.interpolation import (
    BUFFER_CLEAR,
    BUFFER_POSITION,
    BUFFER_STATUS,
    DATA_RECORD,
    OVERFLOW_LEVEL,
    UNDERFLOW_LEVEL,
)
from emulators.epos2.profile import BUFFER_FREE, BUFFER_SIZE
from emulators.servo.scaling import speed_units
from emulators.servo.spline_plan import Knot, segment
from firmware_bridge.wire.abort import AbortCode, SdoAbort
from firmware_bridge.wire.cia402 import State
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.functions import INPUT_EXECUTION
from firmware_bridge.wire.epos2.pvt import PvtRecord
from hil_tests.unit.motion_control.conftest import make_drive

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

REACHED, ACTIVE_BIT = 0x0400, 0x1000
UNDERFLOW_WARNING, OVERFLOW_WARNING, VELOCITY_WARNING, ACCELERATION_WARNING = 1, 2, 4, 8
UNDERFLOW, OVERFLOW, VELOCITY, ACCELERATION = 0x100, 0x200, 0x400, 0x800
ENABLED, ACTIVE = 0x4000, 0x8000
ERROR = 0xFF0C


@pytest.fixture
def ready(drive: "Drive") -> "Drive":
    """Facts 4.5: mode 7, 0x06, 0x0F, buffer enabled."""
    return prepared(drive)


def prepared(drive: "Drive") -> "Drive":
    drive.store.set(BUFFER_SIZE, 64)
    drive.enable(mode=7)
    drive.write(BUFFER_CLEAR, 1)
    return drive


def feed(drive: "Drive", *records: tuple[int, int, int]) -> None:
    for position, velocity, ms in records:
        drive.write(DATA_RECORD, int.from_bytes(PvtRecord(position, velocity, ms).encode(), "little"))


def status(drive: "Drive") -> int:
    return drive.read(BUFFER_STATUS)


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
        seen[ms] = ready.read(at.POSITION_DEMAND)
        # The run begins in the midst of a ms.
        if ms == 199:
            assert ready.statusword & ACTIVE_BIT
    begun = next(ms for ms in range(1, 10) if seen[ms + 49] == 100)
    assert [seen[begun - 1 + ms] for ms in (50, 100, 200)] == [100, 300, 500]
    assert ready.statusword & (ACTIVE_BIT | REACHED) == REACHED
    assert status(ready) == ENABLED | UNDERFLOW_WARNING
    assert ready.read(BUFFER_FREE) == 64
    assert ready.reported == []
    assert ready.stands_in(State.OPERATION_ENABLED)


@pytest.mark.parametrize("count", [0, 1])
@pytest.mark.emergency(0xFF0C)
def test_fewer_than_two_records_are_an_underflow(ready: "Drive", count: int) -> None:
    feed(ready, *[(0, 0, 10)] * count)
    ready.command(0x1F)
    ready.run(20)
    assert ready.reported == [ERROR]
    assert ready.stands_in(State.FAULT)
    assert status(ready) == UNDERFLOW


@pytest.mark.emergency(0xFF0C)
def test_a_path_that_is_not_fed_stops_with_the_quick_stop_ramp(ready: "Drive") -> None:
    feed(ready, (0, 0, 100), (1000, 600, 100), (3000, 600, 100))
    ready.command(0x1F)
    ready.run(199)
    assert ready.reported == []
    fastest = 0
    before = ready.read(at.POSITION_DEMAND)
    while not ready.stands_in(State.FAULT):
        ready.run(1)
        here = ready.read(at.POSITION_DEMAND)
        fastest, before = max(fastest, abs(here - before)), here
    assert ready.reported == [ERROR]
    assert status(ready) == UNDERFLOW
    # 600 rpm are 20 qc/ms: nothing jumps; 60 000 rpm/s brake it in 10 ms.
    assert fastest <= 22
    assert before == pytest.approx(3100, abs=15)
    assert not ready.statusword & ACTIVE_BIT


@pytest.mark.emergency(0xFF0C)
def test_after_an_error_the_buffer_must_be_enabled_anew(ready: "Drive") -> None:
    ready.command(0x1F)
    ready.run(20)
    assert ready.stands_in(State.FAULT)
    with pytest.raises(SdoAbort) as refused:
        feed(ready, (0, 0, 10))
    assert refused.value.code is AbortCode.DEVICE_STATE
    ready.command(0x80, 0x06, 0x0F)
    ready.write(BUFFER_CLEAR, 1)
    assert status(ready) == ENABLED | UNDERFLOW_WARNING
    here = ready.read(at.POSITION_DEMAND)
    feed(ready, (here, 0, 100), (here + 500, 0, 0))
    ready.command(0x1F)
    ready.run(150)
    assert ready.read(at.POSITION_DEMAND) == here + 500
    assert ready.reported == [ERROR, 0]


@pytest.mark.parametrize(
    ("count", "bits"),
    [(3, UNDERFLOW_WARNING), (4, 0), (60, 0), (61, OVERFLOW_WARNING), (64, OVERFLOW_WARNING)],
)
def test_the_levels_warn(ready: "Drive", count: int, bits: int) -> None:
    feed(ready, *[(0, 0, 10)] * count)
    assert status(ready) == ENABLED | bits


def test_the_levels_are_objects(ready: "Drive") -> None:
    ready.write(UNDERFLOW_LEVEL, 2)
    ready.write(OVERFLOW_LEVEL, 1)
    feed(ready, (0, 0, 10), (0, 0, 10))
    assert status(ready) == ENABLED | OVERFLOW_WARNING


@pytest.mark.emergency(0xFF0C)
def test_the_65th_record_is_an_overflow(ready: "Drive") -> None:
    feed(ready, *[(0, 0, 10)] * 64)
    assert ready.read(BUFFER_FREE) == 0
    with pytest.raises(SdoAbort) as refused:
        feed(ready, (0, 0, 10))
    assert refused.value.code is AbortCode.OUT_OF_MEMORY
    ready.control.refresh(ready.now)
    ready.run(20)
    assert ready.reported == [ERROR]
    assert ready.stands_in(State.FAULT)
    assert status(ready) == OVERFLOW


def test_a_full_buffer_in_another_mode_is_no_fault(ready: "Drive") -> None:
    ready.write(at.MODE, 1)
    feed(ready, *[(0, 0, 10)] * 64)
    with pytest.raises(SdoAbort):
        feed(ready, (0, 0, 10))
    ready.control.refresh(ready.now)
    ready.run(20)
    assert ready.reported == []


@pytest.mark.parametrize(
    ("limit", "value", "bits", "error"),
    [
        (at.PROFILE_VELOCITY, 900, 0, 0),
        (at.PROFILE_VELOCITY, 899, VELOCITY_WARNING, 0),
        (at.PROFILE_ACCELERATION, 36_000, 0, 0),
        (at.PROFILE_ACCELERATION, 35_999, ACCELERATION_WARNING, 0),
        (at.MAX_PROFILE_VELOCITY, 900, 0, 0),
        (at.MAX_PROFILE_VELOCITY, 899, 0, VELOCITY),
        (at.MAX_ACCELERATION, 36_000, 0, 0),
        (at.MAX_ACCELERATION, 35_999, ACCELERATION_WARNING, ACCELERATION),
    ],
)
@pytest.mark.emergency(0xFF0C)
def test_limits_of_velocity_and_acceleration(
    ready: "Drive", limit: at.Address, value: int, bits: int, error: int
) -> None:
    # From rest to rest over 2000 qc in 100 ms: 1.5 x 20 qc/ms = 900 rpm, and 6 x 2000/100^2 = 1.2 qc/ms2.
    ready.write(at.PROFILE_ACCELERATION, 100_000)
    ready.write(limit, value)
    feed(ready, (0, 0, 100), (2000, 0, 0))
    ready.command(0x1F)
    ready.run(50)
    if error:
        assert status(ready) == error
        assert ready.reported == [ERROR]
        assert ready.read(at.POSITION_DEMAND) == 0
    else:
        assert status(ready) & ~UNDERFLOW_WARNING == ENABLED | ACTIVE | bits
        assert ready.reported == []


@pytest.mark.emergency(0xFF0C)
def test_a_first_record_far_away_is_a_velocity_error_and_moves_nothing(ready: "Drive") -> None:
    feed(ready, (5000, 0, 100), (5100, 0, 0))
    ready.command(0x1F)
    ready.run(50)
    assert status(ready) == VELOCITY
    assert ready.read(at.POSITION_DEMAND) == pytest.approx(0, abs=1)


@pytest.mark.emergency(0xFF09)
def test_a_record_beyond_the_software_limits_is_not_run_to(ready: "Drive") -> None:
    ready.write(at.MAX_POSITION_LIMIT, 1000)
    feed(ready, (0, 0, 100), (1000, 0, 100), (1001, 0, 0))
    ready.command(0x1F)
    ready.run(250)
    assert ready.reported == [0xFF09]
    assert ready.read(at.POSITION_DEMAND) <= 1000


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
    here = ready.read(at.POSITION_DEMAND)
    ready.run(200)
    assert ready.read(at.POSITION_DEMAND) == here
    assert ready.reported == []


def test_a_high_bit_4_does_not_run_what_is_fed_later(ready: "Drive") -> None:
    feed(ready, (0, 0, 20), (100, 0, 0))
    ready.command(0x1F)
    ready.run(60)
    here = ready.read(at.POSITION_DEMAND)
    assert here == 100
    feed(ready, (100, 0, 20), (200, 0, 0))
    ready.run(60)
    assert ready.read(at.POSITION_DEMAND) == here
    ready.command(0x0F, 0x1F)
    ready.run(60)
    assert ready.read(at.POSITION_DEMAND) == 200


def test_records_may_be_there_before_the_drive_is_enabled(drive: "Drive") -> None:
    drive.store.set(BUFFER_SIZE, 64)
    drive.write(at.MODE, 7)
    drive.write(BUFFER_CLEAR, 1)
    feed(drive, (0, 0, 20), (100, 0, 0))
    drive.enable()
    drive.command(0x1F)
    drive.run(60)
    assert drive.read(at.POSITION_DEMAND) == 100


@pytest.mark.emergency(0xFF0C)
def test_taking_the_access_away_under_way_stops_the_path(ready: "Drive") -> None:
    feed(ready, (0, 0, 100), (1000, 600, 100), (3000, 600, 100), (4000, 0, 0))
    ready.command(0x1F)
    ready.run(120)
    ready.write(BUFFER_CLEAR, 0)
    ready.run(30)
    assert ready.reported == [ERROR]
    assert status(ready) == UNDERFLOW


def test_a_restart_empties_the_buffer(ready: "Drive") -> None:
    feed(ready, (0, 0, 10), (0, 0, 10))
    ready.control.reset()
    assert ready.read(BUFFER_FREE) == 64
    assert status(ready) == 0


KNOTS = st.lists(
    st.tuples(st.integers(-400, 400), st.integers(-900, 900), st.integers(1, 60)), min_size=1, max_size=20
)


@settings(max_examples=60, deadline=None)
@given(steps=KNOTS, ahead=st.integers(2, 6))
def test_any_path_within_the_limits_passes_every_knot_and_is_continuous(
    steps: list[tuple[int, int, int]], ahead: int
) -> None:
    drive = prepared(make_drive())
    drive.write(at.MAX_FOLLOWING_ERROR, 0xFFFFFFFF)
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
    ready.command(0x010F, 0x011F)
    ready.run(60)
    assert ready.read(at.POSITION_DEMAND) == 0
    ready.command(0x001F)
    ready.run(60)
    assert ready.read(at.POSITION_DEMAND) == 0
    ready.command(0x000F, 0x001F)
    ready.run(60)
    assert ready.read(at.POSITION_DEMAND) == 100


def test_a_last_record_with_a_velocity_brakes_from_there(ready: "Drive") -> None:
    feed(ready, (0, 0, 100), (1000, 600, 0))
    ready.command(0x1F)
    ready.run(101)
    assert ready.read(at.POSITION_DEMAND) == pytest.approx(1000, abs=21)
    # 15 000 rpm/s bring 20 qc/ms to rest in 40 ms and 400 qc.
    ms = ready.runs_until(lambda: bool(ready.statusword & REACHED))
    assert ms == pytest.approx(40, abs=3)
    assert ready.read(at.POSITION_DEMAND) == pytest.approx(1400, abs=15)
    assert ready.reported == []


@pytest.mark.emergency(0xFF0C)
@pytest.mark.parametrize("first", [(10, 0), (0, 300), (-10, 0)])
def test_a_first_record_that_is_a_jolt_is_an_acceleration_error(
    ready: "Drive", first: tuple[int, int]
) -> None:
    ready.write(at.MAX_ACCELERATION, 100_000)
    position, velocity = first
    feed(ready, (position, velocity, 100), (position + 20, 0, 0))
    ready.command(0x1F)
    ready.run(20)
    assert status(ready) == ACCELERATION
    assert ready.reported == [ERROR]
    assert ready.read(BUFFER_FREE) == 64


@pytest.mark.emergency(0xFF07)
def test_a_path_into_a_limit_switch_ends_there(ready: "Drive") -> None:
    ready.write(INPUT_EXECUTION, 0x0003)
    feed(ready, (0, 0, 100), *[(1000 + 2000 * k, 600, 100) for k in range(8)])
    ready.command(0x1F)
    ready.run(250)
    assert ready.reported == []
    ready.axis.pins = 1 << 4
    ready.run(20)
    assert ready.reported == [0xFF07]
    assert not ready.statusword & ACTIVE_BIT


@pytest.mark.parametrize(
    ("third", "code"),
    [((900, 0, 0), 0), ((901, 0, 0), 0xFF09), ((900, 25_001, 0), ERROR), ((2**31 - 1, 0, 0), 0xFF09)],
)
@pytest.mark.emergency(0xFF0C, 0xFF09)
def test_the_axis_never_gets_a_segment_that_may_not_run(
    ready: "Drive", third: tuple[int, int, int], code: int
) -> None:
    ready.write(at.MAX_POSITION_LIMIT, 900)
    ready.write(at.MAX_PROFILE_VELOCITY, 2000)
    feed(ready, (0, 0, 50), (500, 0, 50), third)
    ready.command(0x1F)
    ready.run(20)
    assert ready.axis.next_ms == (0 if code else 50)
    assert ready.reported == []
    ready.run(100)
    assert ready.reported == ([code] if code else [])
    # Without power the demand is where the shaft is.
    assert ready.read(at.POSITION_DEMAND) == pytest.approx(500 if code else 900, abs=5)
