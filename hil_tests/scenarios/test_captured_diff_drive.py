"""The diff_drive robot under cameras, on the whole bench: seen, hidden, mistaken, and its reported pose."""

import math
from collections.abc import Iterator
from typing import Any, Final

import pytest

from emulators.bench.faults import read
from emulators.motion_capture.system import MotionCapture
from emulators.rig import Rig
from emulators.testing.inherited.scripted import scripted
from firmware_bridge.motion.captured import Bounds, Captured, Located, Sight, Source
from firmware_bridge.motion.pose import Pose
from firmware_bridge.units import MILLISECOND, SECOND, from_seconds
from hil_tests.unit.capture_driver.captured_diff_drive import captured_diff_drive

STORY: Final = """
title = "a story"
duration_s = 100.0
[[step]]
at_s = 3.0
title = "arm"
arm = true
[[step]]
at_s = 4.0
title = "guide"
path_follower = "figure_eight"
"""
FAULTS: Final[list[dict[str, Any]]] = [
    {"kind": "body_hidden", "at_s": 6.0, "until_s": 7.0},
    {"kind": "markers_swapped", "at_s": 9.0, "until_s": 10.0},
]
BOUNDS: Final = Bounds(0.03, 0.1, 0.05, 0.05, 150 * MILLISECOND)


@pytest.fixture(scope="module")
def rig() -> Iterator[Rig]:
    with scripted(captured_diff_drive(), STORY, faults=[read(each) for each in FAULTS]) as made:
        yield made


def truth(rig: Rig) -> Pose:
    plant = rig.devices.plant
    return Pose(*(plant.outputs[plant.output_names.index(name)] for name in ("x", "y", "heading")))


def test_it_is_located_by_cameras_and_by_odometry_where_they_do_not_see(rig: Rig) -> None:
    captured = Captured(BOUNDS)
    located: dict[int, tuple[Located, float]] = {}
    places: dict[int, Pose] = {}
    for millisecond in range(3_000, 12_000, 10):
        now = millisecond * MILLISECOND
        rig.run(now)
        places[now] = truth(rig)
        facts, odometry = rig.bridge.seen.facts, rig.bridge.seen.pose
        at = facts.axes["left"].sampled_at
        reading = facts.sensors.get("place")
        sight = None
        if reading is not None and reading.pose is not None:
            x, y, _ = reading.pose.position
            sight = Sight(Pose(x, y, reading.pose.heading_rad), reading.sampled_at)
        if at in places:
            found = captured.step(odometry, at, sight)
            there = places[at]
            located[at] = (found, math.hypot(found.pose.x_m - there.x_m, found.pose.y_m - there.y_m))

    def within(begin: float, end: float) -> list[tuple[Located, float]]:
        return [it for at, it in located.items() if from_seconds(begin) <= at < from_seconds(end)]

    assert {it.source for it, _ in within(4.0, 6.0)} == {Source.CAPTURED}
    assert max(off for _, off in within(4.0, 6.0)) < 0.002
    assert {it.source for it, _ in within(6.3, 7.0)} == {Source.ODOMETRY}
    assert max(off for _, off in within(6.0, 7.0)) < 0.02
    assert {it.source for it, _ in within(7.1, 9.0)} == {Source.CAPTURED}
    assert {it.source for it, _ in within(9.3, 10.0)} == {Source.ODOMETRY}
    assert max(off for _, off in within(9.0, 10.0)) < 0.02
    assert max(it.off_m for it, _ in within(9.1, 10.0)) == pytest.approx(0.3, abs=0.02)
    assert {it.source for it, _ in within(10.1, 12.0)} == {Source.CAPTURED}


def test_what_the_cameras_are_requested_is_let_out_and_nothing_of_it_is_refused(rig: Rig) -> None:
    rig.run(12 * SECOND)
    assert rig.guard.refused == 0
    assert rig.bridge.seen.facts.armed
    assert rig.devices.nodes(MotionCapture)["cameras of cameras"].frames > 2_800


def test_a_run_put_back_is_seen_the_same_again(rig: Rig) -> None:
    rig.run(12 * SECOND)
    moment = rig.snapshot()
    rig.runs(0.5)
    before = rig.bridge.seen.facts.sensors["place"]
    rig.restore(moment)
    assert rig.bridge.seen.facts.sensors["place"] != before
    rig.runs(0.5)
    assert rig.bridge.seen.facts.sensors["place"] == before
