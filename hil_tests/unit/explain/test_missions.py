"""Runs of the bench explained: those in good order have no incident, and each visible fault is named."""

from pathlib import Path

import pytest

from emulators.bench import mission as missions
from emulators.robots.rars import BENCH_SETUP
from emulators.run import RunOrder, drive
from firmware_bridge.explain.explainer import Explained, Setup, explain
from firmware_bridge.explain.source import frames
from firmware_bridge.robot_types import find

RARS = find("rars")
VISIBLE: tuple[tuple[float, str, set[int | None], str], ...] = (
    (9.5, "babbling", {None}, "001 comes 5000 times a second"),
    (27.0, "silent_node", {3}, "no heartbeat"),
    (33.0, "emergency", {2, 3, 4}, "0x8130"),
    (39.0, "emergency", {2}, "0x8110"),
    (45.0, "controller_silent", {100}, "no heartbeat"),
    (45.0, "emergency", {1, 2, 3, 4}, "0x8130"),
    (52.0, "nmt_while_enabled", {1}, "NMT reset node"),
    (59.0, "restart", {2}, "it has started again while it was enabled"),
    (66.0, "emergency", {1, 2, 3, 4}, "0x3220"),
    (76.5, "emergency", {1}, "0x4210"),
    (83.5, "emergency", {2}, "0xFF0A"),
    (95.0, "emergency", {2}, "0xFF03"),
    (101.5, "emergency", {1}, "0xFF03"),
    (109.5, "silent_node", {3}, "no heartbeat"),
    (109.5, "emergency", {3}, "0x81FD"),
    (115.5, "controller_silent", {100}, "no heartbeat"),
    (115.5, "emergency", {1, 2}, "0x81FD"),
)
"""Faults of the mission that reach the bus: when they begin, their incident, its nodes, its text."""
WITHIN_S = 0.75


def run(name: str, folder: Path) -> Explained:
    order = RunOrder(RARS, BENCH_SETUP, name, missions.find(name, RARS, BENCH_SETUP), 0, folder)
    drive(order, lambda _: None)
    return explain(frames(folder, lambda _: None), Setup())


def test_a_mission_in_good_order_has_no_incident(tmp_path: Path) -> None:
    found = run("line", tmp_path)
    assert found.incidents == ()
    assert found.nodes == (1, 2, 3, 4, 100)
    assert found.frames > 10_000


@pytest.mark.long(beside="test_a_mission_in_good_order_has_no_incident")
def test_circles_have_no_incident(tmp_path: Path) -> None:
    assert run("circles", tmp_path).incidents == ()


@pytest.mark.long(beside="test_a_mission_in_good_order_has_no_incident")
def test_each_fault_that_reaches_the_bus_is_named(tmp_path: Path) -> None:
    found = run("faults", tmp_path)
    missing = [
        (began, kind, text)
        for began, kind, nodes, text in VISIBLE
        if not nodes
        <= {
            one.node
            for one in found.incidents
            if one.kind.name == kind
            and text in one.what
            and 0 <= (one.at - found.began_at) / 1e9 - began < WITHIN_S
        }
    ]
    assert missing == []
    # Nothing is named that was no fault: each incident lies within one, or follows it.
    begins = [began for began, *_ in VISIBLE] + [88.5]
    stray = [
        one
        for one in found.incidents
        if not any(0 <= (one.at - found.began_at) / 1e9 - it < 1 for it in begins)
    ]
    assert stray == []
    assert not [one for one in found.incidents if one.kind.name == "not_moving"]
