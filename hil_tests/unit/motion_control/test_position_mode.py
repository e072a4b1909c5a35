"""Profile position mode: the set-point handshake, its buffer, halt, limits; and the bare position mode."""

from typing import TYPE_CHECKING

import pytest

from emulators.epos2.modes.table import MODES
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.modes import Mode
from hil_tests.unit.motion_control.conftest import make_drive

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

REACHED, ACKNOWLEDGED = 0x0400, 0x1000
ABSOLUTE, IMMEDIATE, RELATIVE, RELATIVE_IMMEDIATE, LOW = 0x1F, 0x3F, 0x5F, 0x7F, 0x0F


def go(drive: "Drive", target: int, word: int = IMMEDIATE) -> None:
    drive.write(od.TARGET_POSITION, target)
    drive.command(word)


def test_a_set_point_is_acknowledged_driven_and_reached(drive: "Drive") -> None:
    drive.enable(mode=1)
    go(drive, 20_000, ABSOLUTE)
    assert drive.statusword == 0x1337
    drive.command(LOW)
    assert drive.statusword == 0x0337
    # 20 000 qc at 3000 rpm = 100 qc/ms, 100 ms up, 200 ms down: 200 ms and half of the ramps.
    ms = drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert ms == pytest.approx(200 + 150, abs=5)
    drive.run(100)
    assert drive.read(od.POSITION_ACTUAL) == pytest.approx(20_000, abs=10)
    assert drive.read(od.POSITION_DEMAND) == 20_000


def test_the_target_may_follow_the_controlword_in_one_pdo(drive: "Drive") -> None:
    # The default mapping of RPDO3 is controlword, then target position: both are there before the refresh.
    drive.enable(mode=1)
    drive.carries((od.CONTROLWORD, IMMEDIATE), (od.TARGET_POSITION, 5000))
    assert drive.statusword & ACKNOWLEDGED
    drive.run(500)
    assert drive.read(od.POSITION_DEMAND) == 5000


def test_a_set_point_of_a_pdo_needs_a_rising_edge(drive: "Drive") -> None:
    drive.enable(mode=1)
    for target in (1000, 5000):
        drive.carries((od.CONTROLWORD, IMMEDIATE), (od.TARGET_POSITION, target))
        drive.run(300)
    assert drive.read(od.POSITION_DEMAND) == 1000
    drive.carries((od.CONTROLWORD, LOW))
    drive.carries((od.CONTROLWORD, IMMEDIATE))
    drive.run(300)
    assert drive.read(od.POSITION_DEMAND) == 5000


def test_a_controlword_that_is_written_is_a_set_point_edge_or_not(drive: "Drive") -> None:
    drive.enable(mode=1)
    for target in (1000, 5000):
        go(drive, target)
        drive.run(300)
        assert drive.read(od.POSITION_DEMAND) == target
        assert drive.statusword & ACKNOWLEDGED
    for _ in range(3):
        go(drive, -700, RELATIVE_IMMEDIATE)
        drive.run(300)
    assert drive.read(od.POSITION_DEMAND) == 5000 - 2100


def test_a_word_that_is_written_without_an_edge_waits_for_its_place_like_any_other(drive: "Drive") -> None:
    drive.enable(mode=1)
    for target in (2000, 4000):
        go(drive, target, ABSOLUTE)
    assert drive.read(od.POSITION_DEMAND) < 100
    drive.run(600)
    assert drive.read(od.POSITION_DEMAND) == 4000


def test_a_written_word_that_enables_starts_no_move(drive: "Drive") -> None:
    drive.write(od.MODE, 1)
    drive.write(od.TARGET_POSITION, 3000)
    drive.command(0x06, 0x0F | 0x30)
    drive.run(300)
    assert drive.read(od.POSITION_DEMAND) == 0
    drive.command(IMMEDIATE)
    drive.run(300)
    assert drive.read(od.POSITION_DEMAND) == 3000


def test_where_the_edge_was_chosen_it_counts_in_written_words_too() -> None:
    drive = make_drive(each_write_counts=False)
    drive.run(1)
    drive.enable(mode=1)
    for target in (1000, 5000):
        go(drive, target)
        drive.run(300)
    assert drive.read(od.POSITION_DEMAND) == 1000


def test_homing_keeps_its_edge(drive: "Drive") -> None:
    drive.enable(mode=6)
    drive.write(od.HOMING_METHOD, 35)
    for home, word, position in ((100, 0x1F, 100), (200, 0x1F, 100), (200, LOW, 100), (200, 0x1F, 200)):
        drive.write(at.HOME_POSITION, home)
        drive.command(word)
        drive.run(20)
        assert drive.read(od.POSITION_ACTUAL) == position


def test_paths_and_profile_position_alone_go_by_writes() -> None:
    by_writes = {number for number, mode in MODES.items() if mode.goes_by_writes}
    assert by_writes == {Mode.INTERPOLATED_POSITION, Mode.PROFILE_POSITION}


def test_relative_counts_from_the_position_demand(drive: "Drive") -> None:
    drive.enable(mode=1)
    for _ in range(3):
        go(drive, -700, RELATIVE)
        drive.run(300)
        drive.command(LOW)
    assert drive.read(od.POSITION_DEMAND) == -2100


def test_immediately_turns_round_under_way(drive: "Drive") -> None:
    drive.enable(mode=1)
    go(drive, 50_000)
    drive.run(150)
    drive.command(LOW)
    go(drive, 0)
    drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert drive.read(od.POSITION_DEMAND) == 0
    assert drive.reported == []


def test_without_immediately_one_set_point_waits_and_a_third_must_wait_outside(drive: "Drive") -> None:
    drive.enable(mode=1)
    go(drive, 10_000, ABSOLUTE)
    drive.command(LOW)
    go(drive, 5_000, ABSOLUTE)
    assert drive.statusword & ACKNOWLEDGED
    drive.command(LOW)
    go(drive, 20_000, ABSOLUTE)
    assert not drive.statusword & ACKNOWLEDGED
    highest = 0
    while not drive.statusword & ACKNOWLEDGED:
        drive.run(1)
        highest = max(highest, drive.read(od.POSITION_DEMAND))
    assert highest == 10_000
    drive.command(LOW)
    drive.runs_until(lambda: drive.read(od.POSITION_DEMAND) == 5_000)
    drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert drive.read(od.POSITION_DEMAND) == 20_000


def test_halt_holds_and_its_end_goes_on_to_the_target(drive: "Drive") -> None:
    drive.enable(mode=1)
    go(drive, 50_000)
    drive.run(200)
    drive.command(0x010F)
    ms = drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert ms == pytest.approx(200, abs=2)
    here = drive.read(od.POSITION_DEMAND)
    drive.run(200)
    assert drive.read(od.POSITION_DEMAND) == here
    drive.command(0x000F)
    drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert drive.read(od.POSITION_DEMAND) == 50_000


def test_a_set_point_during_halt_starts_when_the_halt_ends(drive: "Drive") -> None:
    drive.enable(mode=1)
    drive.command(0x010F)
    go(drive, 3000, 0x013F)
    drive.run(200)
    assert drive.statusword & ACKNOWLEDGED
    assert drive.read(od.POSITION_DEMAND) == 0
    drive.command(0x000F)
    drive.run(400)
    assert drive.read(od.POSITION_DEMAND) == 3000


def test_ending_a_halt_without_any_set_point_moves_nothing(drive: "Drive") -> None:
    drive.enable(mode=1)
    drive.command(0x010F, 0x000F)
    drive.run(100)
    assert drive.read(od.POSITION_DEMAND) == 0


def test_ending_a_halt_does_not_return_to_a_target_of_long_ago(drive: "Drive") -> None:
    drive.enable(mode=1)
    go(drive, 3000)
    drive.run(400)
    drive.write(od.MODE, 3)
    drive.write(od.TARGET_VELOCITY, 1000)
    drive.run(300)
    drive.write(od.MODE, 1)
    drive.run(300)
    here = drive.read(od.POSITION_DEMAND)
    assert here > 5000
    drive.command(0x010F, 0x000F)
    drive.run(300)
    assert drive.read(od.POSITION_DEMAND) == here


@pytest.mark.parametrize(
    ("target", "word", "allowed"),
    [
        (1000, IMMEDIATE, True),
        (1001, IMMEDIATE, False),
        (-500, ABSOLUTE, True),
        (-501, ABSOLUTE, False),
        (1000, RELATIVE, True),
        (1001, RELATIVE_IMMEDIATE, False),
    ],
)
@pytest.mark.emergency(0xFF09)
def test_targets_stay_within_the_software_limits(
    drive: "Drive", target: int, word: int, *, allowed: bool
) -> None:
    drive.write(od.MIN_POSITION_LIMIT, -500)
    drive.write(od.MAX_POSITION_LIMIT, 1000)
    drive.enable(mode=1)
    go(drive, target, word)
    drive.run(300)
    if allowed:
        assert drive.read(od.POSITION_DEMAND) == target
        assert drive.reported == []
    else:
        assert drive.read(od.POSITION_DEMAND) == 0
        assert drive.reported == [0xFF09]
        assert drive.stands_in(PowerState.FAULT)


def test_a_position_window_waits_for_the_shaft(drive: "Drive") -> None:
    drive.write(od.POSITION_WINDOW, 20)
    drive.write(od.POSITION_WINDOW_TIME, 100)
    drive.enable(mode=1)
    go(drive, 5000)
    ms = drive.runs_until(lambda: bool(drive.statusword & REACHED))
    assert ms > 100
    assert drive.read(od.POSITION_ACTUAL) == pytest.approx(5000, abs=20)


def test_the_hold_is_quiet_at_rest(drive: "Drive") -> None:
    drive.enable(mode=1)
    go(drive, 12_345)
    drive.run(1500)
    seen = set()
    for _ in range(300):
        drive.run(1)
        seen.add(drive.read(od.POSITION_ACTUAL))
    assert seen <= {12_344, 12_345, 12_346}


def test_quick_stop_under_way_ends_the_move_for_good(drive: "Drive") -> None:
    drive.enable(mode=1)
    go(drive, 50_000)
    drive.run(200)
    drive.command(0x02)
    drive.run(200)
    here = drive.read(od.POSITION_DEMAND)
    assert here < 50_000
    drive.command(LOW)
    drive.run(300)
    assert drive.stands_in(PowerState.OPERATION_ENABLED)
    assert drive.read(od.POSITION_DEMAND) == pytest.approx(here, abs=5)


def test_position_mode_follows_its_set_value_within_the_limits(drive: "Drive") -> None:
    drive.write(od.MAX_POSITION_LIMIT, 300)
    drive.enable(mode=-1)
    drive.write(at.POSITION_MODE_SETTING, 200)
    drive.run(200)
    assert drive.read(od.POSITION_ACTUAL) == pytest.approx(200, abs=2)
    drive.write(at.POSITION_MODE_SETTING, 400)
    assert drive.read(od.POSITION_DEMAND) == 300
