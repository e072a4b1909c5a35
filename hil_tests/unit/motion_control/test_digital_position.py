"""Master encoder and step/direction mode: the gear, its limits, and what does not move the shaft."""

from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.epos2.modes.digital_position import DENOMINATOR, NUMERATOR, OFFSET, POLARITY
from emulators.epos2.objects.axis_parameters import DIGITAL_POSITION
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire.functions import INPUT_EXECUTION
from hil_tests.lanes import examples
from hil_tests.unit.motion_control.conftest import make_drive

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

MODES = (-5, -6)


def turn(drive: "Drive", counts: int, milliseconds: int) -> None:
    """Turn the master evenly by so many counts in each ms."""
    for _ in range(milliseconds):
        drive.axis.master += counts
        drive.run(1)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize(
    ("numerator", "denominator", "polarity", "expected"),
    [(1, 1, 0, 500), (3, 2, 0, 750), (1, 7, 0, 71), (1, 1, 1, -500), (2, 3, 1, -334), (0, 1, 0, 0)],
)
def test_the_shaft_follows_by_the_gear(  # noqa: PLR0917 - a row of the table
    drive: "Drive", mode: int, numerator: int, denominator: int, polarity: int, expected: int
) -> None:
    for address, value in ((NUMERATOR, numerator), (DENOMINATOR, denominator), (POLARITY, polarity)):
        drive.write(address, value)
    drive.enable(mode=mode)
    drive.run(5)
    turn(drive, 5, 100)
    drive.run(500)
    assert drive.read(od.POSITION_DEMAND) == drive.read(DIGITAL_POSITION) == expected
    assert drive.read(od.POSITION_ACTUAL) == pytest.approx(expected, abs=2)
    assert drive.reported == []


@pytest.mark.parametrize("address", [NUMERATOR, DENOMINATOR, POLARITY, OFFSET])
def test_a_gear_that_is_written_as_it_stands_loses_nothing(drive: "Drive", address: Address) -> None:
    drive.write(DENOMINATOR, 7)
    drive.enable(mode=-5)
    drive.run(5)
    for _ in range(100):
        turn(drive, 5, 1)
        drive.write(address, drive.read(address))
    drive.run(500)
    assert drive.read(od.POSITION_DEMAND) == 71


def test_what_the_master_did_before_does_not_count_and_the_offset_does(drive: "Drive") -> None:
    drive.axis.master = 123_456
    drive.write(OFFSET, 300)
    drive.write(od.MAX_ACCELERATION, 20_000)
    drive.enable(mode=-5)
    drive.run(300)
    assert drive.read(od.POSITION_DEMAND) == 300
    drive.write(OFFSET, 200)
    drive.run(300)
    assert drive.read(od.POSITION_DEMAND) == 200


def test_a_wild_master_is_followed_within_the_limits(drive: "Drive") -> None:
    drive.write(od.MAX_PROFILE_VELOCITY, 1500)
    drive.write(od.MAX_ACCELERATION, 30_000)
    drive.enable(mode=-5)
    drive.run(5)
    before, fastest, sharpest = 0, 0, 0
    for ms in range(400):
        drive.axis.master += 2500 if ms < 4 else 0
        drive.run(1)
        speed = drive.axis.velocity_demand
        fastest, sharpest = max(fastest, abs(speed)), max(sharpest, abs(speed - before))
        before = speed
    # 50 qc/ms and 1 qc/ms2.
    assert fastest == 50 << drive.axis.fraction
    assert sharpest <= 1 << drive.axis.fraction
    assert drive.read(od.POSITION_DEMAND) == 10_000


def test_without_limits_of_acceleration_it_does_not_lag(drive: "Drive") -> None:
    drive.enable(mode=-6)
    drive.run(5)
    turn(drive, 7, 50)
    drive.run(1)
    assert drive.read(od.POSITION_DEMAND) == 350


def test_the_software_limits_hold_it_and_nothing_is_lost(drive: "Drive") -> None:
    drive.write(od.MAX_POSITION_LIMIT, 400)
    drive.enable(mode=-5)
    drive.run(5)
    turn(drive, 5, 100)
    drive.run(50)
    assert drive.read(od.POSITION_DEMAND) == 400
    turn(drive, -5, 40)
    drive.run(50)
    assert drive.read(od.POSITION_DEMAND) == 300


def test_a_disabled_drive_does_not_follow(drive: "Drive") -> None:
    drive.write(od.MODE, -5)
    turn(drive, 50, 50)
    assert drive.axis.voltage_mv == 0
    drive.command(0x06, 0x0F)
    drive.run(50)
    assert drive.read(od.POSITION_DEMAND) == 0


def test_a_mode_that_is_entered_under_way_brakes_first(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 1500)
    drive.run(300)
    drive.write(od.MODE, -5)
    drive.axis.master += 1000
    ms = drive.runs_until(lambda: drive.axis.velocity_demand == 0)
    # 15 000 rpm/s.
    assert ms == pytest.approx(100, abs=3)
    here = drive.read(od.POSITION_DEMAND)
    turn(drive, 1, 100)
    drive.run(10)
    assert drive.read(od.POSITION_DEMAND) == here + 100


@pytest.mark.emergency(0x8611)
def test_a_blocked_shaft_is_a_following_error(drive: "Drive") -> None:
    drive.write(od.MAX_FOLLOWING_ERROR, 200)
    drive.enable(mode=-5)
    drive.run(5)
    drive.plant.load[0] = -10.0
    turn(drive, 20, 100)
    assert 0x8611 in drive.reported
    drive.plant.load[0] = 0.0


def test_quick_stop_lets_go_of_the_master(drive: "Drive") -> None:
    drive.enable(mode=-5)
    drive.run(5)
    turn(drive, 10, 50)
    drive.command(0x02)
    turn(drive, 10, 50)
    assert drive.stands_in(PowerState.QUICK_STOP_ACTIVE)
    assert drive.axis.velocity_demand == 0
    here = drive.read(od.POSITION_DEMAND)
    turn(drive, 10, 50)
    assert drive.read(od.POSITION_DEMAND) == here


@pytest.mark.parametrize(("pin", "way", "code"), [(1 << 4, 1, 0xFF07), (1 << 5, -1, 0xFF06)])
@pytest.mark.emergency(0xFF06, 0xFF07)
def test_a_closed_limit_switch_is_not_run_into(drive: "Drive", pin: int, way: int, code: int) -> None:
    drive.write(INPUT_EXECUTION, 0x0003)
    drive.axis.pins = pin
    drive.enable(mode=-5)
    drive.run(100)
    turn(drive, -3 * way, 20)
    drive.run(200)
    assert drive.reported == []
    turn(drive, 3 * way, 20)
    assert drive.reported == [code]


@settings(max_examples=examples(40))
@given(
    st.lists(st.integers(-60, 60), min_size=1, max_size=60),
    st.integers(1, 900),
    st.integers(15, 0xFFFF),
    st.sampled_from((1000, 20_000, 0xFFFFFFFF)),
)
def test_the_gear_loses_nothing_whatever_the_steps(
    steps: list[int], numerator: int, denominator: int, sharpest: int
) -> None:
    drive = make_drive()
    drive.write(od.MAX_FOLLOWING_ERROR, 0xFFFFFFFF)
    drive.write(NUMERATOR, numerator)
    drive.write(DENOMINATOR, denominator)
    drive.write(od.MAX_ACCELERATION, sharpest)
    drive.write(od.MAX_PROFILE_VELOCITY, 5000)
    drive.enable(mode=-5)
    drive.run(5)
    limit, before = drive.axis.cruise, 0
    for step in steps:
        drive.axis.master += step
        drive.run(1)
        assert abs(drive.axis.velocity_demand) <= limit
        assert abs(drive.axis.velocity_demand - before) <= drive.axis.acceleration
        before = drive.axis.velocity_demand
    assert drive.axis.target_position >> drive.axis.fraction == sum(steps) * numerator // denominator
