"""ROME whole on the bench: an orbit by base and arm, and that what befalls one of its boards stops both."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.path_error import Followed, path_error
from emulators.rig import Rig
from emulators.testing.inherited.scripted import mission_of, scripted
from firmware_bridge.robot import Robot
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds

STILL_M = 1e-3
FLIES = """
title = "flies"
duration_s = {lasts}
settled_after_s = 8.0
{faults}
[[step]]
at_s = 2.0
title = "say where the arm stands"
zero = {{ j1 = 0.0, j2 = -90.0, j3 = 90.0, j4 = 0.0, j5 = 60.0, j6 = 0.0 }}
[[step]]
at_s = 3.0
title = "arm"
arm = true
[[step]]
at_s = 3.5
title = "go"
path_follower = "orbit"
{later}
"""


def step(at_s: float, word: str) -> str:
    return f'[[step]]\nat_s = {at_s}\ntitle = "then"\n{word}\n'


def fault(at_s: float, kind: str, more: str = "") -> str:
    return f'[[fault]]\nat_s = {at_s}\nkind = "{kind}"\n{more}\n'


def scaled(**orbit: float) -> Robot[Any]:
    """ROME with another orbit."""
    robot: Robot[Any] = find("rome_arm")
    table = robot.geometry.orbit.model_copy(update=orbit)
    return robot.model_copy(update={"geometry": robot.geometry.model_copy(update={"orbit": table})})


@contextmanager
def flown(
    later: str = "", faults: str = "", robot: Robot[Any] | None = None, lasts: float = 30.0
) -> Iterator[tuple[Rig, missions.Mission]]:
    """A rig that flies the orbit from 3.5 s on."""
    robot = find("rome_arm") if robot is None else robot
    script = mission_of(robot, FLIES.format(later=later, faults=faults, lasts=lasts))
    with scripted(robot, script) as rig:
        yield rig, script


def off(rig: Rig, script: missions.Mission) -> float:
    """Return the distance of base and tool from their reference, once they had settled, m."""
    path = bench_setup_of(rig.robot).paths["orbit"](rig.robot)
    error = path_error(rig.samples, [Followed(3.5, path)], script.settled_after_s)
    assert error.same_instant is not None
    return error.same_instant


def gone(rig: Rig, begin: float, end: float) -> tuple[float, float]:
    """Return the base's distance in this time, and the tool's up and down, by truth, m."""
    rows = (rig.samples.seconds >= begin) & (rig.samples.seconds <= end)
    x, y, up = (rig.samples.column(name)[rows] for name in ("x_m", "y_m", "height_m"))
    return float(np.hypot(np.ptp(x), np.ptp(y))), float(np.ptp(up))


def test_base_and_arm_fly_the_orbit_together_from_beside_it() -> None:
    with flown(lasts=24.0) as (rig, script):
        rig.run(from_seconds(3.9))
        begun = rig.samples[-1]
        rig.run(from_seconds(24.0))
        assert off(rig, script) < 0.010
        assert rig.guard.refused == 0, rig.guard.refusals
        lags = [np.abs(rig.samples.column(f"lag_j{joint}_rad")).max() for joint in range(1, 7)]
        assert max(lags) < 2.0 * math.tau / 200.0, "no step is lost"
        assert abs(rig.samples[-1]["height_m"] - begun["height_m"]) > 0.01, "the arm has its part in it"


@pytest.mark.long(beside="test_base_and_arm_fly_the_orbit_together_from_beside_it")
def test_an_orbit_too_large_for_the_base_takes_its_time_and_states_so() -> None:
    """At 1 m for 1 DU the printed orbit would take 1.02 m/s."""
    with flown(robot=scaled(m_per_du=1.0), lasts=26.0) as (rig, script):
        rig.run(from_seconds(26.0))
        reported = next(record.reason for record in rig.interlock_events if record.name == "time stretched")
        assert "times its time: the base could not follow it" in reported
        assert float(reported.split(" takes ")[1].split(" ")[0]) == pytest.approx(1.95, abs=0.03)
        assert off(rig, script) < 0.010
        speeds = np.hypot(rig.samples.column("speed_mps"), rig.samples.column("speed_left_mps"))
        assert speeds.max() <= 1.02 * rig.robot.geometry.base.limits.speed_mps


@pytest.mark.long(keeps=["arm reset"])
@pytest.mark.parametrize(
    ("faults", "name"),
    [
        (fault(8.0, "board_reset", 'link = "arm"'), "axis restarted: j1"),
        (fault(8.0, "board_reset", 'link = "board"'), "axis timeout: one"),
        (fault(8.0, "board_hangs", 'link = "arm"'), "axis timeout: j1"),
        (fault(8.0, "board_hangs", 'link = "board"'), "axis timeout: one"),
        (fault(8.0, "board_silent", 'link = "arm"\nfor_s = 4.0'), "axis timeout: j1"),
        (fault(8.0, "board_silent", 'link = "board"\nfor_s = 4.0'), "axis timeout: one"),
    ],
    ids=["arm reset", "base reset", "arm hangs", "base hangs", "arm silent", "base silent"],
)
def test_what_befalls_one_board_stops_both(faults: str, name: str) -> None:
    with flown(faults=faults, robot=scaled(height_per_du=2.0)) as (rig, _):
        rig.run(from_seconds(16.0))
        assert any(record.name == name for record in rig.interlock_events), [
            record.name for record in rig.interlock_events
        ]
        base, tool = gone(rig, 6.5, 8.0)
        assert base > 0.2
        assert tool > STILL_M
        assert not rig.samples[-1]["armed"]
        base, tool = gone(rig, 13.0, 16.0)
        assert base < STILL_M
        assert tool < STILL_M


def test_an_emergency_stop_stops_both_and_the_arm_keeps_what_it_carries() -> None:
    with flown(step(8.0, "emergency_stop = true"), robot=scaled(height_per_du=2.0)) as (rig, _):
        rig.run(from_seconds(12.0))
        assert gone(rig, 10.0, 12.0) == pytest.approx((0.0, 0.0), abs=STILL_M)
        wheels = {axis.name for axis in rig.devices.axes if axis.powered}
        assert not wheels


def test_with_its_arm_out_the_base_stays_and_the_arm_may_come_back() -> None:
    robot = scaled(height_per_du=2.0)
    balance = robot.geometry.balance.model_copy(update={"tool_distance_m": 0.25})
    robot = robot.model_copy(update={"geometry": robot.geometry.model_copy(update={"balance": balance})})
    with flown(robot=robot) as (rig, _):
        rig.run(from_seconds(9.0))
        assert any(record.name == "arm out" and record.ended is None for record in rig.interlock_events)
        base, tool = gone(rig, 3.4, 9.0)
        assert base < STILL_M
        assert tool > STILL_M
