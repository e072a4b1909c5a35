"""Initial knowledge: an axis that is not judged, and a robot without a complaint."""

from dataclasses import replace
from typing import Any

import pytest

from firmware_bridge.drivers.driver import Feedback, Power, Reports, Stop
from firmware_bridge.intent import NEVER_RECEIVED, AgeLimit
from firmware_bridge.robot_types import find
from firmware_bridge.safety.common import LATE_ANSWER, NO_FEEDBACK
from firmware_bridge.safety.interlock import AxisInterlock
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from firmware_bridge.safety.operator_interlocks import operator_interlocks
from firmware_bridge.safety.snapshot import ActiveInterlock, Facts, Tracking
from firmware_bridge.units import MILLISECOND, SECOND


def test_an_axis_that_was_never_seen_is_commanded_to_stand_and_has_no_backlog() -> None:
    known = Tracking()
    assert (known.set_point, known.changed_at) == (Stop.STANDSTILL, NEVER_RECEIVED)
    times = {known.sampled_at, known.obeyed_at, known.settled_at, known.place_at}
    assert times == {NEVER_RECEIVED}
    assert (known.position, known.velocity, known.low, known.high, known.backlog) == (0.0,) * 5
    assert known.uncommanded is known.halted is False
    assert known.idle == 2, "it has not turned for as many samples as count"


def test_a_robot_is_whole_and_its_operator_there_where_nothing_else_is_stated() -> None:
    needed: dict[str, Any] = {"axes": {}, "sensors": {}, "links_lost": {}}
    facts = Facts(
        now=0, armed=False, emergency_stopped=False, received_at=NEVER_RECEIVED, neutral=True, **needed
    )
    assert facts.stood_still == 0
    assert (facts.paused, facts.neutral_required, facts.mode, facts.battery_low_since) == (
        False,
        False,
        "",
        None,
    )
    assert not any((facts.masters, facts.without, facts.stood, facts.following))


@pytest.mark.parametrize(("change", "same"), [({"axis": "lift"}, True), ({"since": 1}, False)])
def test_a_hold_is_the_same_whosever_it_is(change: dict[str, Any], *, same: bool) -> None:
    """Its name contains the axis already."""
    row = InterlockBase(name="axis timeout: lift", remedy="check its cable")
    event = ActiveInterlock("axis timeout: lift", "silent", row, 0)
    assert event.axis == ""
    assert (replace(event, **change) == event) is same


@pytest.mark.parametrize(
    ("age_ms", "timestamped", "silent_ms", "lives_ms"),
    [
        (None, True, 400, 400),
        (None, False, 400, 400),
        (300, False, 400, 400),
        (0, True, 400, 400),
        (200, True, 400, 300),
        (50, True, 400, 400),
        (499, True, 400, 1),
        (500, True, 400, 400),
        (900, True, 400, 400),
    ],
)
def test_a_command_counts_until_it_is_as_old_as_one_may_be(
    age_ms: int | None, silent_ms: int, lives_ms: int, *, timestamped: bool
) -> None:
    """Limit of 500 ms; an older one is judged by its age, and an undated one lives as long as silence may."""
    needed: dict[str, Any] = {"axes": {}, "sensors": {}, "links_lost": {}}
    facts = Facts(
        now=SECOND,
        armed=True,
        emergency_stopped=False,
        received_at=SECOND,
        neutral=False,
        sent_at=None if age_ms is None else SECOND - age_ms * MILLISECOND,
        timestamped=timestamped,
        age_limit=AgeLimit(most=500 * MILLISECOND, needed=False),
        **needed,
    )
    assert facts.lives_for(silent_ms * MILLISECOND) == lives_ms * MILLISECOND


def test_a_row_that_is_confined_to_some_groups_is_the_same_else() -> None:
    row = AxisInterlock(
        "hot",
        lambda *_: None,
        "let it cool",
        needs=frozenset({Reports.POWER}),
        clear_after=7,
        severity=Severity.EMERGENCY,
        disables_power=True,
    )
    confined = row.confined(frozenset({"base"}))
    assert (confined.name, confined.remedy, confined.judge) == (row.name, row.remedy, row.judge)
    assert (confined.needs, confined.clear_after) == (row.needs, 7)
    assert (confined.severity, confined.disables_power) == (Severity.EMERGENCY, True)
    assert (confined.stops, confined.disarms) == (frozenset({"base"}), False)


def test_a_pause_is_no_more_than_a_notice() -> None:
    rows: Any = operator_interlocks()
    (row,) = (row for row in rows if row.name == "operation paused")
    assert row.severity is Severity.NOTICE


@pytest.mark.parametrize("row", [LATE_ANSWER, NO_FEEDBACK], ids=lambda row: row.name)
def test_a_weaker_row_states_for_how_long_an_axis_was_not_received(row: AxisInterlock) -> None:
    (axis,) = (axis for axis in find("rars").axes if axis.name == "left")
    feedback = Feedback("left", Power.ON, 3 * SECOND, 3 * SECOND, position=0.0, velocity=0.0)
    needed: dict[str, Any] = {"axes": {}, "sensors": {}, "links_lost": {}}
    facts = Facts(now=5 * SECOND, armed=True, emergency_stopped=False, received_at=0, neutral=True, **needed)
    stated = str(row.judge(axis, feedback, facts, SECOND))
    assert stated.startswith(f"{axis.called} reports no ")
    assert "answered 2.00 s ago" in stated
