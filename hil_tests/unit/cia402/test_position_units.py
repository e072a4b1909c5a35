"""Units of position: 0x608F, 0x6091 and 0x6092 scale every position of a client, and no shaft."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.cia402.servo_objects import POSITIONS
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import ControlwordBit, Mode
from firmware_bridge.families.cia402.wire import address as at
from firmware_bridge.families.cia402.wire.objects import OFF, objects_of
from hil_tests.unit.cia402.servo_bench import COUNTS, ENABLE, ServoBench

ENCODER, ENCODER_TURNS = Address(0x608F, 1), Address(0x608F, 2)
MOTOR_TURNS, SHAFT_TURNS = Address(0x6091, 1), Address(0x6091, 2)
FEED, FEED_TURNS = Address(0x6092, 1), Address(0x6092, 2)
TENTHS = 3600
"""Of a degree in a turn of a shaft behind the gear."""
GEAR = 5
OVERSHOOT = 250
"""Counts of the shaft beyond a jump that ends at once."""


@pytest.fixture
def bench() -> ServoBench:
    return ServoBench()


@pytest.fixture
def degrees(bench: ServoBench) -> ServoBench:
    """Return a servo whose positions are tenths of a degree behind a gear of 5."""
    for address, value in ((MOTOR_TURNS, GEAR), (SHAFT_TURNS, 1), (FEED, TENTHS), (FEED_TURNS, 1)):
        bench.write(address, value)
    bench.run(1)
    return bench


def test_as_it_comes_a_unit_is_a_count(bench: ServoBench) -> None:
    assert [bench.read(one) for one in (ENCODER, ENCODER_TURNS, FEED, FEED_TURNS)] == [COUNTS, 1, COUNTS, 1]
    assert [bench.read(one) for one in (MOTOR_TURNS, SHAFT_TURNS)] == [1, 1]


def test_a_target_is_reached_in_its_unit(degrees: ServoBench) -> None:
    degrees.enable(Mode.PROFILE_POSITION)
    degrees.write(od.TARGET_POSITION, 900)
    degrees.command(ENABLE | ControlwordBit.NEW_SETPOINT)
    degrees.run(2000)
    # A quarter of a turn behind the gear.
    assert abs(degrees.axis.encoder - GEAR * COUNTS // 4) <= 4
    assert abs(degrees.read(od.POSITION_ACTUAL) - 900) <= 2
    assert degrees.read(od.POSITION_DEMAND) == 900
    assert degrees.read(at.POSITION_INTERNAL) == degrees.axis.encoder


def test_a_limit_is_one_of_its_unit(degrees: ServoBench) -> None:
    degrees.write(od.MAX_POSITION_LIMIT, 900)
    degrees.enable(Mode.CYCLIC_POSITION)
    for _ in range(100):
        degrees.write(od.TARGET_POSITION, 2000)
        degrees.run(10)
        assert degrees.axis.encoder <= GEAR * COUNTS // 4 + OVERSHOOT
    assert degrees.read(od.POSITION_DEMAND) == 900


def test_a_homing_in_place_counts_in_its_unit(degrees: ServoBench) -> None:
    degrees.write(od.HOME_OFFSET, -450)
    degrees.write(od.HOMING_METHOD, 37)
    degrees.enable(Mode.HOMING)
    degrees.command(ENABLE | ControlwordBit.NEW_SETPOINT)
    degrees.run(10)
    assert abs(degrees.read(od.POSITION_ACTUAL) - 450) <= 1
    assert abs(degrees.read(at.POSITION_INTERNAL) - GEAR * COUNTS // 8) <= 2


@pytest.mark.parametrize("before", [True, False])
def test_a_following_error_is_judged_in_its_unit_whenever_the_factor_came(
    bench: ServoBench, *, before: bool
) -> None:
    """A window of 100 tenths of a degree is 1388 counts behind the gear."""
    writes = [(MOTOR_TURNS, GEAR), (FEED, TENTHS)]
    window = (od.MAX_FOLLOWING_ERROR, 100)
    for address, value in (window, *writes) if before else (*writes, window):
        bench.write(address, value)
    bench.run(1)
    assert bench.axis.following_limit_qc == round(100 * GEAR * COUNTS / TENTHS)


def test_a_window_that_is_off_stays_off(degrees: ServoBench) -> None:
    degrees.write(od.POSITION_WINDOW, OFF)
    assert degrees.servo.store.get(od.POSITION_WINDOW) == OFF


@pytest.mark.parametrize("factor", at.FACTORS)
def test_a_factor_is_written_without_power_alone_and_is_never_0(bench: ServoBench, factor: Address) -> None:
    assert bench.write(factor, 0) == AbortCode.TOO_LOW
    bench.enable(Mode.PROFILE_VELOCITY)
    before = bench.read(factor)
    assert bench.write(factor, 7) == AbortCode.DEVICE_STATE
    assert bench.read(factor) == before


@given(
    feed=st.integers(1, 100_000),
    gear=st.integers(1, 200),
    place=st.integers(-(1 << 20), 1 << 20),
)
def test_what_a_client_writes_is_what_the_device_has_within_a_unit(feed: int, gear: int, place: int) -> None:
    bench = ServoBench()
    bench.write(FEED, feed)
    bench.write(MOTOR_TURNS, gear)
    bench.write(od.TARGET_POSITION, place)
    counts = bench.servo.store.get(od.TARGET_POSITION)
    assert abs(counts - place * gear * COUNTS / feed) <= 0.5


def test_each_position_of_the_table_has_the_unit() -> None:
    rows = objects_of(COUNTS)
    assert {row.address for row in rows.values() if row.unit == "position units"} == set(POSITIONS)
