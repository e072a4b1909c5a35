"""Interlocks under their names of the release before: in a rig, in a summary, and among those of today."""

import json
from collections.abc import Iterator
from typing import Any

import pytest

from emulators.bench.records import InterlockEvent
from emulators.bench.summary import as_json, summarize
from emulators.testing.rig import VirtualRig
from firmware_bridge import renamed
from firmware_bridge.bridge import stops
from firmware_bridge.renamed import RenamedWarning
from firmware_bridge.robot_types import find
from firmware_bridge.safety.common import (
    AXIS_INTERLOCKS,
    AXIS_RESTARTED,
    EXCLUDED_AXIS,
    LATE_ANSWER,
    NO_FEEDBACK,
    whole_robot_interlocks,
)
from firmware_bridge.units import SECOND
from hil_tests.unit.bench_report.test_summary import AXES, RUN, table


@pytest.fixture
def rig() -> Iterator[VirtualRig]:
    made = VirtualRig(find("rome"))
    yield made
    made.finish()


def test_interlocks_are_found_by_their_old_names(rig: VirtualRig) -> None:
    rig.arms()
    rig.operator.falls_silent()
    rig.fault("board_hangs")
    rig.runs(1.0)
    assert "operator link timeout" in rig.interlock_events
    with pytest.warns(RenamedWarning, match="rig: 'holds' is called 'interlock_events' now"):
        holds = rig.holds
    with pytest.warns(RenamedWarning, match=r"'operator silent' is called 'operator link timeout' now"):
        assert "operator silent" in holds
    assert {"operator silent", "axis silent: one"} <= set(holds)
    with pytest.warns(RenamedWarning, match=r"'axis silent' is called 'axis timeout' now"):
        assert "axis silent: one" in rig.interlock_events
    with pytest.warns(RenamedWarning, match="rig: 'held' is called 'interlock_history' now"):
        assert "axis silent: one" in {one.name for one in rig.held}


def test_a_summary_has_them_beside_those_of_today() -> None:
    summary = summarize(RUN, AXES, table([]), [InterlockEvent("axis timeout: one", "", SECOND)])
    read = json.loads(as_json(summary))
    assert [one["name"] for one in read["interlock_events"]] == ["axis timeout: one"]
    assert [one["name"] for one in read["holds"]] == ["axis silent: one"]
    with pytest.warns(RenamedWarning, match="Summary: 'holds' is called 'interlock_events' now"):
        assert [one.name for one in summary.holds] == ["axis silent: one"]


def test_each_new_name_is_one_of_today_and_short_enough() -> None:
    robot = find("rars")
    rows: Any = whole_robot_interlocks({}, robot.links)
    common = [row.name.partition(": ")[0] for row in rows]
    axes = [row.name for row in (*AXIS_INTERLOCKS, AXIS_RESTARTED, EXCLUDED_AXIS, NO_FEEDBACK, LATE_ANSWER)]
    assert set(renamed.INTERLOCKS.values()) <= {*common, *axes}
    assert not set(renamed.INTERLOCKS) & {*common, *axes}
    assert max(map(len, (*common, *axes))) <= 24


def test_a_stage_of_a_stop_is_found_by_its_old_name_and_an_interlock_of_one_s_own_by_its_own() -> None:
    found = renamed.Interlocks({"stop not acknowledged: left": "ramp", "paused": "by the owner"}, "rig")
    with pytest.warns(RenamedWarning, match="'reset unconfirmed' is called 'stop not acknowledged' now"):
        assert found["reset unconfirmed: left"] == "ramp"
    assert found["paused"] == "by the owner"
    assert renamed.NOT_ACKNOWLEDGED == stops.NOT_ACKNOWLEDGED
