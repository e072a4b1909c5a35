"""The diff_drive robot on the bench: what it has and RARS has not, a path follower and a lamp."""

from collections.abc import Callable, Iterator
from typing import Any, Final

import numpy as np
import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import Mission, MissionFileError, parse
from emulators.bench.operator import ScriptedOperator
from emulators.rig import Rig
from emulators.servo.axis import ServoAxis
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds

READY: Final = {"at_s": 3.0, "title": "arm", "arm": True}
GUIDED: Final = {"at_s": 4.0, "title": "guide", "path_follower": "figure_eight"}
LAMP: Final = 0b0001
Ridden = Callable[..., Rig]


def story(*steps: dict[str, Any]) -> Mission:
    """Return a mission of these steps, read as from a file."""
    lines = ['title = "a story"', "duration_s = 100.0"]
    for step in sorted(steps, key=lambda step: step["at_s"]):
        lines.append("[[step]]")
        for key, value in ({"title": "a step"} | step).items():
            stated = str(value).lower() if isinstance(value, bool) else repr(value).replace("'", '"')
            lines.append(f"{key} = {stated}")
    robot = find("diff_drive")
    return parse("\n".join(lines), "story.toml", robot, bench_setup_of(robot))


@pytest.fixture
def rides() -> Iterator[Ridden]:
    made: list[Rig] = []

    def begin(*steps: dict[str, Any]) -> Rig:
        robot = find("diff_drive")
        bench_setup = bench_setup_of(robot)
        operator = ScriptedOperator(robot, bench_setup, story(*steps), np.random.default_rng(0))
        made.append(Rig(robot, bench_setup, operator))
        return made[-1]

    yield begin
    for rig in made:
        rig.finish()


def speed(rig: Rig) -> float:
    newest: float = rig.samples[-1]["speed_mps"]
    return newest


def lit(rig: Rig) -> bool:
    return bool(next(iter(rig.devices.motors(ServoAxis).values())).outputs & LAMP)


def held(rig: Rig) -> set[str]:
    return {event.name for event in rig.interlock_events}


def test_the_guide_drives_both_circles_and_comes_back_to_where_they_touch(rides: Ridden) -> None:
    rig = rides(READY, GUIDED)
    rig.run(from_seconds(48.0))
    x, y = rig.samples.column("odometry_x_m"), rig.samples.column("odometry_y_m")
    assert y.max() == pytest.approx(2.0, abs=0.05)
    assert y.min() == pytest.approx(-2.0, abs=0.05)
    assert np.abs(x).max() == pytest.approx(1.0, abs=0.05)
    circles = np.minimum(np.abs(np.hypot(x, y - 1.0) - 1.0), np.abs(np.hypot(x, y + 1.0) - 1.0))
    assert circles.max() < 0.05
    assert held(rig) == {"starting", "not armed", "acceleration limit"}


def test_a_moved_stick_takes_over_from_the_guide(rides: Ridden) -> None:
    rig = rides(READY, GUIDED, {"at_s": 7.0, "speed_mps": -0.1}, {"at_s": 10.0, "speed_mps": 0.0})
    rig.run(from_seconds(6.9))
    assert speed(rig) == pytest.approx(0.3, rel=0.05)
    rig.run(from_seconds(9.9))
    assert speed(rig) == pytest.approx(-0.1, rel=0.05)
    rig.run(from_seconds(13.0))
    assert abs(speed(rig)) < 0.002


def test_no_guide_starts_by_arming(rides: Ridden) -> None:
    early = {"at_s": 2.0, "title": "too early", "path_follower": "figure_eight"}
    stopped = {"at_s": 7.0, "emergency_stop": True}, {"at_s": 8.5, "clear": True}, {"at_s": 9.0, "arm": True}
    rig = rides(early, READY, {**GUIDED, "at_s": 5.0}, *stopped)
    rig.run(from_seconds(4.9))
    assert abs(speed(rig)) < 0.002, "refused before it was armed, and forgotten"
    rig.run(from_seconds(6.9))
    assert speed(rig) > 0.2
    rig.run(from_seconds(12.0))
    assert "not armed" not in {event.name for event in rig.interlock_events if event.ended is None}
    assert abs(speed(rig)) < 0.002, "armed again, the path follower is gone"


def test_a_silent_operator_stops_a_guided_robot(rides: Ridden) -> None:
    rig = rides(READY, GUIDED, {"at_s": 7.0, "silent_s": 3.0})
    rig.run(from_seconds(9.5))
    assert "operator link timeout" in held(rig)
    assert abs(speed(rig)) < 0.002


def test_a_guide_that_is_not_there_is_refused_by_key() -> None:
    with pytest.raises(MissionFileError, match=r"step\[0\]\.path_follower: .*perhaps 'figure_eight'"):
        story({"at_s": 1.0, "path_follower": "figure_eigth"})


def test_the_lamp_is_the_operators_and_a_stop_sets_it_on(rides: Ridden) -> None:
    rig = rides(
        READY,
        {"at_s": 5.0, "lamp": True},
        {"at_s": 6.0, "lamp": False},
        {"at_s": 8.0, "emergency_stop": True},
    )
    seen = []
    for second in (2.5, 4.5, 5.8, 7.5, 9.0):
        rig.run(from_seconds(second))
        seen.append(lit(rig))
    assert seen == [True, False, True, False, True]
