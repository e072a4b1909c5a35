"""The sin2 profile of a drive (0x6086 = 1): moves, velocities, halt, quick stop, and changes under way."""

from math import pi
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from hil_tests.lanes import examples
from hil_tests.unit.motion_control.conftest import make_drive

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

REACHED = 0x0400
IMMEDIATE, RELATIVE_IMMEDIATE, LOW, HALT = 0x3F, 0x7F, 0x0F, 0x010F


def sinusoidal(drive: "Drive", mode: int) -> "Drive":
    drive.write(od.MOTION_PROFILE_TYPE, 1)
    drive.enable(mode=mode)
    return drive


def go(drive: "Drive", target: int, word: int = IMMEDIATE) -> None:
    drive.write(od.TARGET_POSITION, target)
    drive.command(word, word & ~0x10)


def test_a_move_takes_half_pi_times_the_ramps_and_ends_exactly(drive: "Drive") -> None:
    sinusoidal(drive, 1)
    go(drive, 30_000)
    # 3000 rpm = 100 qc/ms; ramps of 100 and 200 ms become 157 and 314 ms.
    ms = drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert ms == pytest.approx(300 + pi / 2 * (100 + 200) / 2, abs=8)
    assert drive.axis.position_demand == 30_000 << drive.axis.fraction
    drive.run(200)
    assert drive.read(od.POSITION_ACTUAL) == pytest.approx(30_000, abs=10)
    assert drive.reported == []


def test_relative_moves_add_up(drive: "Drive") -> None:
    sinusoidal(drive, 1)
    for _ in range(3):
        go(drive, -700, RELATIVE_IMMEDIATE)
        drive.run(400)
    assert drive.read(od.POSITION_DEMAND) == -2100


def test_a_velocity_is_reached_in_half_pi_times_the_ramp(drive: "Drive") -> None:
    sinusoidal(drive, 3)
    drive.write(od.TARGET_VELOCITY, 3000)
    ms = drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert ms == pytest.approx(157, abs=4)
    assert drive.read(od.VELOCITY_DEMAND) == 3000
    drive.write(od.TARGET_VELOCITY, -1500)
    # Down in pi/2 times 200 ms, up again in pi/2 times 50 ms.
    ms = drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert ms == pytest.approx(pi / 2 * (200 + 50), abs=6)


def test_the_same_velocity_once_more_does_not_begin_the_ramp_again(drive: "Drive") -> None:
    sinusoidal(drive, 3)
    drive.write(od.TARGET_VELOCITY, 3000)
    ms = 0
    while not drive.statusword & REACHED:
        drive.command(0x0F)
        drive.write(od.TARGET_VELOCITY, 3000)
        drive.run(1)
        ms += 1
    assert ms == pytest.approx(157, abs=4)


def test_halt_brakes_along_a_sine_and_its_end_goes_on(drive: "Drive") -> None:
    sinusoidal(drive, 1)
    go(drive, 50_000)
    drive.run(250)
    drive.command(HALT)
    ms = drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert ms == pytest.approx(314, abs=4)
    here = drive.read(od.POSITION_DEMAND)
    drive.run(100)
    assert drive.read(od.POSITION_DEMAND) == here
    drive.command(LOW)
    drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert drive.read(od.POSITION_DEMAND) == 50_000


def test_a_quick_stop_keeps_its_own_peak_whatever_the_largest_acceleration(drive: "Drive") -> None:
    drive.write(od.MAX_ACCELERATION, 10_000)
    sinusoidal(drive, 3)
    drive.write(od.TARGET_VELOCITY, 3000)
    assert drive.runs_until(lambda: bool(drive.statusword & REACHED)) == pytest.approx(471, abs=4)
    drive.command(0x02)
    # 60 000 rpm/s: 50 ms, times pi/2.
    assert drive.runs_until(lambda: drive.axis.velocity_demand == 0) == pytest.approx(79, abs=3)
    assert drive.stands_in(PowerState.QUICK_STOP_ACTIVE)


@pytest.mark.parametrize("shape", [0, 1])
def test_faults_that_follow_each_other_do_not_keep_the_shaft_turning(drive: "Drive", shape: int) -> None:
    drive.write(od.MOTION_PROFILE_TYPE, shape)
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.runs_until(lambda: bool(drive.statusword & REACHED))
    lasted = 0
    while not drive.stands_in(PowerState.FAULT):
        drive.control.communication_fault(0x8210)
        drive.run(1)
        lasted += 1
        assert lasted < 200
    # 60 000 rpm/s: 50 ms, times pi/2 for the sine.
    assert lasted == pytest.approx(79 if shape else 50, abs=4)


@pytest.mark.parametrize("shape", [0, 1])
def test_the_largest_acceleration_limits_either_shape(drive: "Drive", shape: int) -> None:
    drive.write(od.MOTION_PROFILE_TYPE, shape)
    drive.write(od.MAX_ACCELERATION, 6000)
    drive.enable(mode=1)
    go(drive, 20_000)
    # 0.2 qc/ms2.
    limit, sharpest, before = round(0.2 * 2**drive.axis.fraction), 0, 0
    while not drive.statusword & REACHED:
        drive.run(1)
        sharpest = max(sharpest, abs(drive.axis.velocity_demand - before))
        before = drive.axis.velocity_demand
    assert limit * 0.95 <= sharpest <= limit
    assert drive.read(od.POSITION_DEMAND) == 20_000


def test_a_disabled_drive_forgets_its_legs(drive: "Drive") -> None:
    sinusoidal(drive, 1)
    go(drive, 50_000)
    drive.run(200)
    drive.command(0x00)
    drive.run(1500)
    here = drive.read(od.POSITION_ACTUAL)
    drive.command(0x06, 0x0F)
    drive.run(200)
    assert drive.read(od.POSITION_DEMAND) == pytest.approx(here, abs=3)


@pytest.mark.long(beside="test_halt_brakes_along_a_sine_and_its_end_goes_on")
@settings(max_examples=examples(30))
@given(
    changes=st.lists(
        st.tuples(
            st.sampled_from(("target", "velocity", "halt", "release", "shape")),
            st.integers(-20_000, 20_000),
            st.integers(1, 200),
        ),
        min_size=1,
        max_size=8,
    )
)
def test_whatever_changes_under_way_the_limits_hold_and_the_end_is_exact(
    changes: list[tuple[str, int, int]],
) -> None:
    drive = sinusoidal(make_drive(), 1)
    drive.write(od.MAX_FOLLOWING_ERROR, 0xFFFFFFFF)
    drive.write(od.PROFILE_DECELERATION, 30_000)
    # 3000 rpm and 30 000 rpm/s.
    fastest, sharpest, before = 100 << drive.axis.fraction, 1 << drive.axis.fraction, 0
    for what, value, ms in [*changes, ("release", 0, 1), ("target", 1234, 4000)]:
        if what == "target":
            go(drive, value)
        elif what == "velocity":
            drive.write(od.PROFILE_VELOCITY, abs(value) % 3000 + 1 if ms < 100 else 3000)
        elif what == "shape":
            drive.write(od.MOTION_PROFILE_TYPE, value & 1)
        else:
            drive.command(HALT if what == "halt" else LOW)
        if value == 1234:
            drive.write(od.PROFILE_VELOCITY, 3000)
            go(drive, value)
        for _ in range(ms):
            drive.run(1)
            assert abs(drive.axis.velocity_demand) <= fastest
            assert abs(drive.axis.velocity_demand - before) <= sharpest
            before = drive.axis.velocity_demand
    assert drive.axis.position_demand == 1234 << drive.axis.fraction
    assert drive.reported == []
