"""Every stop interlock at both edges of its threshold and its clear time, with and without looks between."""

from collections.abc import Callable
from typing import Any, TypeAlias

from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.safety.common import AXIS_INTERLOCKS, whole_robot_interlocks
from firmware_bridge.safety.snapshot import ActiveInterlock
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.rows import every
from hil_tests.safety.gate_bench import (
    Rars,
    Snapshot,
    above,
    base_stopped,
    gate_of,
    lift_free,
    limited,
    names,
    shifted,
    with_facts,
)
from hil_tests.safety.stop_cases import CASES, LINK, START, Case, drive

Well: TypeAlias = Callable[..., Snapshot]

each = every("case", CASES, ids=lambda case: f"{case.event}: {case.reason}")
with_or_without_a_look = every("between", [(), (1,), (1, 2, 3)])


def tripped(well: Well, case: Case, now: Nanoseconds = START, **changes: Any) -> Snapshot:
    """Make the case's snapshot at another instant; silences move along."""
    return shifted(well(START, **(case.trips | changes)), now - START)


def test_every_interlock_in_the_tables_has_a_case(robot: Rars) -> None:
    rules = ROBOT_TYPE.rules(robot)[""]
    rows = (*whole_robot_interlocks(rules.numbers, robot.links), *rules.interlocks, *AXIS_INTERLOCKS)
    names_of_rows = {row.name for row in rows}
    judged = {case.event if case.event in names_of_rows else case.event.split(":")[0] for case in CASES}
    # The governor's need an IMU; the robot's own boundary cases have one.
    assert judged | {"tilt unknown", "load implausible"} == names_of_rows
    assert len(names_of_rows) == len(rows)


def test_a_robot_that_is_well_holds_nothing_from_the_first_look_on(robot: Rars, well: Well) -> None:
    gate = gate_of(robot)
    for now in (0, 1, START):
        decision = gate.rule(well(now))
        assert decision.interlock_events == ()
        assert not base_stopped(decision)
        assert lift_free(decision)


@each
@with_or_without_a_look
def test_just_below_its_threshold_it_lets_the_robot_drive(
    robot: Rars, well: Well, case: Case, between: tuple[int, ...]
) -> None:
    gate = gate_of(robot)
    for n in between:
        gate.rule(well(START - 10 + n))
    decision = gate.rule(well(START, **case.spares))
    assert names(decision) == ()
    assert not base_stopped(decision)


@each
@with_or_without_a_look
def test_at_its_threshold_it_stops_the_robot_and_states_why(
    robot: Rars, well: Well, case: Case, between: tuple[int, ...]
) -> None:
    gate = gate_of(robot)
    for n in between:
        gate.rule(well(START - 10 + n))
    command = {"speed_mps": 0.3, "steer_rad": 0.1, "lift_rate_mps": 0.0} | case.trips.get("intent", {})
    decision = gate.rule(tripped(well, case, intent=command, demanded_speed_mps=0.3))
    # A command that is no number moves the lift as well, and the robot drives.
    assert set(names(decision)) - {"lift refused"} == {case.event, *case.also}
    event = next(event for event in decision.interlock_events if event.name == case.event)
    assert event == ActiveInterlock(case.event, case.reason, event.interlock, START)
    assert event.remedy
    assert base_stopped(decision)
    assert decision.allowed.speed_mps == 0.0
    assert lift_free(decision) is case.lift_is_free


@each
def test_it_holds_on_from_when_it_began(robot: Rars, well: Well, case: Case) -> None:
    gate = gate_of(robot)
    first = gate.rule(tripped(well, case)).interlock_events
    for n in range(1, 4):
        assert gate.rule(tripped(well, case, START + n * SECOND)).interlock_events == first


@each
@with_or_without_a_look
def test_it_lets_go_when_it_was_clear_for_its_clear_time(
    robot: Rars, well: Well, case: Case, between: tuple[int, ...]
) -> None:
    gate = gate_of(robot)
    gate.rule(tripped(well, case))
    clear_at = START + SECOND
    ends_at = clear_at + case.clear_after
    for now in (clear_at, *(clear_at + n for n in between), ends_at - 1):
        if clear_at <= now < ends_at:
            assert case.event in names(gate.rule(well(now)))
    assert case.event not in names(gate.rule(well(ends_at)))


@each
def test_the_first_clear_look_starts_the_clear_time_however_late_it_comes(
    robot: Rars, well: Well, case: Case
) -> None:
    gate = gate_of(robot)
    gate.rule(tripped(well, case))
    late = START + 60 * SECOND
    assert (case.event in names(gate.rule(well(late)))) == (case.clear_after > 0)
    assert case.event not in names(gate.rule(well(late + case.clear_after)))


@each
def test_a_trip_in_between_starts_the_clear_time_again(robot: Rars, well: Well, case: Case) -> None:
    gate = gate_of(robot)
    began = gate.rule(tripped(well, case)).interlock_events
    gate.rule(well(START + SECOND))
    again = START + SECOND + case.clear_after // 2
    now_holds = {event.name: event for event in gate.rule(tripped(well, case, again)).interlock_events}
    before = {event.name: event for event in began}[case.event]
    assert now_holds[case.event] == (before if case.clear_after else _at(before, again))
    clear_at = again + 1
    if case.clear_after:
        assert case.event in names(gate.rule(well(clear_at)))
        assert case.event in names(gate.rule(well(clear_at + case.clear_after - 1)))
    assert case.event not in names(gate.rule(well(clear_at + case.clear_after)))


@each
def test_it_trips_again_at_once_after_it_has_let_go(robot: Rars, well: Well, case: Case) -> None:
    gate = gate_of(robot)
    for round_trip in range(3):
        start = START + round_trip * 10 * SECOND
        decision = gate.rule(tripped(well, case, start))
        assert case.event in names(decision)
        assert {event.since for event in decision.interlock_events if event.name == case.event} == {start}
        gate.rule(well(start + SECOND))
        assert case.event not in names(gate.rule(well(start + SECOND + case.clear_after)))


def _at(event: ActiveInterlock, now: Nanoseconds) -> ActiveInterlock:
    return ActiveInterlock(event.name, event.reason, event.interlock, now)


def test_a_low_battery_holds_at_once_while_disarmed_and_after_10_seconds_while_armed(
    robot: Rars, well: Well
) -> None:
    low = well(START, battery_low_since=START - MILLISECOND)
    assert names(gate_of(robot).rule(low)) == ()
    assert names(gate_of(robot).rule(with_facts(low, armed=False))) == ("battery low", "not armed")
    without = robot.model_copy(update={"battery": None})
    assert names(gate_of(without).rule(with_facts(low, battery_low_since=0))) == ()


def test_an_extended_lift_counts_as_retracted_only_well_below_the_threshold(robot: Rars, well: Well) -> None:
    gate = gate_of(robot)
    assert gate.rule(well(START, lift_m=0.5)).interlock_events[0].reason == (
        "the lift stands at 500 mm, retracted is below 5 mm"
    )
    assert gate_of(limited(robot, lift_retracted_m=0.25)).rule(well(START, lift_m=0.5)).interlock_events[
        0
    ].reason == ("the lift stands at 500 mm, retracted is below 250 mm")
    assert names(gate.rule(well(START + 1, lift_m=0.005))) == ("lift extended",)
    assert names(gate.rule(well(START + 2, lift_m=above(0.8 * 0.005)))) == ("lift extended",)
    assert names(gate.rule(well(START + 3, lift_m=0.8 * 0.005))) == ()
    assert names(gate.rule(well(START + 4, lift_m=0.005))) == ()


def test_a_lift_comes_to_rest_only_well_below_its_threshold(robot: Rars, well: Well) -> None:
    gate = gate_of(robot)
    gate.rule(well(START, **drive("lift", velocity=1.0)))
    resting = above(0.05)
    assert names(gate.rule(well(START + SECOND, **drive("lift", velocity=resting)))) == ("lift moving",)
    assert names(gate.rule(well(START + 2 * SECOND, **drive("lift", velocity=-0.05)))) == ("lift moving",)
    decision = gate.rule(well(START + 2 * SECOND + LINK, **drive("lift", velocity=0.05)))
    assert names(decision) == ()


def test_a_drive_that_is_missing_from_the_snapshot_was_never_received(robot: Rars, well: Well) -> None:
    snapshot = well(START)
    others = {name: one for name, one in snapshot.facts.axes.items() if name != "left"}
    decision = gate_of(robot).rule(with_facts(snapshot, axes=others))
    assert [event.reason for event in decision.interlock_events] == [
        "node 1 (left rear wheel) has not reported yet"
    ]


def test_holds_come_in_the_order_of_the_tables(robot: Rars, well: Well) -> None:
    decision = gate_of(robot).rule(
        well(
            START,
            armed=False,
            emergency_stopped=True,
            lift_m=0.5,
            drives={"right": {"fault": "0x2310", "received_at": NEVER_RECEIVED}, "left": {"fault": "0x2310"}},
        )
    )
    assert names(decision) == (
        "emergency stop",
        "not armed",
        "lift extended",
        "axis fault: left",
        "axis timeout: right",
        "axis fault: right",
    )
