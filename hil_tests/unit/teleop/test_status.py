"""The robot's status for its operator: heartbeat, holds and faults of drives, each told once."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from firmware_bridge.safety.snapshot import Hold
from firmware_bridge.units import MILLISECOND, SECOND
from firmware_bridge.wire.cia402 import State

if TYPE_CHECKING:
    from collections.abc import Callable

    from hil_tests.unit.teleop.conftest import Bench


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


BOOT, STANDBY, ACTIVE, CRITICAL, EMERGENCY, TERMINATED = 1, 3, 4, 5, 6, 8


def status(bench: Bench) -> tuple[int, int]:
    heartbeat = bench.told(0)
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
    bench.snapshot = replace(bench.snapshot, drives=bench.drives(state=[State.FAULT, None, None, None]))
    assert status(bench) == (0x41, BOOT)
    bench.snapshot = replace(bench.snapshot, drives=bench.drives(fault=[0x8611, 0, 0, 0]))
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
    bench.snapshot = replace(healthy, drives=bench.drives(fault=[0, 0x8611, 0, 0]))
    assert texts(bench.report()) == [(2, "EPOS 2 0x8611 (right)")]
    assert texts(bench.report()) == []
    bench.snapshot = replace(healthy, drives=bench.drives(fault=[0, 0x2310, 0, 0]))
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
