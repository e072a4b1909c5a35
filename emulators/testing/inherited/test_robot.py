"""Safety tests that every installed robot gets, from its file, its interlocks and its cases."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.cases import Situation
from emulators.rig import BRIDGE
from emulators.testing.inherited.fake_driver import (
    START,
    AnyCase,
    FakeDriver,
    active,
    axes_of,
    cases_of,
    full_motions,
    gate_of,
    seen,
    silence_of,
)
from emulators.testing.inherited.scripted import mission_of, scripted
from firmware_bridge.drivers.driver import Position, Power, Speed
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find, names, robot_type_of
from firmware_bridge.safety.common import AXIS_INTERLOCKS
from firmware_bridge.safety.interlock import Limit
from firmware_bridge.safety.interlock_base import InterlockBase
from firmware_bridge.safety.snapshot import Decision, Tracking
from firmware_bridge.teleop.station import Stick, Unusable, Velocity
from firmware_bridge.units import MILLISECOND, SECOND, from_seconds

ROUNDING: Final = 1.0 + 1e-9
CYCLES: Final = 200
ORDERLY_S: Final = 5.0
"""Limit by which a robot has stopped and powered down after the request to end."""
MOVES: Final = 0.05
"""Share of its top speed that each mission of a robot reaches at least."""
FULL: Final = 100
"""Hypothesis's own number of examples."""


def examples(count: int) -> int:
    """Return how many of a test's examples this run draws, as Hypothesis's profile has them."""
    # Rounded up: a short profile still draws one example.
    return -(-count * settings().max_examples // FULL)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Give each test the robot of `--robot`, or every installed one."""
    chosen = metafunc.config.getoption("--robot", None)
    generate(metafunc, names() if chosen is None else (chosen,))


def generate(
    metafunc: pytest.Metafunc,
    robots: Sequence[str],
    missions: Mapping[str, Sequence[str]] = MappingProxyType({}),
) -> None:
    """Parametrize each test with these robots, and its other arguments; some with these `missions` alone."""
    if "case" in metafunc.fixturenames:
        cases = [(name, case) for name in robots for case in cases_of(name)]
        ids = [f"{name}-{case.interlock}-{place}" for place, (name, case) in enumerate(cases)]
        metafunc.parametrize(("name", "case"), cases, ids=ids)
    elif "mission" in metafunc.fixturenames:
        driven = [
            (name, mission)
            for name in robots
            for mission in missions.get(name, tuple(bench_setup_of(find(name)).shipped()))
        ]
        metafunc.parametrize(("name", "mission"), driven)
    elif "name" in metafunc.fixturenames:
        metafunc.parametrize("name", robots)


def interlocks_of(robot: AnyRobot) -> tuple[InterlockBase, ...]:
    """Return the robot's own interlocks, the limits last."""
    robot_type = robot_type_of(robot)
    return (*robot_type.interlocks, *robot_type.limits)


def test_its_file_loads_and_it_is_what_it_is_installed_as(name: str) -> None:
    robot = find(name)
    assert robot_type_of(robot).name == robot.kind
    assert name.endswith(".toml") or robot.kind == name
    assert {axis.role for axis in robot.axes} == frozenset().union(*robot_type_of(robot).groups.values())
    assert bench_setup_of(robot).shipped()


def test_every_interlock_of_its_own_has_a_boundary_case_and_no_case_is_for_nothing(name: str) -> None:
    assert {case.interlock for case in cases_of(name)} == {
        interlock.name for interlock in interlocks_of(find(name))
    }


def test_at_its_threshold_an_interlock_is_active_and_states_why(name: str, case: AnyCase) -> None:
    robot = case.robot or find(name)
    interlock = next(interlock for interlock in interlocks_of(robot) if interlock.name == case.interlock)
    gate = gate_of(robot)
    decision = gate.rule(seen(robot, START, case.trips))
    assert active(decision)[case.interlock] == case.reason
    assert next(event for event in decision.interlock_events if event.name == case.interlock).remedy
    if isinstance(interlock, Limit):
        assert decision.stopped == frozenset()
    else:
        groups = frozenset(robot_type_of(robot).groups)
        stopped = groups if interlock.stops is None else interlock.stops
        assert stopped <= decision.stopped
        assert not decision.requested & stopped


def test_just_within_its_threshold_an_interlock_is_not_active(name: str, case: AnyCase) -> None:
    robot = case.robot or find(name)
    decision = gate_of(robot).rule(seen(robot, START, case.spares))
    assert case.interlock not in active(decision)
    assert decision.stopped == frozenset()


def test_an_interlock_clears_after_its_release_delay(name: str, case: AnyCase) -> None:
    robot = case.robot or find(name)
    interlock = next(interlock for interlock in interlocks_of(robot) if interlock.name == case.interlock)
    gate = gate_of(robot)
    gate.rule(seen(robot, START, case.trips))
    clear = START + SECOND
    # "Commanded motion" reaches one decision further: the first look clears the request before.
    gate.rule(seen(robot, clear - 1))
    if interlock.clear_after:
        assert case.interlock in active(gate.rule(seen(robot, clear - 1 + interlock.clear_after - 1)))
    assert case.interlock not in active(gate.rule(seen(robot, clear + interlock.clear_after)))


def common_trips(robot: AnyRobot) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the name of each common hold, and what trips it just beyond its threshold."""
    silent = robot.operator.silent_ms * MILLISECOND
    yield "emergency stop", {"emergency_stopped": True}
    yield "not armed", {"armed": False}
    yield "operator link timeout", {"received_at": START - silent}
    yield "operator link timeout", {"received_at": NEVER_RECEIVED}
    for link in robot.links:
        yield f"link lost: {link}", {"links_lost": {link: "it is gone"}}
        yield f"second controller: {link}", {"masters": {link: "someone else sends SYNC: 080#"}}
    well = axes_of(robot, START)
    for axis in robot.axes:
        limit = silence_of(robot, axis.link)
        for interlock, changes in (
            ("axis timeout", {"received_at": START - limit}),
            ("axis timeout", {"received_at": NEVER_RECEIVED, "power": Power.UNKNOWN}),
            ("axis fault", {"fault": "0x8611"}),
            ("axis fault", {"power": Power.FAULT}),
            ("axis reconfigured", {"rewritten": "601#2316100100000000"}),
            ("axis not enabled", {"power": Power.STOPPED}),
            ("axis not enabled", {"power": Power.OFF}),
            *((("reference lost", {"reference_lost": True}),) if axis.needs_confirmation else ()),
        ):
            changed = replace(well[axis.name], **changes)
            yield f"{interlock}: {axis.name}", {"axes": {**well, axis.name: changed}}
        stated = axis.plausibility.within_ms
        long = limit if stated is None else stated * MILLISECOND
        deviates = Tracking(sampled_at=START, obeyed_at=START - long)
        repeats = replace(deviates, obeyed_at=START, settled_at=START - long)
        for interlock, following in (
            ("tracking error", deviates),
            ("uncommanded motion", replace(deviates, uncommanded=True)),
            ("position not changing", repeats),
        ):
            yield f"{interlock}: {axis.name}", {"following": {axis.name: following}}


def test_the_common_interlocks_stop_all_of_it_whatever_it_is_requested(name: str) -> None:
    robot = find(name)
    robot_type = robot_type_of(robot)
    tripped = set()
    for event, facts in common_trips(robot):
        for command in full_motions(robot_type, robot):
            decision = gate_of(robot).rule(seen(robot, START, Situation(command=command), **facts))
            assert event in active(decision), event
            if not event.startswith(("link lost", "second controller")):
                assert decision.stopped == frozenset(robot_type.groups), event
            assert not decision.requested & decision.stopped, event
        tripped.add(event.split(":")[0])
    # Only an axis whose zero a person confirms can lose it.
    unsent = set() if any(axis.needs_confirmation for axis in robot.axes) else {"reference lost"}
    assert {interlock.name for interlock in AXIS_INTERLOCKS} - unsent <= tripped


def test_a_command_just_in_time_stops_nothing(name: str) -> None:
    robot = find(name)
    silent = robot.operator.silent_ms * MILLISECOND
    axes = {
        axis.name: replace(one, received_at=START - silence_of(robot, axis.link) + 1)
        for axis, one in zip(robot.axes, axes_of(robot, START).values(), strict=True)
    }
    assert active(gate_of(robot).rule(seen(robot, received_at=START - silent + 1, axes=axes))) == {}


def spoiled(motion: Any, value: float) -> Iterator[Any]:
    """Yield the motion with each of its numbers in turn replaced, those of its halves as well."""
    for field in fields(motion):
        inner = getattr(motion, field.name)
        if is_dataclass(inner):
            yield from (replace(motion, **{field.name: it}) for it in spoiled(inner, value))
        elif "tuple" not in str(field.type):
            yield replace(motion, **{field.name: value})


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_command_that_is_no_number_stops_all_of_it(name: str, value: float) -> None:
    robot = find(name)
    robot_type = robot_type_of(robot)
    named = set()
    for command in spoiled(robot_type.standstill, value):
        titles = [title for title, read in robot_type.numbers.items() if repr(read(command)) == repr(value)]
        if titles:
            decision = gate_of(robot).rule(seen(robot, START, Situation(command=command)))
            assert active(decision)["command unusable"] == f"the {titles[0]} requested is {value}"
            assert decision.stopped == frozenset(robot_type.groups)
            assert not decision.requested
            named.update(titles)
    assert named == set(robot_type.numbers), "every number of the motion is judged"


def test_it_is_at_standstill_when_each_axis_that_moves_it_is(name: str) -> None:
    robot = find(name)
    rules = robot_type_of(robot).rules(robot)[""]
    well = axes_of(robot, START)
    travelling = {role for group in rules.travelling for role in robot_type_of(robot).groups[group]}
    assert set(rules.kinematics.rolling) <= {axis.name for axis in robot.axes if axis.role in travelling}
    assert rules.at_standstill(seen(robot))
    for axis in robot.axes:
        for speed in (axis.standstill_below, -axis.standstill_below, math.nan, math.inf):
            moves = {**well, axis.name: replace(well[axis.name], velocity=speed)}
            at_standstill = rules.at_standstill(
                seen(robot, situation=Situation(body=resting(robot)), axes=moves)
            )
            assert at_standstill is (axis.name not in rules.kinematics.rolling), (axis.name, speed)
        for sign in (1.0, -1.0):
            below = sign * math.nextafter(axis.standstill_below, 0.0)
            creeps = {**well, axis.name: replace(well[axis.name], velocity=below)}
            assert rules.at_standstill(seen(robot, situation=Situation(body=resting(robot)), axes=creeps))


def test_wheels_that_turn_against_each_other_are_not_at_standstill(name: str) -> None:
    robot = find(name)
    rules = robot_type_of(robot).rules(robot)[""]
    first, *others = (axis for axis in robot.axes if axis.name in rules.kinematics.rolling)
    spins = axes_of(robot, START)
    # The sum of the speeds is 0: a mean over the wheels would take that for a standstill.
    share = first.top_speed / max(len(others), 1)
    for axis, speed in ((first, first.top_speed), *((other, -share) for other in others)):
        spins[axis.name] = replace(spins[axis.name], velocity=speed)
    known = seen(robot, axes=spins)
    assert rules.kinematics.moving(known.body) & rules.travelling
    assert not rules.at_standstill(known)


def resting(robot: AnyRobot) -> Any:
    """Return what is known of a body at standstill."""
    return robot_type_of(robot).kinematics(robot).sensed(axes_of(robot, START), {})


shares = st.none() | st.floats(-1.0, 1.0)
sticks = st.builds(Stick, forward=shares, left=shares, turn=shares, up=shares)
speeds = st.floats(-1e3, 1e3)
velocities = st.builds(
    Velocity, forward_mps=speeds, left_mps=st.just(0.0) | speeds, yaw_rate_rad_s=st.none() | speeds
)
words = st.lists(st.tuples(sticks | velocities, st.integers(1, 30), st.booleans()), min_size=1, max_size=6)


def within_bounds(paper: FakeDriver) -> None:
    """Check what the guard checks, from the numbers of the robot file alone."""
    for axis in paper.robot.axes:
        set_point = paper.set_points.get(axis.name)
        if isinstance(set_point, Position):
            assert axis.travel is not None
            low, high = axis.travel
            assert low - 1e-6 * abs(low) <= set_point.value <= high + 1e-6 * abs(high)
    requested = paper.speeds()
    for axis in paper.robot.axes:
        assert abs(requested.get(axis.name, 0.0)) <= axis.top_speed * ROUNDING
    for interlock in paper.robot.guard.sums:
        total = sum(factor * requested.get(axis, 0.0) for axis, factor in interlock.of.items())
        assert abs(total) <= interlock.bound * ROUNDING, interlock.name
    for pair in paper.robot.guard.exclusive:
        assert not (moves(paper, pair.one) and moves(paper, pair.other)), pair.name


def moves(paper: FakeDriver, axes: tuple[str, ...]) -> bool:
    """Return whether any of these axes is commanded to go elsewhere than where it is."""
    for name in axes:
        set_point = paper.set_points.get(name)
        if isinstance(set_point, Position):
            if abs(set_point.value - paper.before[name].position) > 1e-6:
                return True
        elif isinstance(set_point, Speed) and set_point.value != 0.0:
            return True
    return False


def states(paper: FakeDriver, word: Stick | Velocity, command: Any) -> Any:
    """Return the command after a word of the operator; one that the robot cannot mean changes nothing."""
    station = paper.robot_type.station
    if isinstance(word, Stick):
        return station.stick(word, command, paper.robot)
    meant = station.target(word, command, paper.robot)
    return command if isinstance(meant, Unusable) else meant


@settings(max_examples=examples(60), deadline=None)
@given(stated=words)
def test_whatever_is_stated_the_guards_bounds_hold(
    name: str, stated: list[tuple[Stick | Velocity, int, bool]]
) -> None:
    paper = FakeDriver(find(name))
    command = paper.robot_type.standstill
    for word, cycles, armed in stated:
        command = states(paper, word, command)
        for _ in range(cycles):
            paper.cycle(command, armed=armed)
            within_bounds(paper)


def test_nothing_moves_before_it_is_armed(name: str) -> None:
    robot = find(name)
    for command in full_motions(robot_type_of(robot), robot):
        paper = FakeDriver(robot)
        for _ in range(20):
            paper.cycle(command, armed=False)
            assert not moves(paper, tuple(paper.axes))


def settled(paper: FakeDriver, command: Any, **facts: Any) -> Decision[Any]:
    """Go on until a cycle repeats the set-points and speeds of the one before; return its decision."""
    for _ in range(CYCLES):
        before = paper.commanded, turning(paper)
        decision: Decision[Any] = paper.cycle(command, **facts)
        if (paper.commanded, turning(paper)) == before:
            return decision
    events = (
        "; ".join(f"{event.name}: {event.reason}" for event in decision.interlock_events)
        or "nothing holds it"
    )
    speeds = ", ".join(f"{name} {one.velocity:.3g}" for name, one in paper.axes.items())
    raise AssertionError(f"it never settles: {events}, with {speeds}")


def turning(paper: FakeDriver) -> list[float]:
    return [axis.velocity for axis in paper.axes.values()]


def test_a_stop_brings_every_axis_to_standstill(name: str) -> None:
    robot = find(name)
    for command in full_motions(robot_type_of(robot), robot):
        paper = FakeDriver(robot)
        settled(paper, command)
        decision = settled(paper, command, emergency_stopped=True)
        assert decision.stopped == frozenset(paper.robot_type.groups)
        assert not moves(paper, tuple(paper.axes))
        assert not paper.rules.kinematics.requested(
            paper.commanded, paper.robot_type.kinematics(robot).sensed(paper.axes, {})
        )


def test_its_missions_drive_without_a_refusal_and_it_ends_without_power(name: str, mission: str) -> None:
    robot = find(name)
    script, bench_setup = mission_of(robot, mission), bench_setup_of(robot)
    with scripted(robot, script, noise=script.noise) as rig:
        rig.run(from_seconds(script.duration_s))
        assert rig.guard.refused == 0, rig.guard.refusals
        speed = rig.samples.column("speed_mps")
        top = next(channel.full(robot) for channel in bench_setup.channels if channel.name == "speed")
        assert np.abs(speed).max() > MOVES * top
        assert np.abs(speed).max() <= 1.02 * top
        rig.world.stop(BRIDGE)
        rig.runs(ORDERLY_S)
        assert rig.bridge.finished
        assert not any(axis.powered for axis in rig.devices.axes)
