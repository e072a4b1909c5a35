"""Lift and wheels never together, in either order of the commands; and the gate's deadlines."""

import math
from collections.abc import Callable
from typing import Any, Final, TypeAlias

import pytest

from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.units import MILLISECOND, NEVER, SECOND
from hil_tests.safety.gate_bench import Rars, Snapshot, base_stopped, gate_of, lift_free, names, with_facts

Well: TypeAlias = Callable[..., Snapshot]
START: Final = 100 * SECOND


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"speed_mps": math.nextafter(0.010, 1)}, "the robot drives with 0.01 m/s"),
        ({"speed_mps": math.nextafter(-0.010, -1)}, "the robot drives with -0.01 m/s"),
        ({"speed_mps": math.nan}, "the robot drives with nan m/s"),
        ({"demanded_speed_mps": 1e-9}, "the robot is commanded to drive with 0.00 m/s"),
        ({"demanded_speed_mps": -0.05}, "the robot is commanded to drive with -0.05 m/s"),
    ],
)
@pytest.mark.parametrize("command", [{"lift_m": 0.3}, {"lift_rate_mps": 0.05}, {"lift_rate_mps": -0.05}])
def test_the_lift_does_not_move_while_the_robot_drives(
    robot: Rars, well: Well, changes: dict[str, Any], reason: str, command: dict[str, float]
) -> None:
    gate = gate_of(robot)
    decision = gate.rule(well(START, intent=command, **changes))
    assert [
        (event.name, event.reason) for event in decision.interlock_events if event.name == "lift refused"
    ] == [("lift refused", reason)]
    assert (lift_free(decision), decision.allowed.lift_m, decision.allowed.lift_rate_mps) == (
        False,
        None,
        0.0,
    )
    rests = START + SECOND
    assert names(gate.rule(well(rests, intent=command))) == ("lift refused",)
    assert not lift_free(gate.rule(well(rests + 200 * MILLISECOND - 1, intent=command)))
    decision = gate.rule(well(rests + 200 * MILLISECOND, intent=command))
    assert lift_free(decision)
    assert (decision.allowed.lift_m, decision.allowed.lift_rate_mps) == (
        command.get("lift_m"),
        command.get("lift_rate_mps", 0.0),
    )


@pytest.mark.parametrize("speed", [0.0, 0.010, -0.010])
def test_the_lift_moves_at_standstill(robot: Rars, well: Well, speed: float) -> None:
    decision = gate_of(robot).rule(well(START, intent={"lift_m": 0.3}, speed_mps=speed))
    assert (names(decision), lift_free(decision), decision.allowed.lift_m) == ((), True, 0.3)


def test_the_base_counts_as_standing_only_well_below_its_threshold(robot: Rars, well: Well) -> None:
    gate = gate_of(robot)
    command = {"lift_m": 0.3}
    gate.rule(well(START, intent=command, speed_mps=0.1))
    for now, speed, lifting in (
        (START + SECOND, math.nextafter(0.005, 1), False),
        (START + 2 * SECOND, -math.nextafter(0.005, 1), False),
        (START + 3 * SECOND, 0.005, False),
        (START + 3 * SECOND + 200 * MILLISECOND, -0.005, True),
    ):
        assert lift_free(gate.rule(well(now, intent=command, speed_mps=speed))) is lifting


def test_a_lift_that_is_not_commanded_is_not_refused(robot: Rars, well: Well) -> None:
    decision = gate_of(robot).rule(
        well(START, intent={"speed_mps": 0.01}, speed_mps=0.3, demanded_speed_mps=0.01)
    )
    assert (decision.interlock_events, lift_free(decision)) == ((), True)


@pytest.mark.parametrize(
    ("command", "height", "wanted"),
    [
        (0.0, 0.0, False),
        (0.0, 0.001, False),
        (0.0, math.nextafter(0.001, 1), True),
        (0.0, -0.001, False),
        (0.0, -0.0011, True),
        (0.3, 0.3, False),
        (0.3, 0.302, True),
        (0.3, 0.298, True),
        (0.3, None, True),
    ],
)
def test_a_lift_within_a_millimeter_has_arrived(
    robot: Rars, well: Well, command: float, height: float | None, *, wanted: bool
) -> None:
    decision = gate_of(robot).rule(well(START, intent={"lift_m": command}, lift_m=height, speed_mps=0.3))
    assert ("lift refused" in names(decision)) is wanted
    assert lift_free(decision) is not wanted


def test_who_requests_both_at_once_drives(robot: Rars, well: Well) -> None:
    decision = gate_of(robot).rule(well(START, intent={"speed_mps": 0.05, "lift_m": 0.3}))
    assert names(decision) == ("lift refused",)
    assert (decision.allowed.speed_mps, lift_free(decision)) == (0.05, False)


def test_a_lift_that_was_let_go_stops_the_base_before_it_is_seen_to_move(robot: Rars, well: Well) -> None:
    gate = gate_of(robot)
    assert lift_free(gate.rule(well(START, intent={"lift_m": 0.3})))
    decision = gate.rule(well(START + 1, intent={"lift_m": 0.3, "speed_mps": 0.05}))
    assert [(event.name, event.reason) for event in decision.interlock_events] == [
        ("lift moving", "the lift has been commanded to move")
    ]
    assert (decision.allowed.speed_mps, lift_free(decision)) == (0.0, True)
    # The command for the lift is given up: after its clear time the base is free.
    drive = {"speed_mps": 0.05}
    assert base_stopped(gate.rule(well(START + 2, intent=drive)))
    assert base_stopped(gate.rule(well(START + 3, intent=drive)))
    assert base_stopped(gate.rule(well(START + 3 + 200 * MILLISECOND - 1, intent=drive)))
    assert not base_stopped(gate.rule(well(START + 3 + 200 * MILLISECOND, intent=drive)))


def test_a_refused_lift_does_not_stop_the_base(robot: Rars, well: Well) -> None:
    gate = gate_of(robot)
    for n in range(3):
        snapshot = well(
            START + n * SECOND,
            intent={"speed_mps": 0.05, "lift_m": 0.3},
            speed_mps=0.05,
            demanded_speed_mps=0.05,
        )
        assert not base_stopped(gate.rule(snapshot))


def test_an_extended_lift_comes_down_while_the_base_is_held(robot: Rars, well: Well) -> None:
    decision = gate_of(robot).rule(well(START, intent={"lift_m": 0.0, "speed_mps": 0.3}, lift_m=0.4))
    assert (decision.allowed.speed_mps, lift_free(decision), decision.allowed.lift_m) == (0.0, True, 0.0)


@pytest.mark.parametrize(
    ("operator", "steer", "deadline"),
    [
        (START, START, START + 250 * MILLISECOND),
        (START - 400 * MILLISECOND, START, START + 100 * MILLISECOND),
        (START, START - 200 * MILLISECOND, START + 50 * MILLISECOND),
        (START - 500 * MILLISECOND, START, START + 250 * MILLISECOND),
        (START - 500 * MILLISECOND + 1, START, START + 1),
        (START, START - 250 * MILLISECOND, START + 250 * MILLISECOND),
        (START, START - 250 * MILLISECOND + 1, START + 1),
        (NEVER_RECEIVED, START, START + 250 * MILLISECOND),
        (START, NEVER_RECEIVED, START + 250 * MILLISECOND),
    ],
)
def test_the_next_deadline_is_the_first_silence_that_will_trip(
    robot: Rars, well: Well, operator: int, steer: int, deadline: int
) -> None:
    snapshot = well(START, intent={"received_at": operator}, drives={"steer": {"received_at": steer}})
    assert gate_of(robot).next_deadline(snapshot.facts) == deadline


def test_without_a_silence_to_come_there_is_no_deadline(robot: Rars, well: Well) -> None:
    never = {"received_at": NEVER_RECEIVED}
    snapshot = well(START, intent=never, drives=dict.fromkeys(("left", "right", "steer", "lift"), never))
    assert gate_of(robot).next_deadline(snapshot.facts) == NEVER


def test_at_the_deadline_a_silence_trips_and_not_before(robot: Rars, well: Well) -> None:
    received = well(START)
    for deadline in (gate_of(robot).next_deadline(received.facts),):
        early = gate_of(robot).rule(with_facts(received, now=deadline - 1))
        late = gate_of(robot).rule(with_facts(received, now=deadline))
        assert names(early) == ()
        assert {name.split(":")[0] for name in names(late)} == {"axis timeout"}
