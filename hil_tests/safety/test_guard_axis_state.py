"""The guard's state of one drive after each command, report and restart, called directly."""

from __future__ import annotations

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen_drive.guard.axis import GuardedAxis
from firmware_bridge.canopen_drive.guard.words import (
    DISABLE_VOLTAGE,
    ENABLE,
    HALT,
    NEW_SET_POINT,
    START_HOMING,
    GuardedSetPoint,
)
from firmware_bridge.families.epos2.guard.product import product
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.units import MILLISECOND
from hil_tests.safety.guard_robots import RARS

OFF, ON, REACHED = 0x0140, 0x0137, 0x0537
"""Statuswords: switch on disabled; operation enabled; operation enabled, target reached."""
FAR = 100_000
CYCLE = RARS.cycle


def axis(name: str) -> GuardedAxis:
    """The left wheel, by speed; the lift, by position."""
    made = next(it for it in RARS.axes if it.name == name)
    return GuardedAxis(made, RARS, product(made, RARS))


def sends(one: GuardedAxis, word: int, target: int = 0, now: int = 0) -> None:
    one.sent(GuardedSetPoint(word, target), now)


def test_before_any_word_what_takes_the_power_is_in_force() -> None:
    for name in ("left", "lift"):
        one = axis(name)
        assert one.set_point == GuardedSetPoint(DISABLE_VOLTAGE, 0)
        assert not one.moving
        assert not one.powered


def test_the_word_that_starts_a_homing_moves_while_its_drive_has_not_stated_that_it_does_not() -> None:
    one = axis("lift")
    assert one.moves_with(GuardedSetPoint(START_HOMING, 0)) is True
    one.read(od.HOMING_METHOD, (35).to_bytes(1, "little"))
    assert one.moves_with(GuardedSetPoint(START_HOMING, FAR)) is False


def test_only_the_words_of_a_position_go_on_to_a_goal() -> None:
    one = axis("lift")
    sends(one, NEW_SET_POINT, FAR)
    for word, moves in ((ENABLE, True), (HALT, False), (DISABLE_VOLTAGE, False)):
        assert one.moves_with(GuardedSetPoint(word, FAR)) is moves
        assert one.speed_with(GuardedSetPoint(word, FAR)) == 0.0, "it is commanded by position"


def test_a_word_without_power_leaves_confirmed_what_a_drive_has_confirmed() -> None:
    one = axis("left")
    sends(one, DISABLE_VOLTAGE)
    one.reports(OFF, 0)
    assert one.watch_may_end
    sends(one, DISABLE_VOLTAGE)
    assert one.watch_may_end
    sends(one, ENABLE)
    assert not one.watch_may_end


@pytest.mark.parametrize("rounds", [1, 2, 3])
def test_where_an_axis_has_rested_counts_until_it_is_sent_away(rounds: int) -> None:
    one, now = axis("lift"), 0
    for place in range(rounds):
        now += 10 * CYCLE
        sends(one, HALT, now=now)
        one.reports(ON, now + CYCLE)
        one.reports_position(place * FAR, now + CYCLE)
        near = place * FAR + 1
        assert not one.moves_with(GuardedSetPoint(NEW_SET_POINT, near)), "near to where it rests"
        sends(one, NEW_SET_POINT, (place + 1) * FAR, now + 2 * CYCLE)
        assert one.moves_with(GuardedSetPoint(NEW_SET_POINT, near)), "it is on its way"


def test_a_halt_after_a_new_position_makes_older_reports_stale() -> None:
    one = axis("lift")
    sends(one, NEW_SET_POINT, FAR, 0)
    sends(one, HALT, FAR, CYCLE)
    one.reports(ON, CYCLE)
    one.reports_position(500, 2 * CYCLE - MILLISECOND)
    assert one.moves_with(GuardedSetPoint(NEW_SET_POINT, 501)), "that left before the halt came"
    one.reports_position(500, 2 * CYCLE)
    assert not one.moves_with(GuardedSetPoint(NEW_SET_POINT, 501))


def test_the_end_of_a_handshake_changes_nothing_of_when_it_was_sent() -> None:
    one = axis("lift")
    sends(one, NEW_SET_POINT, FAR, 0)
    sends(one, ENABLE, FAR, CYCLE - MILLISECOND)
    one.reports(REACHED, CYCLE)
    assert not one.moving, "it is there"


def test_each_target_without_a_word_is_the_speed_from_then_on() -> None:
    one = axis("left")
    sends(one, ENABLE, 100)
    for rpm in (200, -300, 400, 0):
        one.aims(rpm)
        assert one.speed == pytest.approx(rpm / (one.axis.direction * one.axis.ratio * 60.0 / 6.283185307))
        assert one.moving is (rpm != 0)


@pytest.mark.parametrize("name", ["left", "lift"])
def test_a_restart_leaves_nothing_each_time(name: str) -> None:
    one = axis(name)
    for _ in range(3):
        sends(one, DISABLE_VOLTAGE)
        one.reports(OFF, 0)
        assert (one.reported, one.watch_may_end) == (PowerState.SWITCH_ON_DISABLED, True)
        one.restarted()
        assert (one.reported, one.watch_may_end, one.powered) == (None, False, False)
        sends(one, ENABLE)
        one.reports(ON, 0)
        assert one.powered
        one.restarted()
        assert not one.powered


def test_another_mode_drops_where_the_axis_was_sent_and_its_own_does_not() -> None:
    one = axis("lift")
    sends(one, NEW_SET_POINT, FAR)
    sends(one, ENABLE, FAR)
    one.wrote(od.HOME_OFFSET, bytes(4))
    assert one.moving
    one.wrote(od.MODE, int(Mode.HOMING).to_bytes(1, "little", signed=True))
    assert not one.moving


def test_a_place_that_was_rested_at_is_forgotten_with_another_mode() -> None:
    one = axis("lift")
    sends(one, HALT)
    one.reports_position(500, 5 * CYCLE)
    assert not one.moves_with(GuardedSetPoint(NEW_SET_POINT, 501))
    one.wrote(od.HOME_OFFSET, bytes(4))
    assert not one.moves_with(GuardedSetPoint(NEW_SET_POINT, 501))
    one.wrote(od.MODE, int(Mode.HOMING).to_bytes(1, "little", signed=True))
    assert one.moves_with(GuardedSetPoint(NEW_SET_POINT, 501))


def test_who_states_that_its_homing_turns_nothing_is_in_nobodys_way() -> None:
    """Method 35 takes the place where it stands."""
    one, other = axis("lift"), axis("left")
    sends(other, ENABLE, 100)
    one.all = other.all = (one, other)
    one.wrote(od.MODE, int(Mode.HOMING).to_bytes(1, "little"))
    one.read(od.MODE_DISPLAY, int(Mode.HOMING).to_bytes(1, "little"))
    one.read(at.HOME_POSITION, bytes(4))
    start = START_HOMING.to_bytes(2, "little")
    assert one.refuses_write(od.CONTROLWORD, start, (one,), by_object=True) is not None
    one.read(od.HOMING_METHOD, (35).to_bytes(1, "little"))
    assert one.refuses_write(od.CONTROLWORD, start, (one,), by_object=True) is None
