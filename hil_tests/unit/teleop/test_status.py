"""The robot's status for its operator: heartbeat, interlock events and drive faults, each reported once."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from firmware_bridge.drivers.driver import Power
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.safety.common import AXIS_INTERLOCKS, whole_robot_interlocks
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from firmware_bridge.safety.snapshot import ActiveInterlock
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.teleop.bench import RarsBench, event

if TYPE_CHECKING:
    from collections.abc import Callable

    from firmware_bridge.packet import Packet


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


def status(bench: RarsBench) -> tuple[int, int]:
    heartbeat = bench.reported(0)
    assert (heartbeat.type, heartbeat.autopilot, heartbeat.custom_mode, heartbeat.mavlink_version) == (
        10,
        0,
        0,
        3,
    )
    return heartbeat.base_mode, heartbeat.system_status


def test_the_heartbeat_of_a_robot_that_waits(bench: RarsBench) -> None:
    assert status(bench) == (0x41, STANDBY)


def test_the_heartbeat_of_a_robot_that_is_driven(bench: RarsBench) -> None:
    bench.order(400, 1)
    bench.stick()
    assert status(bench) == (0xC1, ACTIVE)


@pytest.mark.parametrize(
    ("stops", "severity", "state"),
    [
        (None, Severity.CRITICAL, CRITICAL),
        (None, Severity.WARNING, CRITICAL),
        (None, Severity.NOTICE, ACTIVE),
        (frozenset({"lift"}), Severity.CRITICAL, ACTIVE),
        (frozenset(), Severity.CRITICAL, ACTIVE),
    ],
)
def test_the_status_follows_from_the_active_interlocks(
    bench: RarsBench, stops: frozenset[str] | None, severity: Severity, state: int
) -> None:
    """Whatever has begun it: one that stops the whole robot, and is no notice."""
    bench.order(400, 1)
    bench.stick()
    interlock = InterlockBase("operator link timeout", "send", stops=stops, severity=severity)
    bench.report(ActiveInterlock(interlock.name, "no motion command for 0.6 s", interlock, 0))
    (heartbeat,) = bench.order(512, 0)[:1]
    assert (heartbeat.base_mode, heartbeat.system_status) == (0xC1, state)
    # Disarmed it waits, as any robot does whose operator is away.
    bench.order(400, 0)
    bench.report(ActiveInterlock(interlock.name, "no motion command for 0.6 s", interlock, 0))
    (heartbeat,) = bench.order(512, 0)[:1]
    assert heartbeat.system_status == STANDBY


def test_the_heartbeat_of_a_robot_in_trouble(bench: RarsBench) -> None:
    bench.axes(power=[Power.FAULT, Power.UNKNOWN, Power.UNKNOWN, Power.UNKNOWN])
    assert status(bench) == (0x41, BOOT)
    bench.axes(fault=["0x8611", "", "", ""])
    assert status(bench) == (0x41, CRITICAL)
    bench.order(5300, 0)
    assert status(bench) == (0x41, EMERGENCY)
    bench.order(185, 1)
    assert status(bench) == (0x41, TERMINATED)


HOLD = event("lift extended", "the lift stands at 100 mm, retracted is below 5 mm", "retract the lift")


def test_a_hold_is_reported_with_its_reason_when_it_begins_and_when_it_ends(bench: RarsBench) -> None:
    assert texts(bench.report()) == []
    assert texts(bench.report(HOLD)) == [
        (4, "the lift stands at 100 mm, retracted is below 5 mm; retract the lift")
    ]
    assert texts(bench.report(replace(HOLD, reason="the lift stands at 90 mm"))) == []
    assert texts(bench.report()) == [(6, "cleared: lift extended")]
    assert texts(bench.report()) == []


LOUD = {
    "acceleration limit": Severity.INFO,
    "not armed": Severity.NOTICE,
    "emergency stop": Severity.CRITICAL,
    "bridge stalled": Severity.CRITICAL,
    "link lost: drives": Severity.CRITICAL,
    "second controller: drives": Severity.CRITICAL,
    "axis timeout": Severity.CRITICAL,
    "axis fault": Severity.CRITICAL,
    "axis reconfigured": Severity.CRITICAL,
    "tracking error": Severity.CRITICAL,
    "uncommanded motion": Severity.CRITICAL,
    "position not changing": Severity.CRITICAL,
    "battery low": Severity.CRITICAL,
    "operation paused": Severity.NOTICE,
    "reference lost": Severity.CRITICAL,
    "steer angle unknown": Severity.ERROR,
    "lift height unknown": Severity.ERROR,
    "tilt unknown": Severity.ERROR,
    "load implausible": Severity.CRITICAL,
}
"""All others are warnings."""


def test_how_loud_each_row_of_rars_is(bench: RarsBench) -> None:
    rules = ROBOT_TYPE.rules(bench.robot)[""]
    common = (*whole_robot_interlocks(rules.numbers, bench.robot.links), *AXIS_INTERLOCKS)
    rows = (*common, *rules.interlocks, *rules.limits, *rules.after_limits)
    assert {row.name: row.severity for row in rows} == {
        row.name: LOUD.get(row.name, Severity.WARNING) for row in rows
    }
    assert LOUD.keys() <= {row.name for row in rows}


@pytest.mark.parametrize("severity", Severity)
def test_a_hold_is_as_loud_as_its_row_states(bench: RarsBench, severity: Severity) -> None:
    assert texts(bench.report(event("any", "why", severity=severity))) == [(severity, "why")]


def test_one_hold_that_follows_another_is_reported(bench: RarsBench) -> None:
    other = event("not armed", "the robot is not armed", "arm the robot", Severity.NOTICE)
    bench.report(HOLD)
    assert texts(bench.report(other)) == [
        (6, "cleared: lift extended"),
        (5, "the robot is not armed; arm the robot"),
    ]
    assert texts(bench.report(other, HOLD))[0][1].startswith("the lift stands")


def test_a_drives_fault_is_reported_once_and_its_end_as_well(bench: RarsBench) -> None:
    bench.report()
    bench.axes(fault=["", "0x8611", "", ""])
    assert texts(bench.report()) == [(2, "node 2 (right rear wheel): fault 0x8611")]
    assert texts(bench.report()) == []
    bench.axes(fault=["", "0x2310", "", ""])
    assert texts(bench.report()) == [(2, "node 2 (right rear wheel): fault 0x2310")]
    bench.axes(fault=["", "", "", ""])
    assert texts(bench.report()) == [(6, "node 2 (right rear wheel): fault cleared")]


def test_two_runs_report_the_same_bytes(make_bench: Callable[[], RarsBench]) -> None:
    def run() -> list[tuple[Packet, ...]]:
        bench = make_bench()
        sent = []
        for now in range(0, SECOND, 50 * MILLISECOND):
            bench.facts = replace(bench.facts, now=now)
            sent.append(bench.operator.report(bench.snapshot(), (HOLD,), now))
        return sent

    assert run() == run()
