"""Whether a cycle fits on the line: prices against published times, and what is said when it does not."""

import re

import pytest

from firmware_bridge.bridge import Bridge
from firmware_bridge.drivers.serial.plan import PlanError, fitting_plan, plan_for
from firmware_bridge.drivers.serial.rows import IN_TURN
from firmware_bridge.robot import Robot, find
from firmware_bridge.units import MICROSECOND, MILLISECOND
from firmware_bridge.wire.maxon.frame import Generation

RARS = find("rars")


def over(generation: Generation, **changes: object) -> Robot:
    robot = RARS.over_serial(generation)
    bus = type(robot.bus).model_validate(robot.bus.model_dump() | changes)
    return robot.model_copy(update={"bus": bus})


def price(robot: Robot, what: str) -> int:
    return next(entry.time for entry in plan_for(robot).entries if entry.what.startswith(what))


@pytest.mark.parametrize(
    ("robot", "low_us", "high_us"),
    [
        # 24 bytes of ten bits at 115.2 kBd and at 1 MBd; EPOS2 Application Notes, p. 168, for 38.4 kBd:
        # 9.995 ms with a PC's own time in it.
        (over(Generation.V1, port_latency_us=0), 2_083, 2_084),
        (over(Generation.V1, port_latency_us=0, baud=38_400), 6_250, 9_995),
        (over(Generation.V2, port_latency_us=0), 240, 240),
        (over(Generation.V2, port_latency_us=1_000), 1_240, 1_240),
        (over(Generation.V1, port_latency_us=1_000), 5_083, 5_084),
    ],
    ids=["v1", "v1 38400", "v2", "v2 usb", "v1 usb"],
)
def test_a_read_costs_its_bytes_and_the_port_s_patience(robot: Robot, low_us: int, high_us: int) -> None:
    assert low_us * MICROSECOND <= price(robot, "position of node 1") <= high_us * MICROSECOND


def test_the_gateway_costs_130_microseconds_and_two_frames() -> None:
    robot = over(Generation.V2)
    more = price(robot, "position of node 2") - price(robot, "position of node 1")
    assert more == 130 * MICROSECOND + 2 * 138 * MICROSECOND


@pytest.mark.parametrize("cycle_ms", [34, 35, 50])
def test_usb_holds_the_cycle_of_50_ms(cycle_ms: int) -> None:
    plan = fitting_plan(over(Generation.V2, cycle_ms=cycle_ms))
    assert plan.time <= cycle_ms * MILLISECOND
    assert plan.answers_within < plan.time


def test_a_cycle_one_millisecond_too_short_is_refused() -> None:
    with pytest.raises(PlanError, match=r"battery of node 1 .* 0\.9 ms too late.* cycle_ms = 34 or more"):
        fitting_plan(over(Generation.V2, cycle_ms=33))


def test_rs232_is_refused_with_the_object_and_what_would_help() -> None:
    """At the start, before a byte leaves: a line that is too slow must not make every cycle late."""
    with pytest.raises(PlanError) as refusal:
        Bridge(over(Generation.V1))
    told = str(refusal.value)
    assert "a cycle of 50 ms does not hold statusword of node 4 (scissor lift)" in told
    assert "2.5 ms too late" in told
    least = re.search(r"cycle_ms = (\d+)", told)
    assert least is not None
    Bridge(over(Generation.V1, cycle_ms=int(least[1])))
    with pytest.raises(PlanError):
        Bridge(over(Generation.V1, cycle_ms=int(least[1]) - 1))


def test_a_line_that_no_cycle_holds_is_told_so() -> None:
    with pytest.raises(PlanError, match="No longer cycle holds it"):
        fitting_plan(over(Generation.V1, baud=9_600, bridge_heartbeat_ms=10, port_latency_us=20_000))


def test_every_drive_has_its_turn_and_no_cycle_has_two() -> None:
    for row in IN_TURN:
        for place in range(4):
            assert sum(row.due(cycle, place) for cycle in range(10 * row.every)) == 10
    for cycle in range(160):
        assert sum(row.due(cycle, place) for row in IN_TURN for place in range(4)) <= 1
