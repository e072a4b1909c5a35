"""Rows in the gate: the groups that stop, what a row may look at, the axis of a hold, when a hold ends."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final, TypeAlias

import pytest

from firmware_bridge.drivers.driver import Feedback, Reports
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.robots.rars.motion import RarsMotion
from firmware_bridge.safety import gate
from firmware_bridge.safety.interlock import AxisInterlock, Interlock, Limit
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.safety import gate_bench
from hil_tests.safety.gate_bench import Gate, Rars, Ruling, Snapshot, gate_of, names, with_facts

Well: TypeAlias = Callable[..., Snapshot]
START: Final = 100 * SECOND
EVERYTHING: Final = frozenset(Reports)


def gate_with(robot: Rars, **rows: Any) -> Gate:
    """Return RARS's gate with these rows in place of the robot's own."""
    reports = {axis.name: EVERYTHING for axis in robot.axes}
    return gate.Gate(robot, replace(ROBOT_TYPE, **rows).rules(robot), reports)


@pytest.mark.parametrize(
    ("stops", "stopped"), [(None, {"base", "lift"}), (frozenset({"lift"}), {"lift"}), (frozenset(), set())]
)
@pytest.mark.parametrize("after_limits", [False, True])
def test_a_row_stops_the_groups_that_it_names_or_all(
    robot: Rars, well: Well, stops: frozenset[str] | None, stopped: set[str], *, after_limits: bool
) -> None:
    row: Any = Interlock("too hot", lambda _: "it is hot", "wait", stops=stops, after_limits=after_limits)
    decision = gate_with(robot, interlocks=(row,)).rule(
        well(START, intent={"speed_mps": 0.05, "lift_rate_mps": 0.05})
    )
    assert (names(decision), set(decision.stopped)) == (("too hot",), stopped)
    assert decision.allowed.speed_mps == (0.0 if "base" in stopped else 0.05)
    assert decision.allowed.lift_rate_mps == (0.0 if "lift" in stopped else 0.05)


def test_every_hold_adds_the_groups_that_it_stops(robot: Rars) -> None:
    """The lift stands extended, and an axis fails on a link that stops the lift."""
    links = {name: link.model_copy(update={"stops": ("lift",)}) for name, link in robot.links.items()}
    confined = robot.model_copy(update={"links": links})
    seen = gate_bench.well(confined, START, lift_m=0.5, drives={"left": {"fault": "0x8611"}})
    decision = gate_of(confined).rule(seen)
    assert names(decision) == ("lift extended", "axis fault: left")
    assert decision.stopped == {"base", "lift"}


def test_a_limit_sees_what_the_limits_before_it_have_left_and_the_ruling_before(
    robot: Rars, well: Well
) -> None:
    seen: list[tuple[RarsMotion, frozenset[str], Ruling | None]] = []

    def looks(view: Any) -> tuple[RarsMotion, None]:
        seen.append((view.allowed, view.requested, view.before))
        return view.allowed, None

    def halves(view: Any) -> tuple[RarsMotion, str]:
        return replace(view.allowed, speed_mps=view.allowed.speed_mps / 2.0), "too fast"

    first: Any = Limit("half", halves, "", clear_after=0)
    second: Any = Limit("look", looks, "", clear_after=0)
    judge = gate_with(robot, limits=(first, second, first, second))
    command = well(START, intent={"speed_mps": 0.4})
    decision = judge.rule(command)
    assert decision.allowed == replace(command.command, speed_mps=0.1)
    judge.rule(command)
    assert [motion.speed_mps for motion, _, _ in seen] == [0.2, 0.1, 0.2, 0.1]
    assert {requested for _, requested, _ in seen} == {frozenset()}
    assert [before for _, _, before in seen] == [None, None, decision, decision]


def test_an_axis_that_is_missing_is_judged_as_one_of_its_name_that_was_never_received(
    robot: Rars, well: Well, monkeypatch: pytest.MonkeyPatch
) -> None:
    judged: list[Feedback] = []
    row = AxisInterlock("any", lambda _axis, feedback, *_: judged.append(feedback), "")
    monkeypatch.setattr(gate, "AXIS_INTERLOCKS", (row,))
    gate_of(robot).rule(with_facts(well(START), axes={}))
    assert judged == [Feedback(axis.name) for axis in robot.axes]
    assert {one.received_at for one in judged} == {NEVER_RECEIVED}


@pytest.mark.parametrize("name", ["left", "right", "steer", "lift"])
def test_a_hold_of_an_axis_names_the_axis(robot: Rars, well: Well, name: str) -> None:
    decision = gate_of(robot).rule(well(START, armed=False, drives={name: {"fault": "0x8611"}}))
    assert [(event.name, event.axis) for event in decision.interlock_events] == [
        ("not armed", ""),
        (f"axis fault: {name}", name),
    ]


def test_an_axis_that_is_missing_has_no_deadline(robot: Rars, well: Well) -> None:
    """The silence of the axes is 250 ms, that of the operator 500 ms."""
    seen = well(START)
    others = {name: one for name, one in seen.facts.axes.items() if name != "left"}
    judge = gate_of(robot)
    assert judge.next_deadline(with_facts(seen, axes=others).facts) == START + 250 * MILLISECOND
    assert judge.next_deadline(with_facts(seen, axes={}).facts) == START + 500 * MILLISECOND


def test_each_trip_restarts_the_clear_time_of_200_milliseconds(robot: Rars, well: Well) -> None:
    """A link that is gone for one look in each 200 ms, and clear for a look in between."""
    judge, name = gate_of(robot), "link lost: drives"
    for number in range(5):
        trip = START + number * 200 * MILLISECOND
        assert names(judge.rule(well(trip, link_lost="it is gone"))) == (name,)
        clear = trip + 100 * MILLISECOND
        assert names(judge.rule(well(clear))) == (name,)
    assert names(judge.rule(well(clear + 200 * MILLISECOND - 1))) == (name,)
    assert names(judge.rule(well(clear + 200 * MILLISECOND))) == ()


def test_a_driver_that_reports_too_little_is_refused_with_the_robots_file(robot: Rars) -> None:
    needy = AxisInterlock("any", lambda *_: None, "", needs=EVERYTHING)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(gate, "AXIS_INTERLOCKS", (needy,))
        with pytest.raises(RobotFileError) as refusal:
            gate.axis_interlocks(robot, {axis.name: frozenset() for axis in robot.axes})
    assert refusal.value.file == "rars"
    assert (
        str(refusal.value) == "rars: links.drives.driver: the devices on this link report too little for: any"
    )


@pytest.mark.parametrize("flag", ["disarms", "latches", "parts"])
def test_a_hold_has_the_flags_of_its_row(robot: Rars, well: Well, flag: str) -> None:
    one: dict[str, Any] = {flag: True}
    row: Any = Interlock("any", lambda _: "it holds", "", **one)
    (event,) = gate_with(robot, interlocks=(row,)).rule(well(START)).interlock_events
    flags = {
        name: getattr(event.interlock, name) for name in ("disarms", "latches", "parts", "disables_power")
    }
    assert flags == {name: name == flag for name in flags}
