"""Telemetry for the operator: its contents, rates and signs."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from firmware_bridge.motion.pose import Pose
from firmware_bridge.units import MILLISECOND, SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

    from hil_tests.unit.teleop.bench import RarsBench


def named(bench: RarsBench, name: str) -> float | None:
    bench.report()
    replies = bench.order(512, 251) + bench.order(512, 252)
    values = {one.name: one.value for one in replies if one.get_type().startswith("NAMED")}
    value: float | None = values.get(name)
    return value


def test_rates_of_two_seconds(bench: RarsBench) -> None:
    bench.now = -CYCLE  # the first report at 0
    counts = Counter(one.get_type() for _ in range(40) for one in bench.report())
    assert counts == {
        "HEARTBEAT": 2,
        "ODOMETRY": 40,
        "LOCAL_POSITION_NED": 40,
        "ATTITUDE": 40,
        "NAMED_VALUE_FLOAT": 20 + 10 + 4 * 10,
        "DEBUG_FLOAT_ARRAY": 20,
        "WHEEL_DISTANCE": 10,
        "NAMED_VALUE_INT": 2 * 4,
        "SYS_STATUS": 2,
        "EXTENDED_SYS_STATE": 2,
        "BATTERY_STATUS": 1,
        "VFR_HUD": 2,
        "GLOBAL_POSITION_INT": 2,
        "CURRENT_MODE": 1,
        "AVAILABLE_MODES_MONITOR": 1,
        "GPS_RAW_INT": 1,
        "HOME_POSITION": 1,
    }


def test_one_report_is_sent_in_this_order(bench: RarsBench) -> None:
    bench.now = -CYCLE
    sent = [vars(one).get("name", one.get_type()) for one in bench.report()]
    assert sent == [
        "HEARTBEAT", "ODOMETRY", "LOCAL_POSITION_NED", "ATTITUDE", "STEER", "wheels", "WHEEL_DISTANCE",
        "ZPOS", "I1", "I2", "I3", "I4", "DETECT", "LAMP", "SYS_STATUS", "EXTENDED_SYS_STATE",
        "VFR_HUD", "GLOBAL_POSITION_INT", "BATTERY_STATUS", "CURRENT_MODE", "AVAILABLE_MODES_MONITOR",
        "GPS_RAW_INT", "HOME_POSITION",
    ]  # fmt: skip


@pytest.mark.parametrize("jitter_ms", [0, 3, 12])
def test_a_report_that_jitters_keeps_the_rates(make_bench: Callable[[], RarsBench], jitter_ms: int) -> None:
    bench = make_bench()
    counts: Counter[str] = Counter()
    for cycle in range(200):
        late_ms = jitter_ms if cycle % 2 == 0 else 0
        bench.now = 3 * SECOND + cycle * CYCLE + late_ms * MILLISECOND + 1_234_567 - CYCLE
        counts.update(one.get_type() for one in bench.report())
    assert counts["ODOMETRY"] == 200
    assert counts["HEARTBEAT"] == 10


def test_after_a_gap_nothing_is_sent_in_a_burst(bench: RarsBench) -> None:
    bench.report()
    bench.now += 10 * SECOND
    assert Counter(one.get_type() for one in bench.report())["ODOMETRY"] == 1
    assert Counter(one.get_type() for one in bench.report())["ODOMETRY"] == 1


def test_the_next_message_is_announced(bench: RarsBench) -> None:
    assert bench.operator.next_due == 0
    bench.report()
    due = bench.operator.next_due
    assert bench.now < due <= bench.now + 50 * MILLISECOND


def test_left_of_the_start_is_west_in_the_telemetry(bench: RarsBench) -> None:
    bench.pose = Pose(1.0, 2.0, math.radians(30))
    bench.body = replace(bench.body, speed_mps=0.4, yaw_rate_rad_s=0.2)
    odometry = bench.reported(331)
    assert (odometry.x, odometry.y, odometry.z) == (1.0, -2.0, 0.0)
    assert 2.0 * math.atan2(odometry.q[3], odometry.q[0]) == pytest.approx(-math.radians(30))
    assert (odometry.vx, odometry.vy) == (pytest.approx(0.4), 0.0)
    assert odometry.yawspeed == pytest.approx(-0.2)
    assert (odometry.frame_id, odometry.child_frame_id, odometry.estimator_type) == (1, 12, 1)
    assert math.isnan(odometry.pose_covariance[0])
    assert math.isnan(odometry.velocity_covariance[0])
    position = bench.reported(32)
    assert (position.x, position.y) == (1.0, -2.0)
    assert position.vx == pytest.approx(0.4 * math.cos(math.radians(30)))
    assert position.vy == pytest.approx(-0.4 * math.sin(math.radians(30)))
    attitude = bench.reported(30)
    assert attitude.yaw == pytest.approx(-math.radians(30))
    assert attitude.yawspeed == pytest.approx(-0.2)


@pytest.mark.parametrize(("turns", "yaw"), [(1.25, -math.pi / 2), (-2.25, math.pi / 2), (3.0, 0.0)])
def test_many_turns_are_reported_as_a_direction(bench: RarsBench, turns: float, yaw: float) -> None:
    bench.pose = Pose(0.0, 0.0, turns * 2.0 * math.pi)
    assert bench.reported(30).yaw == pytest.approx(yaw, abs=1e-6)


def test_times_are_those_of_the_snapshot(bench: RarsBench) -> None:
    bench.now = 12_300_000_000
    assert bench.reported(30).time_boot_ms == 12_350
    assert bench.reported(331).time_usec == 12_400_000
    bench.now = 2**32 * MILLISECOND
    assert bench.reported(30).time_boot_ms == 50


def test_steering_is_reported_in_degrees_left_positive(bench: RarsBench) -> None:
    bench.body = replace(bench.body, steer_rad=math.radians(12.5))
    assert named(bench, "STEER") == pytest.approx(12.5)
    bench.body = replace(bench.body, steer_rad=None)
    assert named(bench, "STEER") is None


def test_the_lift_is_reported_in_meters(bench: RarsBench) -> None:
    bench.body = replace(bench.body, lift_m=0.75)
    assert named(bench, "ZPOS") == 0.75
    bench.body = replace(bench.body, lift_m=None)
    assert named(bench, "ZPOS") is None


def test_wheels_and_currents(bench: RarsBench) -> None:
    turn = 2.0 * math.pi
    bench.axes(
        velocity=[1.0, 2.0, 3.0, 4.0],
        current_a=[0.1, -0.2, 0.3, 0.004],
        position=[turn, -turn / 2.0, 1.0, 1.0],
    )
    wheels = bench.reported(350)
    assert (wheels.name, wheels.data[:3]) == ("wheels", [1.0, 2.0, 0.0])
    # one turn of a wheel: 2 pi x 50 mm
    distance = bench.reported(9000)
    assert distance.count == 2
    assert distance.distance[:3] == pytest.approx([0.314159, -0.157080, 0.0], abs=1e-6)
    assert [named(bench, f"I{n}") for n in (1, 2, 3, 4)] == pytest.approx([0.1, -0.2, 0.3, 0.004])
    assert bench.reported(147).current_battery == 60
    assert bench.reported(1).current_battery == 60


@pytest.mark.parametrize(
    ("amperes", "centiamperes"), [(0.019, 1), (-0.02, 2), (400.0, 0x7FFF), (math.nan, -1)]
)
def test_the_current_is_reported_in_whole_steps_as_far_as_the_field_goes(
    bench: RarsBench, amperes: float, centiamperes: int
) -> None:
    bench.axes(current_a=[amperes, 0.0, 0.0, 0.0])
    assert bench.reported(1).current_battery == centiamperes


@pytest.mark.parametrize(
    ("volts", "millivolts", "charge", "healthy"),
    [
        (24.6, 24_600, 1, True),
        (21.0, 21_000, 1, True),
        (20.999, 20_999, 2, False),
        (None, 65_535, 0, False),
        (99.0, 65_534, 1, True),
        (-1.0, 0, 2, False),
        (float("nan"), 65_535, 2, False),
        (float("inf"), 65_534, 1, True),
    ],
)
def test_the_battery(
    bench: RarsBench, volts: float | None, millivolts: int, charge: int, *, healthy: bool
) -> None:
    bench.sensors({} if volts is None else {"battery": volts})
    battery = bench.reported(147)
    assert battery.voltages == [millivolts] + [65_535] * 9
    assert (battery.charge_state, battery.battery_remaining) == (charge, -1)
    system = bench.reported(1)
    assert system.voltage_battery == millivolts
    assert bool(system.onboard_control_sensors_health & 33_554_432) is healthy


def test_lamp_and_detector_are_reported(bench: RarsBench) -> None:
    bench.order(405, 1)
    assert (named(bench, "LAMP"), named(bench, "DETECT")) == (1, 0)
    bench.order(181, 0, 1)
    assert (named(bench, "LAMP"), named(bench, "DETECT")) == (1, 1)


def test_corrupt_bytes_and_faulted_drives_are_counted(bench: RarsBench) -> None:
    bench.send(b"nonsense")
    bench.send(b"\xfdnonsense")
    bench.axes(fault=["", "0x8611", "0x2310", ""])
    system = bench.reported(1)
    assert (system.errors_comm, system.errors_count1) == (2, 2)


def test_odometry_reports_how_often_it_was_reset(bench: RarsBench) -> None:
    bench.order(179, 1)
    bench.order(179, 1)
    assert bench.reported(331).reset_counter == 2


CYCLE = 50 * MILLISECOND
