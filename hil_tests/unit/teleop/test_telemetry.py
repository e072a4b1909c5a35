"""What the operator is told, how often, and with which sign."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from firmware_bridge.motion.odometry import Pose
from firmware_bridge.safety.snapshot import DriveSnapshot, Hold
from firmware_bridge.units import MILLISECOND, SECOND
from firmware_bridge.wire.cia402 import State

if TYPE_CHECKING:
    from collections.abc import Callable

    from hil_tests.unit.teleop.conftest import Bench


def told(bench: Bench, number: int) -> Any:
    """Ask for one message and return it."""
    bench.report()
    return bench.order(512, number)[0]


def named(bench: Bench, name: str) -> float | None:
    bench.report()
    replies = bench.order(512, 251) + bench.order(512, 252)
    values = {one.name: one.value for one in replies if one.get_type().startswith("NAMED")}
    value: float | None = values.get(name)
    return value


def texts(messages: list[Any]) -> list[tuple[int, str]]:
    """Return severity and text of each whole STATUSTEXT."""
    whole: list[tuple[int, str]] = []
    for one in messages:
        if one.get_type() != "STATUSTEXT":
            continue
        if one.chunk_seq:
            whole[-1] = (whole[-1][0], whole[-1][1] + one.text)
        else:
            whole.append((one.severity, one.text))
    return whole


def test_rates_of_two_seconds(bench: Bench) -> None:
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
    }


@pytest.mark.parametrize("jitter_ms", [0, 3, 12])
def test_a_report_that_jitters_keeps_the_rates(make_bench: Callable[[], Bench], jitter_ms: int) -> None:
    bench = make_bench()
    counts: Counter[str] = Counter()
    for cycle in range(200):
        late_ms = jitter_ms if cycle % 2 == 0 else 0
        bench.now = 3 * SECOND + cycle * CYCLE + late_ms * MILLISECOND + 1_234_567 - CYCLE
        counts.update(one.get_type() for one in bench.report())
    assert counts["ODOMETRY"] == 200
    assert counts["HEARTBEAT"] == 10


def test_after_a_gap_nothing_is_sent_in_a_burst(bench: Bench) -> None:
    bench.report()
    bench.now += 10 * SECOND
    assert Counter(one.get_type() for one in bench.report())["ODOMETRY"] == 1
    assert Counter(one.get_type() for one in bench.report())["ODOMETRY"] == 1


def test_the_next_message_is_announced(bench: Bench) -> None:
    assert bench.operator.next_due == 0
    bench.report()
    due = bench.operator.next_due
    assert bench.now < due <= bench.now + 50 * MILLISECOND


def test_left_of_the_start_is_west_in_the_telemetry(bench: Bench) -> None:
    bench.snapshot = replace(
        bench.snapshot, pose=Pose(1.0, 2.0, math.radians(30)), speed_mps=0.4, yaw_rate_rad_s=0.2
    )
    odometry = told(bench, 331)
    assert (odometry.x, odometry.y, odometry.z) == (1.0, -2.0, 0.0)
    assert 2.0 * math.atan2(odometry.q[3], odometry.q[0]) == pytest.approx(-math.radians(30))
    assert (odometry.vx, odometry.vy) == (pytest.approx(0.4), 0.0)
    assert odometry.yawspeed == pytest.approx(-0.2)
    assert (odometry.frame_id, odometry.child_frame_id, odometry.estimator_type) == (1, 12, 1)
    assert math.isnan(odometry.pose_covariance[0])
    assert math.isnan(odometry.velocity_covariance[0])
    position = told(bench, 32)
    assert (position.x, position.y) == (1.0, -2.0)
    assert position.vx == pytest.approx(0.4 * math.cos(math.radians(30)))
    assert position.vy == pytest.approx(-0.4 * math.sin(math.radians(30)))
    attitude = told(bench, 30)
    assert attitude.yaw == pytest.approx(-math.radians(30))
    assert attitude.yawspeed == pytest.approx(-0.2)


@pytest.mark.parametrize(("turns", "yaw"), [(1.25, -math.pi / 2), (-2.25, math.pi / 2), (3.0, 0.0)])
def test_many_turns_are_told_as_a_direction(bench: Bench, turns: float, yaw: float) -> None:
    bench.snapshot = replace(bench.snapshot, pose=Pose(0.0, 0.0, turns * 2.0 * math.pi))
    assert told(bench, 30).yaw == pytest.approx(yaw, abs=1e-6)


def test_times_are_those_of_the_snapshot(bench: Bench) -> None:
    bench.now = 12_300_000_000
    assert told(bench, 30).time_boot_ms == 12_350
    assert told(bench, 331).time_usec == 12_400_000
    bench.now = 2**32 * MILLISECOND
    assert told(bench, 30).time_boot_ms == 50


def test_steering_is_told_in_degrees_left_positive(bench: Bench) -> None:
    bench.snapshot = replace(bench.snapshot, steer_rad=math.radians(12.5))
    assert named(bench, "STEER") == pytest.approx(12.5)
    bench.snapshot = replace(bench.snapshot, steer_rad=None)
    assert named(bench, "STEER") is None


def test_the_lift_is_told_in_metres(bench: Bench) -> None:
    bench.snapshot = replace(bench.snapshot, lift_m=0.75)
    assert named(bench, "ZPOS") == 0.75
    bench.snapshot = replace(bench.snapshot, lift_m=None)
    assert named(bench, "ZPOS") is None


def drives(bench: Bench, **changes: Any) -> tuple[DriveSnapshot, ...]:
    """Give each drive the value of its place in each list."""
    return tuple(
        replace(drive, **{name: values[place] for name, values in changes.items()})
        for place, drive in enumerate(bench.snapshot.drives)
    )


def test_wheels_and_currents(bench: Bench) -> None:
    bench.snapshot = replace(
        bench.snapshot,
        drives=drives(
            bench,
            speed_rad_s=[1.0, 2.0, 3.0, 4.0],
            current_ma=[100, -200, 300, 4],
            position_qc=[52_000, -26_000, 1, 1],
        ),
    )
    wheels = told(bench, 350)
    assert (wheels.name, wheels.data[:3]) == ("wheels", [1.0, 2.0, 0.0])
    # 52000 qc are one turn behind the gear of 26 on 500 lines: 2 pi x 50 mm
    distance = told(bench, 9000)
    assert distance.count == 2
    assert distance.distance[:3] == pytest.approx([0.314159, -0.157080, 0.0], abs=1e-6)
    assert [named(bench, f"I{n}") for n in (1, 2, 3, 4)] == pytest.approx([0.1, -0.2, 0.3, 0.004])
    assert told(bench, 147).current_battery == 60
    assert told(bench, 1).current_battery == 60


@pytest.mark.parametrize(
    ("volts", "millivolts", "charge", "healthy"),
    [
        (24.6, 24_600, 1, True),
        (21.0, 21_000, 1, True),
        (20.999, 20_999, 2, False),
        (None, 65_535, 0, False),
        (99.0, 65_534, 1, True),
        (-1.0, 0, 2, False),
    ],
)
def test_the_battery(bench: Bench, volts: float | None, millivolts: int, charge: int, healthy: bool) -> None:  # noqa: FBT001 - a table
    bench.snapshot = replace(bench.snapshot, battery_v=volts)
    battery = told(bench, 147)
    assert battery.voltages == [millivolts] + [65_535] * 9
    assert (battery.charge_state, battery.battery_remaining) == (charge, -1)
    system = told(bench, 1)
    assert system.voltage_battery == millivolts
    assert bool(system.onboard_control_sensors_health & 33_554_432) is healthy


def test_lamp_and_detector_are_told(bench: Bench) -> None:
    bench.order(405, 1)
    assert (named(bench, "LAMP"), named(bench, "DETECT")) == (1, 0)
    bench.order(181, 0, 1)
    assert (named(bench, "LAMP"), named(bench, "DETECT")) == (1, 1)


def test_corrupt_bytes_and_faulted_drives_are_counted(bench: Bench) -> None:
    bench.send(b"nonsense")
    bench.send(b"\xfdnonsense")
    bench.snapshot = replace(bench.snapshot, drives=drives(bench, fault=[0, 0x8611, 0x2310, 0]))
    system = told(bench, 1)
    assert (system.errors_comm, system.errors_count1) == (2, 2)


def test_odometry_tells_how_often_it_was_reset(bench: Bench) -> None:
    bench.order(179, 1)
    bench.order(179, 1)
    assert told(bench, 331).reset_counter == 2


CYCLE = 50 * MILLISECOND
BOOT, STANDBY, ACTIVE, CRITICAL, EMERGENCY, TERMINATED = 1, 3, 4, 5, 6, 8


def status(bench: Bench) -> tuple[int, int]:
    heartbeat = told(bench, 0)
    assert (heartbeat.type, heartbeat.autopilot, heartbeat.custom_mode, heartbeat.mavlink_version) == (
        10,
        0,
        0,
        3,
    )
    return heartbeat.base_mode, heartbeat.system_status


def test_the_heartbeat_of_a_robot_that_waits(bench: Bench) -> None:
    assert status(bench) == (0x41, STANDBY)


def test_the_heartbeat_of_a_robot_that_is_driven(bench: Bench) -> None:
    bench.order(400, 1)
    bench.stick()
    assert status(bench) == (0xC1, ACTIVE)
    bench.now += 500 * MILLISECOND
    assert status(bench) == (0xC1, CRITICAL)


def test_the_heartbeat_of_a_robot_in_trouble(bench: Bench) -> None:
    bench.snapshot = replace(bench.snapshot, drives=drives(bench, state=[State.FAULT, None, None, None]))
    assert status(bench) == (0x41, BOOT)
    bench.snapshot = replace(bench.snapshot, drives=drives(bench, fault=[0x8611, 0, 0, 0]))
    assert status(bench) == (0x41, CRITICAL)
    bench.order(5300, 0)
    assert status(bench) == (0x41, EMERGENCY)
    bench.order(185, 1)
    assert status(bench) == (0x41, TERMINATED)


HOLD = Hold("lift extended", "the lift stands at 100 mm, retracted is below 5 mm", "retract the lift", 0)


def test_a_hold_is_told_with_its_reason_when_it_begins_and_when_it_ends(bench: Bench) -> None:
    assert texts(bench.report()) == []
    assert texts(bench.report(HOLD)) == [
        (4, "the lift stands at 100 mm, retracted is below 5 mm; retract the lift")
    ]
    assert texts(bench.report(replace(HOLD, reason="the lift stands at 90 mm"))) == []
    assert texts(bench.report()) == [(6, "released: lift extended")]
    assert texts(bench.report()) == []


@pytest.mark.parametrize(
    ("name", "severity"),
    [
        ("emergency stop", 2),
        ("drive silent: left", 2),
        ("drive fault: lift", 2),
        ("not armed", 5),
        ("steer angle unknown", 3),
        ("anything else", 4),
    ],
)
def test_how_loud_a_hold_is(bench: Bench, name: str, severity: int) -> None:
    assert texts(bench.report(replace(HOLD, name=name, reason="why", remedy=""))) == [(severity, "why")]


def test_one_hold_that_follows_another_is_told(bench: Bench) -> None:
    other = replace(HOLD, name="not armed", reason="the robot is not armed", remedy="arm the robot")
    bench.report(HOLD)
    assert texts(bench.report(other)) == [
        (6, "released: lift extended"),
        (5, "the robot is not armed; arm the robot"),
    ]
    assert texts(bench.report(other, HOLD))[0][1].startswith("the lift stands")


def test_a_drives_fault_is_told_once_and_its_end_as_well(bench: Bench) -> None:
    bench.report()
    healthy = bench.snapshot
    bench.snapshot = replace(healthy, drives=drives(bench, fault=[0, 0x8611, 0, 0]))
    assert texts(bench.report()) == [(2, "EPOS 2 0x8611 (right)")]
    assert texts(bench.report()) == []
    bench.snapshot = replace(healthy, drives=drives(bench, fault=[0, 0x2310, 0, 0]))
    assert texts(bench.report()) == [(2, "EPOS 2 0x2310 (right)")]
    bench.snapshot = healthy
    assert texts(bench.report()) == [(6, "EPOS 2 fault cleared (right)")]


def test_two_runs_tell_the_same_bytes(make_bench: Callable[[], Bench]) -> None:
    def run() -> list[tuple[bytes, ...]]:
        bench = make_bench()
        operator = bench.operator
        return [
            operator.report(replace(bench.snapshot, now=now), (HOLD,), now)
            for now in range(0, SECOND, 50 * MILLISECOND)
        ]

    assert run() == run()
