"""A run's numbers from rows whose answer is known beforehand."""

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from io import StringIO

import pytest
from rich.console import Console

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.columns import PLANAR, SAMPLE_EVERY, SIDEWAYS, Column, Samples, columns_of
from emulators.bench.records import FaultRecord, InterlockEvent
from emulators.bench.report import show
from emulators.bench.summary import RunFigures, Summary, as_json
from emulators.bench.summary import summarize as summarized
from emulators.robots.rars import BENCH_SETUP
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, SECOND, to_seconds

RUN = RunFigures("rars", "line", 7, 4 * SECOND, 2.0, 1000, 3.21, "ab" * 32, {"can": "cd" * 32}, 5)


AXES = ("left", "right")
LIFT = Column("lift_m", "height", "m", plant="lift", most=True)
CURRENTS = {"current_left_a": 0.5, "current_right_a": -1.5}


def table(rows: Sequence[dict[str, float]]) -> Samples:
    """Return a table of these rows, 10 ms apart; what they leave out is 0."""
    samples = Samples(columns_of(AXES, (*PLANAR, LIFT)))
    for index, row in enumerate(rows):
        values = tuple(row.get(column.name, 0.0) for column in samples.columns)
        samples.add(index * SAMPLE_EVERY, values)
    return samples


def rows(count: int, speed: Callable[[float], float], **fixed: float) -> Samples:
    """Return rows of a straight run along x, with the odometry `odometry_ahead` meters ahead at each row."""
    return table(driven(count, speed, **fixed))


def driven(count: int, speed: Callable[[float], float], **fixed: float) -> list[dict[str, float]]:
    ahead = fixed.get("odometry_ahead", 0.0)
    made: list[dict[str, float]] = []
    x = 0.0
    for index in range(count):
        now = speed(to_seconds(index * SAMPLE_EVERY))
        x += now * to_seconds(SAMPLE_EVERY) if index else 0.0
        made.append(
            {
                "x_m": x,
                "speed_mps": now,
                "yaw_rate_rad_s": fixed.get("yaw_rate", 0.0),
                "odometry_x_m": x + (ahead if index else 0.0),
                **CURRENTS,
            }
        )
    return made


def summarize(
    run: RunFigures, samples: Samples, events: Sequence[InterlockEvent], faults: Sequence[FaultRecord] = ()
) -> Summary:
    return summarized(run, AXES, samples, events, faults)


def test_a_constant_speed_gives_length_and_no_acceleration() -> None:
    summary = summarize(RUN, rows(101, lambda _: 0.3), [])
    assert summary.path_length_m == pytest.approx(0.3)
    assert summary.max_speed_mps == pytest.approx(0.3)
    assert summary.max_acceleration_mps2 == pytest.approx(0.0, abs=1e-9)


def test_braking_counts_as_acceleration_and_so_does_driving_backwards() -> None:
    summary = summarize(RUN, rows(101, lambda t: 0.5 - 1.4 * t), [])
    assert summary.max_acceleration_mps2 == pytest.approx(1.4)
    assert summary.max_speed_mps == pytest.approx(0.9)


def test_a_step_within_the_window_is_averaged_over_50_ms() -> None:
    summary = summarize(RUN, rows(101, lambda t: 0.1 if t > 0.5 else 0.0), [])
    assert summary.max_acceleration_mps2 == pytest.approx(0.1 / 0.050)


def test_a_base_that_moves_to_the_side_is_measured_in_all_directions_over_its_own_cycle() -> None:
    """0.3 m/s ahead and 0.4 m/s to the left are 0.5 m/s; that step, in a cycle of 100 ms, 5 m/s2."""
    own = (*PLANAR, Column(SIDEWAYS, "to the left", "m/s", plant="speed_sideways"))
    samples = Samples(columns_of(AXES, own))
    for index in range(101):
        row = {"speed_mps": 0.3, SIDEWAYS: 0.4} if index > 50 else {}
        samples.add(index * SAMPLE_EVERY, tuple(row.get(column.name, 0.0) for column in samples.columns))
    summary = summarize(replace(RUN, cycle=100 * MILLISECOND), samples, [])
    assert summary.max_speed_mps == pytest.approx(0.5)
    assert summary.max_acceleration_mps2 == pytest.approx(5.0)
    console = Console(width=120, record=True, file=StringIO())
    show(console, summary, bench_setup_of(find("rome")).remarks(find("rome")))
    assert "in all directions, over 100 ms; limit 0.6 of set-points" in console.export_text()


def test_a_body_that_turns_while_it_slides_straight_on_does_not_accelerate() -> None:
    own = (*PLANAR, Column(SIDEWAYS, "to the left", "m/s", plant="speed_sideways"))
    samples = Samples(columns_of(AXES, own))
    for index in range(101):
        turned = 0.02 * index
        row = {"speed_mps": math.cos(turned), SIDEWAYS: -math.sin(turned), "heading_rad": turned}
        samples.add(index * SAMPLE_EVERY, tuple(row.get(column.name, 0.0) for column in samples.columns))
    assert summarize(RUN, samples, []).max_acceleration_mps2 == pytest.approx(0.0, abs=1e-9)


def test_turning_gives_lateral_acceleration() -> None:
    summary = summarize(RUN, rows(11, lambda _: 0.3, yaw_rate=-0.5), [])
    assert summary.max_lateral_acceleration_mps2 == pytest.approx(0.15)


def test_the_odometry_is_measured_against_the_plant() -> None:
    summary = summarize(RUN, rows(11, lambda _: 0.3, odometry_ahead=0.02), [])
    assert summary.odometry_error_m == pytest.approx(0.02)


def test_the_two_frames_are_laid_upon_each_other_at_the_first_row() -> None:
    turned = table(
        [
            {
                "x_m": row.get("y_m", 0.0) + 5.0,
                "y_m": row["x_m"],
                "heading_rad": math.pi / 2.0,
                "odometry_x_m": row["x_m"],
            }
            for row in driven(11, lambda _: 0.3)
        ]
    )
    assert summarize(RUN, turned, []).max_odometry_error_m == pytest.approx(0.0, abs=1e-12)


def test_a_column_that_states_so_is_in_the_summary_with_its_largest_value() -> None:
    summary = summarize(RUN, table([{"lift_m": 0.2}, {"lift_m": -0.4}, {"lift_m": 0.1}]), [])
    assert summary.largest == {"lift_m": 0.4}


def test_a_run_without_rows_has_not_moved() -> None:
    summary = summarize(RUN, table([]), [])
    assert summary.path_length_m == 0.0
    assert summary.max_acceleration_mps2 == 0.0


def test_the_file_has_the_keys_that_its_readers_rely_on() -> None:
    events = [
        InterlockEvent("lift extended", "lift is 50 mm up", 100 * MILLISECOND, 2 * SECOND, remedy="lower it"),
        InterlockEvent("operator link timeout", "nothing received for 500 ms", 3 * SECOND),
    ]
    read = json.loads(as_json(summarize(RUN, rows(11, lambda _: 0.1), events)))
    assert {
        "simulated_s": 4.0,
        "wall_s": 2.0,
        "realtime_factor": 2.0,
        "frames": 1000,
        "bus_load_percent": 3.21,
        "guard_refusals": 5,
        "trace_sha256": "ab" * 32,
        "links_sha256": {"can": "cd" * 32},
        "seed": 7,
        "mission": "line",
        "robot": "rars",
        "max_current_a": 1.5,
    }.items() <= read.items()
    assert read.keys() >= {
        "max_speed_mps",
        "max_acceleration_mps2",
        "path_length_m",
        "odometry_error_m",
    }
    lift = {"name": "lift extended", "reason": "lift is 50 mm up", "began_s": 0.1, "ended_s": 2.0}
    silence = {
        "name": "operator link timeout",
        "reason": "nothing received for 500 ms",
        "began_s": 3.0,
        "ended_s": None,
    }
    assert read["interlock_events"] == [lift | {"remedy": "lower it"}, silence | {"remedy": ""}]


def test_the_faults_that_were_put_on_are_reported_with_their_beginning_and_end() -> None:
    faults = [
        FaultRecord("frame_loss", "a loose contact", ("steer",), SECOND, 3 * SECOND // 2),
        FaultRecord("can_cut", "", ("bridge", "left"), 2 * SECOND),
    ]
    summary = summarize(RUN, rows(11, lambda _: 0.1), [], faults)
    reported = json.loads(as_json(summary))["faults"]
    assert reported == [
        {
            "kind": "frame_loss",
            "title": "a loose contact",
            "nodes": ["steer"],
            "began_s": 1.0,
            "ended_s": 1.5,
        },
        {"kind": "can_cut", "title": "", "nodes": ["bridge", "left"], "began_s": 2.0, "ended_s": None},
    ]
    console = Console(width=120, record=True, file=StringIO())
    show(console, summary, BENCH_SETUP.remarks(find("rars")))
    text = console.export_text()
    assert "faults that were put on" in text
    assert all(word in text for word in ("1.50 s", "end", "frame_loss", "a loose contact", "bridge, left"))
