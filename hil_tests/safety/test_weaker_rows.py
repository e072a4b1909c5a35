"""A driver's reports decide which rows judge its axis: the strong one, a weaker one, or none at all."""

from collections.abc import Callable
from dataclasses import replace
from typing import Final, TypeAlias

import pytest

from firmware_bridge import robot_types
from firmware_bridge.drivers.driver import Feedback, Power, Reports
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import AnyRobot, Axis, RobotFileError
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.safety import common, gate
from firmware_bridge.safety.gate import axis_interlocks
from firmware_bridge.safety.interlock import AxisInterlock
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.safety.gate_bench import Gate, Rars, Snapshot, names, with_facts
from hil_tests.scenarios.homed import homed

Well: TypeAlias = Callable[..., Snapshot]

EVERYTHING: Final = frozenset(Reports)
SILENT: Final = EVERYTHING - {Reports.POWER}
"""Reports of a device that has none for its power."""
STRONG, WEAK = "axis not enabled", "late answer"
KNOWN: Final = "reference lost"
ALWAYS: Final = ("axis timeout", "axis fault", "axis reconfigured")
WATCHED: Final = ("tracking error", "uncommanded motion", "position not changing")
UNMEASURED: Final = "no feedback"
LIMIT: Final = 250 * MILLISECOND
"""The silence that RARS's link allows."""
RARS: Final = robot_types.find("rars")
ZERO_LOST: Final = next(row for row in common.AXIS_INTERLOCKS if row.name == "reference lost")
RESTARTED: Final = " has restarted, or was not confirmed since the bridge began"
HOME_IT: Final = "; home it (drive --home, or MAV_CMD_USER_1 with NaN)"


def reports_of(robot: Rars, **others: frozenset[Reports]) -> dict[str, frozenset[Reports]]:
    return {axis.name: others.get(axis.name, EVERYTHING) for axis in robot.axes}


def silent(robot: Rars) -> Gate:
    """Return a gate whose lift has a driver that does not report its power."""
    return gate.Gate(robot, ROBOT_TYPE.rules(robot), reports_of(robot, lift=SILENT))


def received(seen: Snapshot, axis: str, at: Nanoseconds) -> Snapshot:
    """Return the same, one axis without a report of its power and last received at this instant."""
    axes = dict(seen.facts.axes)
    axes[axis] = Feedback(axis, Power.UNKNOWN, received_at=at, sampled_at=at)
    return with_facts(seen, axes=axes)


def test_a_row_that_needs_no_more_than_is_reported_stands_itself() -> None:
    for row in common.AXIS_INTERLOCKS:
        assert row.fitting(EVERYTHING) is row
        assert row.fitting(row.needs) is row


def test_the_first_weaker_row_for_which_it_is_enough_stands_in() -> None:
    def judge(*_: object) -> None:
        return None

    weakest = AxisInterlock("weakest", judge, "")
    weaker = AxisInterlock("weaker", judge, "", needs=frozenset({Reports.CURRENT}), replacement=weakest)
    strong = AxisInterlock(
        "strong", judge, "", needs=frozenset({Reports.CURRENT, Reports.POWER}), replacement=weaker
    )
    alone = AxisInterlock("alone", judge, "", needs=frozenset({Reports.POWER}))
    assert strong.fitting(EVERYTHING) is strong
    assert strong.fitting(frozenset({Reports.CURRENT})) is weaker
    assert strong.fitting(frozenset({Reports.POWER})) is weakest
    assert strong.fitting(frozenset()) is weakest
    assert alone.fitting(EVERYTHING - {Reports.POWER}) is None


def weaker(robot: AnyRobot, axis: Axis) -> list[str]:
    """Return the rows that stand in for others, by the reports of an axis's device."""
    return [fitting.name for name, _, fitting in robot_types.weaker_rows(robot) if name == axis.name]


def test_an_epos2_reports_enough_for_every_row(robot: Rars) -> None:
    for one in (robot, over_serial(robot)):
        assert weaker(one, one.axes[0]) == []


@pytest.mark.parametrize(("port", "unmeasured"), [(1, 0), (2, 0), (3, 3)])
def test_a_shield_has_no_word_for_power_and_reports_nothing_of_a_motor_that_it_does_not_count(
    port: int, unmeasured: int
) -> None:
    rome = over_protocol(robot_types.find("rome"), "arduinoio")
    found = weaker(rome, rome.axes[port - 1])
    assert found == [WEAK, "axis restarted", *unmeasured * [UNMEASURED]]


def test_a_driver_that_does_not_report_power_gets_the_weaker_row_by_name(robot: Rars) -> None:
    rows = {
        one.axis.name: [name for name, _ in one.interlocks]
        for one in axis_interlocks(robot, reports_of(robot, lift=SILENT))
    }
    assert rows["lift"] == [f"{row}: lift" for row in (*ALWAYS, WEAK, KNOWN, *WATCHED)]
    assert rows["left"] == [f"{row}: left" for row in (*ALWAYS, STRONG, KNOWN, *WATCHED)]


@pytest.mark.parametrize("missing", [Reports.POSITION, Reports.VELOCITY])
def test_one_weaker_row_stands_in_for_all_that_watch_how_an_axis_moves(robot: Rars, missing: Reports) -> None:
    reported = reports_of(robot, lift=EVERYTHING - {missing})
    rows = {
        one.axis.name: [row.name for _, row in one.interlocks] for one in axis_interlocks(robot, reported)
    }
    assert rows["lift"] == [*ALWAYS, STRONG, KNOWN, UNMEASURED]
    assert rows["left"] == [*ALWAYS, STRONG, KNOWN, *WATCHED]


@pytest.mark.parametrize(
    ("silence", "events"),
    [(0, False), (LIMIT // 2 - 1, False), (LIMIT // 2, True), (LIMIT - 1, True)],
)
def test_who_does_not_report_how_it_moves_answers_within_half_the_silence(
    robot: Rars, well: Well, silence: Nanoseconds, *, events: bool
) -> None:
    reported = reports_of(robot, lift=EVERYTHING - {Reports.POSITION})
    decision = gate.Gate(robot, ROBOT_TYPE.rules(robot), reported).rule(
        received(well(SECOND), "lift", SECOND - silence)
    )
    assert (f"{UNMEASURED}: lift" in names(decision)) is events
    never = gate.Gate(robot, ROBOT_TYPE.rules(robot), reported).rule(
        received(well(SECOND), "lift", NEVER_RECEIVED)
    )
    assert f"{UNMEASURED}: lift" not in names(never)


def test_it_is_reported_with_the_robot_file(robot: Rars, monkeypatch: pytest.MonkeyPatch) -> None:
    assert list(robot_types.weaker_rows(robot)) == []
    monkeypatch.setattr(robot_types, "reports_of", lambda _robot, _axis: SILENT)
    reported = [(axis, strong.name, weak.name) for axis, strong, weak in robot_types.weaker_rows(robot)]
    assert reported == [(axis.name, STRONG, WEAK) for axis in robot.axes]


def test_a_driver_that_reports_too_little_is_refused_with_link_and_row(
    robot: Rars, monkeypatch: pytest.MonkeyPatch
) -> None:
    needy = AxisInterlock("axis stalls", lambda *_: None, "", needs=frozenset({Reports.CURRENT}))
    monkeypatch.setattr(gate, "AXIS_INTERLOCKS", (*common.AXIS_INTERLOCKS, needy))
    with pytest.raises(RobotFileError) as refusal:
        axis_interlocks(robot, reports_of(robot, lift=EVERYTHING - {Reports.CURRENT}))
    (problem,) = refusal.value.problems
    assert problem.key == "links.drives.driver"
    assert "axis stalls" in problem.problem


@pytest.mark.parametrize(
    ("silence", "events"),
    [(0, False), (LIMIT // 2 - 1, False), (LIMIT // 2, True), (LIMIT - 1, True)],
)
def test_the_weaker_row_wants_an_answer_within_half_the_silence(
    robot: Rars, well: Well, silence: Nanoseconds, *, events: bool
) -> None:
    decision = silent(robot).rule(received(well(SECOND), "lift", SECOND - silence))
    assert (f"{WEAK}: lift" in names(decision)) is events
    assert "axis timeout: lift" not in names(decision)


def test_it_stops_and_disarms_as_the_strong_one(robot: Rars, well: Well) -> None:
    decision = silent(robot).rule(received(well(SECOND), "lift", SECOND - LIMIT // 2))
    (event,) = [event for event in decision.interlock_events if event.name == f"{WEAK}: lift"]
    assert (event.interlock.stops, event.interlock.disarms, event.interlock.blocks_arming) == (
        None,
        True,
        True,
    )
    assert "reports no power state, and answered 0.12 s ago" in event.reason


@pytest.mark.parametrize(("clear", "events"), [(199, True), (200, False)])
def test_it_lets_go_when_answers_have_been_fresh_for_200_ms(
    robot: Rars, well: Well, clear: int, *, events: bool
) -> None:
    judge = silent(robot)
    judge.rule(received(well(SECOND), "lift", SECOND - LIMIT // 2))
    judge.rule(received(well(SECOND + 1), "lift", SECOND + 1))
    now = SECOND + 1 + clear * MILLISECOND
    assert (f"{WEAK}: lift" in names(judge.rule(received(well(now), "lift", now)))) is events


def test_one_that_was_never_received_is_silent_and_not_late(robot: Rars, well: Well) -> None:
    held = names(silent(robot).rule(received(well(SECOND), "lift", NEVER_RECEIVED)))
    assert "axis timeout: lift" in held
    assert f"{WEAK}: lift" not in held


def test_the_word_for_power_is_not_requested_from_a_device_that_has_none(robot: Rars, well: Well) -> None:
    assert names(silent(robot).rule(received(well(SECOND), "lift", SECOND))) == ()


def test_a_device_without_a_word_for_its_zero_is_requested_about_when_it_restarts(
    robot: Rars, well: Well
) -> None:
    reported = reports_of(robot, lift=EVERYTHING - {Reports.ZERO}, left=EVERYTHING - {Reports.ZERO})
    for name, events in (
        ("lift", {"axis restarted: lift"}),
        ("left", set()),
        ("steer", {"reference lost: steer"}),
    ):
        axes = dict(well(SECOND).facts.axes)
        axes[name] = replace(axes[name], reference_lost=True)
        decision = gate.Gate(robot, ROBOT_TYPE.rules(robot), reported).rule(
            with_facts(well(SECOND), axes=axes)
        )
        assert set(names(decision)) == events


def test_one_that_was_never_received_is_silent_and_has_not_restarted(robot: Rars, well: Well) -> None:
    reported = reports_of(robot, lift=EVERYTHING - {Reports.ZERO})
    axes = {**well(SECOND).facts.axes, "lift": Feedback("lift", reference_lost=True)}
    decision = gate.Gate(robot, ROBOT_TYPE.rules(robot), reported).rule(with_facts(well(SECOND), axes=axes))
    assert set(names(decision)) == {"axis timeout: lift"}


@pytest.mark.parametrize(
    ("axis", "stood", "ending"),
    [
        (RARS.axes[3], {}, ""),
        (RARS.axes[3], {"lift": "0.10 m"}, " (last known: 0.10 m)"),
        (homed().axes[3], {}, HOME_IT),
        (homed().axes[3], {"lift": "0.10 m"}, f" (last known: 0.10 m){HOME_IT}"),
    ],
)
def test_a_lost_zero_is_reported_with_the_last_known_place_and_the_way_to_home(
    well: Well, axis: Axis, stood: dict[str, str], ending: str
) -> None:
    lost = Feedback("lift", Power.ON, received_at=SECOND, reference_lost=True)
    facts = with_facts(well(SECOND), stood=stood).facts
    for row, reason in (
        (ZERO_LOST, ": its reference is lost, position unknown"),
        (common.AXIS_RESTARTED, f"{RESTARTED}: position unknown"),
    ):
        assert row.judge(axis, lost, facts, LIMIT) == f"node 4 (scissor lift){reason}{ending}"
