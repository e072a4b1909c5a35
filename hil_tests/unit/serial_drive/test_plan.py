"""Time of a cycle on the line: prices against published times, and the report of one that does not fit."""

import re

import pytest

from firmware_bridge.drivers.all_drivers import all_drivers_of
from firmware_bridge.drivers.link_drivers import PlanError
from firmware_bridge.families.epos2.driver.serial.feedback import IN_TURN
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.driver.serial.plan import fitting_plan, plan_for
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.robot import AnyRobot, Output
from firmware_bridge.units import MICROSECOND, MILLISECOND
from hil_tests.unit.drivers.robots import LINK, RARS, with_link


def over(generation: Generation, cycle_ms: int = 50, **changes: object) -> AnyRobot:
    robot = RARS.model_copy(update={"cycle_ms": cycle_ms})
    return with_link(over_serial(robot, generation), changes)


def price(robot: AnyRobot, what: str) -> int:
    return next(entry.time for entry in plan_for(robot, LINK).entries if entry.what.startswith(what))


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
def test_a_read_costs_its_bytes_and_the_port_s_patience(robot: AnyRobot, low_us: int, high_us: int) -> None:
    assert low_us * MICROSECOND <= price(robot, "position of node 1") <= high_us * MICROSECOND


def test_the_gateway_costs_130_microseconds_and_two_frames() -> None:
    robot = over(Generation.V2)
    more = price(robot, "position of node 2") - price(robot, "position of node 1")
    assert more == 130 * MICROSECOND + 2 * 138 * MICROSECOND


@pytest.mark.parametrize("cycle_ms", [34, 35, 50])
def test_usb_holds_the_cycle_of_50_ms(cycle_ms: int) -> None:
    plan = fitting_plan(over(Generation.V2, cycle_ms=cycle_ms), LINK)
    assert plan.time <= cycle_ms * MILLISECOND
    assert plan.answers_within < plan.time


def test_a_cycle_one_millisecond_too_short_is_refused() -> None:
    with pytest.raises(PlanError, match=r"battery of node 1 .* 0\.9 ms too late.* cycle_ms = 34 or more"):
        fitting_plan(over(Generation.V2, cycle_ms=33), LINK)


def test_rs232_is_refused_with_the_object_and_what_would_help() -> None:
    """At the start, before a byte leaves: a line that is too slow must not make every cycle late."""
    with pytest.raises(PlanError) as refusal:
        all_drivers_of(over(Generation.V1))
    stated = str(refusal.value)
    assert "link 'drives': a cycle of 50 ms does not hold statusword of node 4 (scissor lift)" in stated
    assert "2.5 ms too late" in stated
    assert "or more in the robot file" in stated
    assert "(links.drives.port_latency_us)" in stated
    least = re.search(r"cycle_ms = (\d+)", stated)
    assert least is not None
    all_drivers_of(over(Generation.V1, cycle_ms=int(least[1])))
    with pytest.raises(PlanError):
        all_drivers_of(over(Generation.V1, cycle_ms=int(least[1]) - 1))


def test_a_line_that_no_cycle_holds_is_refused() -> None:
    with pytest.raises(PlanError, match="No longer cycle holds it"):
        fitting_plan(over(Generation.V1, baud=9_600, bridge_heartbeat_ms=10, port_latency_us=20_000), LINK)


def test_a_link_that_is_served_every_second_time_has_twice_the_time() -> None:
    least = next(ms for ms in range(30, 140) if plan_for(over(Generation.V1, ms), LINK).excess() is None)
    fitting_plan(over(Generation.V1, -(-least // 2), every=2), LINK)
    with pytest.raises(PlanError, match=rf"cycle_ms = {-(-least // 2)} or more"):
        fitting_plan(over(Generation.V1, -(-least // 2) - 1, every=2), LINK)


def test_outputs_cost_a_write_for_each_drive_that_has_any() -> None:
    settings = [{"axis": "right", "output": pin} for pin in (1, 2)]
    lamps = tuple(
        Output.model_validate({"name": f"lamp{i}", "title": "lamp", "link": LINK, "settings": one})
        for i, one in enumerate(settings)
    )
    robot = over(Generation.V2).model_copy(update={"outputs": lamps})
    more = plan_for(robot, LINK).time - plan_for(over(Generation.V2), LINK).time
    assert more == price(robot, "outputs of node 2") == price(robot, "controlword of node 2")


def test_every_drive_has_its_turn_and_no_cycle_has_two() -> None:
    for row in IN_TURN:
        for place in range(4):
            assert sum(row.due(cycle, place) for cycle in range(10 * row.every)) == 10
    for cycle in range(160):
        assert sum(row.due(cycle, place) for row in IN_TURN for place in range(4)) <= 1
