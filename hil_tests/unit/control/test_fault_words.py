"""Faults in words, as `emulate --fault` takes them: their keys and times, and what cannot be read."""

import re
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.control.keys import WordError, keys_of
from emulators.control.words import fault_of, plan, planned
from firmware_bridge.units import MILLISECOND
from hil_tests.rows import every
from hil_tests.unit.control.live_bench import live


@every(
    ("text", "table"),
    [
        ("board_brown_out", {"kind": "board_brown_out", "at_s": 0.0}),
        ("motor_cable_off,node=M4@0", {"kind": "motor_cable_off", "node": "M4", "at_s": 0.0}),
        ("supply_sag,node=2,to_v=8.5@1.5", {"kind": "supply_sag", "node": 2, "to_v": 8.5, "at_s": 1.5}),
        ("board_unpowered@2-2.25", {"kind": "board_unpowered", "at_s": 2.0, "until_s": 2.25}),
        ("can_cut,between=left,right@1", {"kind": "can_cut", "between": ["left", "right"], "at_s": 1.0}),
    ],
)
def test_a_fault_is_written_with_its_keys_and_times(text: str, table: dict[str, Any]) -> None:
    assert planned(text) == table


@every(
    ("text", "reported"),
    [
        ("shaft_block,node=one", "no such fault as 'shaft_block'; perhaps 'shaft_blocked'?"),
        ("shaft_blocked", "shaft_blocked: node: shaft_blocked needs node: one or two or three"),
        ("shaft_blocked,node=four", "rome has no node 'four'; there are: one, two, three"),
        ("shaft_blocked,nod=one", "no such key of 'shaft_blocked'; perhaps 'node'?"),
        ("shaft_blocked,one", "one: give KEY=VALUE, as node=left"),
        ("board_hangs@3-4", "'board_hangs' is an instant: it has no end"),
        (
            "board_brown_out@soon",
            "'soon' is no time; write board_brown_out@5, or board_brown_out@5-7.5, in s",
        ),
        ("board_brown_out@-3", "'-3' is no time"),
        ("board_brown_out@nan", "it is nan"),
        ("board_brown_out@1e400", "it is inf"),
        ("board_brown_out@3-3", "until_s = 3 is not after at_s = 3"),
        ("bridge_ends", "not on a real bus or line"),
        ("supply_sag,node=one,to_v=8", "rome has not"),
        ("", "no such fault as ''"),
    ],
)
def test_what_is_no_fault_is_reported(text: str, reported: str) -> None:
    with live("rome") as bench, pytest.raises(WordError, match=re.escape(reported)):
        plan(bench.live, [fault_of(bench.live, planned(text))])


def test_a_planned_fault_is_on_from_its_instant_to_its_end() -> None:
    with live("rome") as bench:
        fault = fault_of(bench.live, planned("shaft_blocked,node=two@0.5-0.55"))
        number = plan(bench.live, [fault])
        on = []
        while bench.now < 600 * MILLISECOND:
            bench.runs(1)
            if number in bench.live.faults.standing:
                on.append(bench.now)
        assert on
        assert 500 * MILLISECOND <= on[0] <= 501 * MILLISECOND
        assert 549 * MILLISECOND <= on[-1] < 550 * MILLISECOND


@given(st.text("ab=,@-.1e5", max_size=20))
def test_whatever_is_written_it_is_a_table_or_one_message(text: str) -> None:
    with suppress(WordError):
        assert planned(text)["kind"] == text.partition("@")[0].partition(",")[0]


def test_a_list_is_written_with_commas() -> None:
    assert keys_of(["names=a,2,true", "share=0.5"]) == {"names": ["a", 2, True], "share": 0.5}
