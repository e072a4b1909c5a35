"""What is known before anything is: an axis that is not judged, and a robot of which nobody complains."""

from dataclasses import replace
from typing import Any

import pytest

from firmware_bridge.drivers.driver import Stop
from firmware_bridge.intent import NEVER_HEARD
from firmware_bridge.safety.row import Row
from firmware_bridge.safety.snapshot import Facts, Following, Hold


def test_an_axis_that_was_never_seen_is_told_to_stand_and_owes_nothing() -> None:
    known = Following()
    assert (known.demand, known.changed_at) == (Stop.REST, NEVER_HEARD)
    times = {known.sampled_at, known.obeyed_at, known.settled_at, known.place_at}
    assert times == {NEVER_HEARD}
    assert (known.position, known.velocity, known.low, known.high, known.owes) == (0.0,) * 5
    assert known.unasked is known.halted is False
    assert known.idle == 2, "it has not turned for as many samples as count"


def test_a_robot_is_whole_and_its_operator_there_where_nothing_else_is_said() -> None:
    needed: dict[str, Any] = {"axes": {}, "sensors": {}, "links_lost": {}}
    facts = Facts(now=0, armed=False, emergency_stopped=False, heard_at=NEVER_HEARD, neutral=True, **needed)
    assert facts.stood_still == 0
    assert (facts.paused, facts.parted, facts.mode, facts.battery_low_since) == (False, False, "", None)
    assert not any((facts.masters, facts.without, facts.stood, facts.following))


@pytest.mark.parametrize(("change", "same"), [({"axis": "lift"}, True), ({"since": 1}, False)])
def test_a_hold_is_the_same_whosever_it_is(change: dict[str, Any], *, same: bool) -> None:
    """Its name says whose it is already."""
    row = Row(name="axis silent: lift", remedy="check its cable")
    hold = Hold("axis silent: lift", "silent", row, 0)
    assert hold.axis == ""
    assert (replace(hold, **change) == hold) is same
