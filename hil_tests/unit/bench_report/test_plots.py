"""The pictures: one PNG each, the same bytes for the same rows, whatever the run was like."""

import math
from pathlib import Path

import pytest

from emulators.bench.columns import SAMPLE_EVERY, Samples, columns_of
from emulators.bench.plots import draw
from emulators.bench.records import FaultRecord, InterlockEvent
from emulators.robots.rars import BENCH_SETUP
from firmware_bridge.robot_types import find
from firmware_bridge.units import SECOND, to_seconds

RARS = find("rars")
PANELS = BENCH_SETUP.panels
PICTURES = 4
PNG = b"\x89PNG\r\n\x1a\n"


def rows(count: int, speed: float) -> Samples:
    samples = Samples(columns_of([axis.name for axis in RARS.axes], BENCH_SETUP.columns))
    for index in range(count):
        angle = speed * to_seconds(index * SAMPLE_EVERY)
        row = {
            "x_m": math.sin(angle),
            "y_m": 1.0 - math.cos(angle),
            "heading_rad": angle,
            "speed_mps": speed,
            "yaw_rate_rad_s": speed,
            "steer_rad": 0.5,
            "lift_m": 0.01,
            "demanded_speed_mps": speed,
            "armed": float(index > 10),
            "odometry_x_m": math.sin(angle),
            "odometry_y_m": 1.0 - math.cos(angle),
            "current_left_a": 1.0,
            "current_lift_a": 9.0,
        }
        samples.add(index * SAMPLE_EVERY, tuple(row.get(column.name, 0.0) for column in samples.columns))
    return samples


HOLDS = [
    InterlockEvent("not armed", "the robot is not armed", 0, SECOND // 10),
    InterlockEvent("operator link timeout", "a very long reason " * 20, SECOND),
]


@pytest.mark.long(beside="test_short_and_dull_runs_are_drawn_without_complaint")
def test_the_same_rows_give_the_same_bytes(tmp_path: Path) -> None:
    table = rows(200, 0.3)
    written = []
    for name in ("first", "second"):
        folder = tmp_path / name
        folder.mkdir()
        written.append(
            [path.read_bytes() for path in draw(folder, "rars", RARS, PANELS, table, events=HOLDS)]
        )
    assert len(written[0]) == PICTURES
    assert all(picture.startswith(PNG) for picture in written[0])
    assert written[0] == written[1]


@pytest.mark.long(keeps=["one row"])
@pytest.mark.parametrize(
    ("count", "speed", "events"),
    [(1, 0.0, []), (2, 0.0, HOLDS), (300, -0.4, []), (300, 0.0, HOLDS)],
    ids=["one row", "two rows", "backwards", "at rest"],
)
def test_short_and_dull_runs_are_drawn_without_complaint(
    tmp_path: Path, count: int, speed: float, events: list[InterlockEvent]
) -> None:
    table = rows(count, speed)
    assert len(draw(tmp_path, "rars", RARS, PANELS, table, events=events)) == PICTURES


def test_a_run_without_rows_has_no_pictures(tmp_path: Path) -> None:
    assert draw(tmp_path, "rars", RARS, PANELS, rows(0, 0.0), events=[]) == []


@pytest.mark.long(beside="test_short_and_dull_runs_are_drawn_without_complaint")
def test_faults_are_marked_in_the_pictures_over_time_and_in_no_other(tmp_path: Path) -> None:
    table = rows(200, 0.3)
    faults = [
        FaultRecord("frame_loss", "a loose contact", ("steer",), SECOND // 2, SECOND),
        FaultRecord("nmt_foreign_node", "", (), SECOND, SECOND),
        FaultRecord("can_cut", "", ("left",), SECOND),
    ]
    drawn = []
    for name, some in (("sound", []), ("faulty", faults), ("again", faults)):
        folder = tmp_path / name
        folder.mkdir()
        drawn.append(
            {
                path.stem: path.read_bytes()
                for path in draw(folder, "rars", RARS, PANELS, table, events=HOLDS, faults=some)
            }
        )
    sound, faulty, again = drawn
    assert {name for name in sound if sound[name] != faulty[name]} == {"speeds", "currents", "interlocks"}
    assert faulty == again
