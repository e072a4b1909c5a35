"""Effects of each row of the safety tables: the axes that stop, and the loss of the motion permission."""

from collections.abc import Callable
from typing import Any, Final, TypeAlias

import pytest
from pymavlink.dialects.v20 import common as mavlink

from firmware_bridge.drivers.driver import Power, Reports
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.safety.common import AXIS_INTERLOCKS, EXCLUDED_AXIS, whole_robot_interlocks
from firmware_bridge.safety.gate import axis_interlocks
from firmware_bridge.safety.interlock import Interlock
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.safety import gate_bench
from hil_tests.safety.gate_bench import Rars, Snapshot, gate_of, names, with_facts
from hil_tests.safety.stop_cases import DRIVE_LIMIT

Well: TypeAlias = Callable[..., Snapshot]

ALL: Final = None
FOLLOWS: Final = {
    "emergency stop": (ALL, "disarms", "blocks arming"),
    "bridge stalled": (ALL, "disarms", "blocks arming"),
    "link lost: drives": (ALL, "disarms", "blocks arming"),
    "second controller: drives": (ALL, "disarms", "blocks arming"),
    # Arming must not wait for what only arming changes, nor for who speaks of motion afterwards.
    "not armed": (ALL,),
    "operator link timeout": (ALL, "parts"),
    "command stale": (ALL, "blocks arming", "parts"),
    "command not timestamped": (ALL, "parts"),
    "operator link lost": (ALL, "disarms", "blocks arming"),
    "stick not neutral": (ALL,),
    "operation paused": (ALL,),
    "battery low": (ALL, "disarms", "blocks arming"),
    "command unusable": (ALL, "blocks arming"),
    "steer angle unknown": (ALL, "blocks arming"),
    "lift height unknown": (ALL, "blocks arming"),
    "tilt unknown": (ALL, "blocks arming"),
    "load implausible": (ALL, "disarms", "blocks arming"),
    # A lift comes down only when the robot is armed.
    "lift extended": ({"base"},),
    "lift moving": ({"base"},),
    "lift refused": ({"lift"},),
    "axis timeout": (ALL, "disarms", "blocks arming"),
    "axis fault": (ALL, "disarms", "blocks arming"),
    "axis reconfigured": (ALL, "disarms", "blocks arming", "takes power"),
    "axis not enabled": (ALL, "disarms", "blocks arming"),
    "tracking error": (ALL, "disarms", "blocks arming"),
    "uncommanded motion": (ALL, "disarms", "blocks arming", "takes power"),
    "position not changing": (ALL, "disarms", "blocks arming", "takes power"),
    "reference lost": (ALL, "disarms", "blocks arming"),
    "axis excluded": (ALL, "disarms", "blocks arming"),
    "delay limit": (set(),),
    "speed limit": (set(),),
    "tipping limit": (set(),),
    "steer angle limit": (set(),),
    "turn radius limit": (set(),),
    "lift rate limit": (set(),),
    "lift range limit": (set(),),
    "lift margin limit": (set(),),
    "margin limit": (set(),),
    "acceleration limit": (set(),),
}


def follows(row: InterlockBase) -> tuple[object, ...]:
    """Return what stops, and the words for all else that follows."""
    words = {
        "disarms": row.disarms,
        "blocks arming": row.blocks_arming,
        "latches": row.latches,
        "takes power": row.disables_power,
        "parts": row.parts,
    }
    return row.stops, *(word for word, events in words.items() if events)


def whole_robot(robot: Rars) -> tuple[Interlock[RarsGeometry, RarsMotion, RarsState], ...]:
    """Return the rows that judge no axis."""
    return whole_robot_interlocks(ROBOT_TYPE.rules(robot)[""].numbers, robot.links)


def on_a_link_that_stops(robot: Rars, *groups: str) -> Rars:
    """Return a robot whose link stops no more than these groups."""
    links = {name: link.model_copy(update={"stops": groups}) for name, link in robot.links.items()}
    return robot.model_copy(update={"links": links})


def test_every_row_states_what_follows_from_it(robot: Rars) -> None:
    rules = ROBOT_TYPE.rules(robot)[""]
    common = whole_robot(robot)
    rows = (*common, *rules.interlocks, *rules.after_limits, *AXIS_INTERLOCKS, EXCLUDED_AXIS, *rules.limits)
    assert {row.name: follows(row) for row in rows} == FOLLOWS


def test_a_row_that_states_no_more_stops_everything_until_it_is_clear() -> None:
    for row in (InterlockBase("any", ""), Interlock("any", lambda _: None, "")):
        assert follows(row) == (ALL, "blocks arming")
        assert (row.clear_after, row.severity) == (0, Severity.WARNING)


def test_the_severities_are_those_of_mavlink() -> None:
    theirs = {
        one.name.removeprefix("MAV_SEVERITY_"): value for value, one in mavlink.enums["MAV_SEVERITY"].items()
    }
    theirs.pop("ENUM_END")
    assert {one.name: one.value for one in Severity} == theirs


def test_a_link_that_stops_only_some_groups_leaves_the_others_armed(robot: Rars) -> None:
    confined = on_a_link_that_stops(robot, "lift")
    (lost,) = (row for row in whole_robot(confined) if row.name.startswith("link lost"))
    reports = {axis.name: frozenset(Reports) for axis in robot.axes}
    rows = [row for one in axis_interlocks(confined, reports) for _, row in one.interlocks]
    assert {row.name for row in rows} == {row.name for row in AXIS_INTERLOCKS}
    for row in (lost, *rows):
        taken = ("takes power",) if row.disables_power else ()
        assert follows(row) == ({"lift"}, "blocks arming", *taken)


@pytest.mark.parametrize(
    ("changes", "event"),
    [
        ({"link_lost": "it is gone"}, "link lost: drives"),
        ({"drives": {"left": {"fault": "0x8611"}}}, "axis fault: left"),
    ],
)
def test_on_such_a_link_the_rest_of_the_robot_goes_on(
    robot: Rars, changes: dict[str, Any], event: str
) -> None:
    confined = on_a_link_that_stops(robot, "lift")
    command = {"speed_mps": 0.05}
    decision = gate_of(confined).rule(gate_bench.well(confined, SECOND, intent=command, **changes))
    assert names(decision) == (event,)
    assert (set(decision.stopped), decision.allowed.speed_mps) == ({"lift"}, 0.05)


@pytest.mark.parametrize(
    ("power", "silence", "events"),
    [
        (Power.ON, 0, True),
        (Power.ON, DRIVE_LIMIT - 1, True),
        (Power.ON, DRIVE_LIMIT, False),
        (Power.ON, DRIVE_LIMIT + MILLISECOND, False),
        (Power.STOPPED, 0, False),
        (Power.OFF, 0, False),
        (Power.FAULT, 0, False),
    ],
)
def test_an_axis_that_is_left_out_may_have_no_power_while_it_is_received(
    robot: Rars, well: Well, power: Power, silence: Nanoseconds, *, events: bool
) -> None:
    seen = well(SECOND, drives={"lift": {"power": power, "received_at": SECOND - silence}})
    decision = gate_of(robot).rule(with_facts(seen, without=frozenset({"lift"})))
    assert [(event.name, event.reason) for event in decision.interlock_events] == (
        [("axis excluded: lift", "node 4 (scissor lift) has power, but this mode excludes it")]
        if events
        else []
    )


@pytest.mark.parametrize(
    ("changes", "rests"),
    [
        ({}, True),
        ({"demanded_speed_mps": 1e-9}, False),
        ({"speed_mps": 0.0101}, False),
        ({"demanded_speed_mps": -0.05, "speed_mps": -0.05}, False),
        ({"drives": {"lift": {"velocity": 1.0}}}, True),
    ],
)
def test_at_rest_it_neither_leaves_its_place_nor_is_reported_to(
    robot: Rars, well: Well, changes: dict[str, Any], *, rests: bool
) -> None:
    assert ROBOT_TYPE.rules(robot)[""].at_standstill(well(SECOND, **changes)) is rests
