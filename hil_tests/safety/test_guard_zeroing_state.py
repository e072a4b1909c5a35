"""The guard's state of one drive's homing, object by object, called directly."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen_drive.guard.bounds import ends
from firmware_bridge.canopen_drive.guard.words import (
    DISABLE_VOLTAGE,
    ENABLE,
    HALT,
    NEW_SET_POINT,
    START_HOMING,
)
from firmware_bridge.canopen_drive.guard.zeroing import Zeroing
from firmware_bridge.families.epos2.guard.product import by_file, product, units
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.modes import Mode
from hil_tests.safety.guard_robots import RARS
from hil_tests.scenarios.homed import LIFT, homed

if TYPE_CHECKING:
    from firmware_bridge.canopen.address import Address

HOMED = homed(LIFT)
PROFILE_POSITION, HOMING = int(Mode.PROFILE_POSITION), int(Mode.HOMING)


def zeroing(name: str = "lift") -> Zeroing:
    axis = next(axis for axis in RARS.axes if axis.name == name)
    return Zeroing(axis, product(axis, RARS))


def in_homing(one: Zeroing) -> Zeroing:
    one.wrote(od.MODE, HOMING)
    one.read(od.MODE_DISPLAY, HOMING)
    return one


def test_an_axis_without_travel_has_no_home() -> None:
    one = zeroing("left")
    assert one.within_s == 0.0
    in_homing(one)
    one.read(od.HOMING_METHOD, 35)
    one.read(at.HOME_POSITION, 0)
    assert not one.prepared


def test_a_travel_to_both_sides_is_one_of_homes_to_both_sides() -> None:
    """60 degrees of steering are 2.666 rad of the pinion, 159 times 2000 quadcounts a turn."""
    one = in_homing(zeroing("steer"))
    one.read(od.HOMING_METHOD, 35)
    for place, good in ((-134_954, False), (-134_953, True), (134_953, True), (134_954, False)):
        one.read(at.HOME_POSITION, place)
        assert one.prepared is good


def test_where_it_stands_may_be_stated_within_its_travel() -> None:
    one = in_homing(zeroing())
    low, high = ends(RARS.axis("lift"), units(RARS.axis("lift")))
    one.read(od.HOMING_METHOD, 35)
    for place, good in ((low, True), (high, True), (high + 1, False)):
        one.read(at.HOME_POSITION, place)
        assert one.prepared is good


def test_a_homing_by_the_file_needs_a_current_only_where_the_file_reports_one() -> None:
    axis = next(axis for axis in HOMED.axes if axis.name == "lift")
    assert axis.zero.homing is not None
    for current_a, needed in ((None, False), (0.5, True)):
        homing = axis.zero.homing.model_copy(update={"current_a": current_a})
        zero = axis.zero.model_copy(update={"homing": homing})
        wanted = by_file(axis.model_copy(update={"zero": zero}))
        assert (at.HOMING_CURRENT in wanted) is needed
    assert wanted[at.HOMING_CURRENT] == range(1, 501), "mA"


def test_a_speed_of_less_than_one_rpm_is_one() -> None:
    """The drive takes whole numbers only, and none below 1."""
    axis = next(axis for axis in HOMED.axes if axis.name == "lift")
    assert axis.zero.homing is not None
    homing = axis.zero.homing.model_copy(update={"zero_speed": 1e-4})
    zero = axis.zero.model_copy(update={"homing": homing})
    assert by_file(axis.model_copy(update={"zero": zero}))[od.HOMING_SPEED_ZERO] == range(1, 2)


@pytest.mark.parametrize("address", [od.HOMING_METHOD, od.HOME_OFFSET])
def test_only_the_mode_itself_is_left_while_the_word_that_starts_is_down(address: Address) -> None:
    one = zeroing()
    assert one.refuses_write(od.MODE, PROFILE_POSITION, ENABLE, "node 1") is None, "whichever moves"
    assert "bit 4 is up" in str(one.refuses_write(od.MODE, PROFILE_POSITION, START_HOMING, None))
    assert one.refuses_write(od.MODE, HOMING, START_HOMING, None) is None
    assert one.refuses_write(address, PROFILE_POSITION, START_HOMING, None) is None
    assert "may move" in str(one.refuses_write(address, PROFILE_POSITION, ENABLE, "node 1"))


@pytest.mark.parametrize(
    ("word", "by_object", "before", "since"),
    [
        (ENABLE, True, False, True),
        (HALT, True, False, True),
        (ENABLE, False, True, True),
        (DISABLE_VOLTAGE, True, True, True),
        (NEW_SET_POINT, False, True, False),
    ],
)
def test_a_word_passes_by_object_or_as_a_set_point(
    word: int, *, by_object: bool, before: bool, since: bool
) -> None:
    """Before the drive was sent to homing mode, and since."""
    one = zeroing()
    assert (one.refuses_word(word, by_object=by_object) is None) is before
    one.wrote(od.MODE, HOMING)
    assert (one.refuses_word(word, by_object=by_object) is None) is since


@pytest.mark.parametrize(
    ("address", "value", "left"),
    [
        (od.MODE, PROFILE_POSITION, True),
        (od.MODE_DISPLAY, PROFILE_POSITION, True),
        (od.MODE_DISPLAY, HOMING, False),
        (od.HOMING_METHOD, PROFILE_POSITION, False),
    ],
)
def test_homing_mode_is_left_when_the_drive_states_that_it_is_in_its_own(
    address: Address, value: int, *, left: bool
) -> None:
    one = in_homing(zeroing())
    one.read(address, value)
    assert one.in_homing is not left


def test_what_was_written_counts_when_the_drive_has_stated_it_again() -> None:
    one = in_homing(zeroing())
    one.read(od.HOMING_METHOD, 35)
    one.read(at.HOME_POSITION, 0)
    found = []
    for address, value, states in (
        (od.HOMING_METHOD, 35, od.HOMING_METHOD),
        (at.HOME_POSITION, 0, at.HOME_POSITION),
        (od.MODE, HOMING, od.MODE_DISPLAY),
    ):
        before = one.prepared
        one.wrote(address, value)
        since = one.prepared
        one.read(states, value)
        found.append((before, since, one.prepared))
    assert found == [(True, False, True)] * 3
