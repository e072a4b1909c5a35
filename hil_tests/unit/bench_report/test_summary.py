"""A run's numbers from rows whose answer is known beforehand."""

import json
import math
from collections.abc import Callable

import pytest

from emulators.bench.records import SAMPLE_EVERY, HoldRecord, Sample
from emulators.bench.summary import Run, as_json, summarise
from firmware_bridge.units import MILLISECOND, SECOND, to_seconds

RUN = Run("rars", "line", 7, 4 * SECOND, 2.0, 1000, 3.21, "ab" * 32, {"can": "cd" * 32})


def rows(count: int, speed: Callable[[float], float], **fixed: float) -> list[Sample]:
    """Return rows of a straight run along x, with the odometry `odometry_ahead` metres ahead at each row."""
    ahead = fixed.get("odometry_ahead", 0.0)
    made = []
    x = 0.0
    for index in range(count):
        at = index * SAMPLE_EVERY
        now = speed(to_seconds(at))
        x += now * to_seconds(SAMPLE_EVERY) if index else 0.0
        made.append(
            Sample(
                at=at,
                x_m=x,
                y_m=0.0,
                heading_rad=0.0,
                speed_mps=now,
                yaw_rate_rad_s=fixed.get("yaw_rate", 0.0),
                steer_rad=0.0,
                lift_m=0.0,
                currents_a=(0.5, -1.5),
                motor_speeds_rad_s=(0.0, 0.0),
                demanded_speed_mps=now,
                armed=True,
                odometry_x_m=x + (ahead if index else 0.0),
                odometry_y_m=0.0,
                odometry_heading_rad=0.0,
            )
        )
    return made


def test_a_constant_speed_gives_length_and_no_acceleration() -> None:
    summary = summarise(RUN, rows(101, lambda _: 0.3), [])
    assert summary.path_length_m == pytest.approx(0.3)
    assert summary.max_speed_mps == pytest.approx(0.3)
    assert summary.max_acceleration_mps2 == pytest.approx(0.0, abs=1e-9)


def test_braking_counts_as_acceleration_and_so_does_driving_backwards() -> None:
    summary = summarise(RUN, rows(101, lambda t: 0.5 - 1.4 * t), [])
    assert summary.max_acceleration_mps2 == pytest.approx(1.4)
    assert summary.max_speed_mps == pytest.approx(0.9)


def test_a_step_within_the_window_is_averaged_over_50_ms() -> None:
    summary = summarise(RUN, rows(101, lambda t: 0.1 if t > 0.5 else 0.0), [])
    assert summary.max_acceleration_mps2 == pytest.approx(0.1 / 0.050)


def test_turning_gives_lateral_acceleration() -> None:
    summary = summarise(RUN, rows(11, lambda _: 0.3, yaw_rate=-0.5), [])
    assert summary.max_lateral_acceleration_mps2 == pytest.approx(0.15)


def test_the_odometry_is_measured_against_the_plant() -> None:
    summary = summarise(RUN, rows(11, lambda _: 0.3, odometry_ahead=0.02), [])
    assert summary.odometry_error_m == pytest.approx(0.02)


def test_the_two_frames_are_laid_upon_each_other_at_the_first_row() -> None:
    turned = [
        Sample(
            at=row.at,
            x_m=row.y_m + 5.0,
            y_m=row.x_m,
            heading_rad=math.pi / 2.0,
            speed_mps=row.speed_mps,
            yaw_rate_rad_s=0.0,
            steer_rad=0.0,
            lift_m=0.0,
            currents_a=row.currents_a,
            motor_speeds_rad_s=row.motor_speeds_rad_s,
            demanded_speed_mps=0.0,
            armed=True,
            odometry_x_m=row.x_m,
            odometry_y_m=0.0,
            odometry_heading_rad=0.0,
        )
        for row in rows(11, lambda _: 0.3)
    ]
    assert summarise(RUN, turned, []).max_odometry_error_m == pytest.approx(0.0, abs=1e-12)


def test_a_run_without_rows_has_not_moved() -> None:
    summary = summarise(RUN, [], [])
    assert summary.path_length_m == 0.0
    assert summary.max_acceleration_mps2 == 0.0


def test_the_file_has_the_keys_that_its_readers_rely_on() -> None:
    holds = [
        HoldRecord("lift extended", "lift is 50 mm up", 100 * MILLISECOND, 2 * SECOND),
        HoldRecord("operator silent", "nothing heard for 500 ms", 3 * SECOND),
    ]
    read = json.loads(as_json(summarise(RUN, rows(11, lambda _: 0.1), holds)))
    assert {
        "simulated_s": 4.0,
        "wall_s": 2.0,
        "realtime_factor": 2.0,
        "frames": 1000,
        "bus_load_percent": 3.21,
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
    assert read["holds"] == [
        {"name": "lift extended", "reason": "lift is 50 mm up", "began_s": 0.1, "ended_s": 2.0},
        {"name": "operator silent", "reason": "nothing heard for 500 ms", "began_s": 3.0, "ended_s": None},
    ]
