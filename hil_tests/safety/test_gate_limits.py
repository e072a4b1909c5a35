"""Limits at both edges, the duration of their reports, and the limits kept while stopped."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final, TypeAlias

import pytest

from firmware_bridge.intent import AgeLimit
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robots.rars import ROBOT_TYPE, rules
from firmware_bridge.robots.rars.kinematics import ramp_of
from firmware_bridge.robots.rars.rules import LIMITS, tipping_speed
from firmware_bridge.safety.limits import bounded
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.safety.gate_bench import Rars, Snapshot, base_stopped, gate_of, lift_free, limited, names

Well: TypeAlias = Callable[..., Snapshot]
START: Final = 100 * SECOND
SHOWN_FOR: Final = 300 * MILLISECOND
FULL_STEER: Final = math.radians(60.0)
TIGHTEST: Final = math.atan(0.515 / (0.415 - 0.105))
"""58.95 degrees: R = a/2 + w cot(theta) = 415 mm (thesis 2.13, Tab. 2.1)."""
TOP: Final = 6 * 0.3 * (math.sin(math.radians(45)) - math.sin(math.radians(5)))
STEP: Final = 0.80 * 0.144 * 9.81 * 0.050
"""The largest change of speed in one cycle, straight on."""


def requested(well: Well, now: Nanoseconds = START, **command: Any) -> Snapshot:
    """Make a command that the ramp has reached already, so that acceleration is no matter."""
    return well(now, intent=command, demanded_speed_mps=command.get("speed_mps", 0.0))


def reckless(robot: Rars) -> Rars:
    """Return a robot whose other limits never bind."""
    return limited(robot, speed_mps=9.0, acceleration_g=90.0, turn_radius_m=0.2, steer_angle_deg=85.0)


def test_a_number_is_reported_in_the_unit_of_its_bound_unless_another_is_named() -> None:
    assert bounded(-200.0, 100.0, "m/s") == (-100.0, "requested -200.00 m/s, allowed is -100.00 m/s")


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("command", "allowed", "held"),
    [
        (0.0, 0.0, False),
        (0.49, 0.49, False),
        (0.5, 0.5, False),
        (0.5 * (1 + 0.999e-6), 0.5, False),
        (0.5 * (1 + 1.001e-6), 0.5, True),
        (0.6, 0.5, True),
        (60.0, 0.5, True),
    ],
)
def test_speed_is_clipped_to_half_a_meter_a_second(
    robot: Rars, well: Well, sign: int, command: float, allowed: float, *, held: bool
) -> None:
    snapshot = well(START, intent={"speed_mps": sign * command}, demanded_speed_mps=sign * allowed)
    decision = gate_of(robot).rule(snapshot)
    assert decision.allowed.speed_mps == sign * allowed
    assert names(decision) == (("speed limit",) if held else ())
    assert not base_stopped(decision)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("command", "allowed", "held"),
    [
        (0.0, 0.0, ()),
        (math.radians(58.9), math.radians(58.9), ()),
        (TIGHTEST * (1 - 1e-9), TIGHTEST * (1 - 1e-9), ()),
        (TIGHTEST * (1 + 0.9e-6), TIGHTEST, ()),
        (TIGHTEST * (1 + 1.1e-6), TIGHTEST, ("turn radius limit",)),
        (FULL_STEER, TIGHTEST, ("turn radius limit",)),
        (FULL_STEER * (1 + 1.1e-6), TIGHTEST, ("steer angle limit", "turn radius limit")),
        (math.radians(170), TIGHTEST, ("steer angle limit", "turn radius limit")),
    ],
)
def test_steering_is_clipped_to_60_degrees_and_415_millimeters(
    robot: Rars, well: Well, sign: int, command: float, *, allowed: float, held: tuple[str, ...]
) -> None:
    decision = gate_of(robot).rule(requested(well, steer_rad=sign * command))
    assert decision.allowed.steer_rad == pytest.approx(sign * allowed, rel=1e-12)
    assert names(decision) == held


def test_60_degrees_bind_where_the_robot_could_turn_more_tightly(robot: Rars, well: Well) -> None:
    nimble = limited(robot, turn_radius_m=0.3)
    decision = gate_of(nimble).rule(requested(well, steer_rad=math.radians(61)))
    assert decision.allowed.steer_rad == FULL_STEER
    assert names(decision) == ("steer angle limit",)


def test_the_printed_tipping_speed() -> None:
    # Thesis 2.3.1: R = 415 mm, d = 168 mm, Zcg = 190 mm: 1.9 m/s.
    assert math.sqrt(0.415 * 9.81 * 0.168 / 0.190) == pytest.approx(1.897, abs=1e-3)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("way", [1, -1])
def test_the_tipping_limit_is_that_of_the_turn_actually_steered(
    robot: Rars, well: Well, side: int, way: int
) -> None:
    machine = reckless(robot)
    top = tipping_speed(machine, TIGHTEST)
    assert top == pytest.approx(1.897, abs=1e-3)
    assert robot.geometry.tightest_steer_rad == pytest.approx(TIGHTEST)
    for command, steered, allowed, held in (
        (top * 1.1, side * TIGHTEST, top, ("tipping limit",)),
        (top, side * TIGHTEST, top, ()),
        (top * 1.1, 0.0, top * 1.1, ()),
    ):
        snapshot = well(
            START,
            intent={"speed_mps": way * command, "steer_rad": -side * TIGHTEST},
            steer_rad=steered,
            demanded_speed_mps=way * allowed,
        )
        decision = gate_of(machine).rule(snapshot)
        assert decision.allowed.speed_mps == pytest.approx(way * allowed)
        assert names(decision) == held


@pytest.mark.parametrize(
    ("field", "command", "allowed", "held"),
    [
        ("lift_rate_mps", 0.1, 0.1, ()),
        ("lift_rate_mps", -0.1, -0.1, ()),
        ("lift_rate_mps", 0.11, 0.1, ("lift rate limit",)),
        ("lift_rate_mps", -0.11, -0.1, ("lift rate limit",)),
        ("lift_m", TOP, TOP, ()),
        ("lift_m", TOP + 0.01, TOP, ("lift range limit",)),
        ("lift_m", 0.0, 0.0, ()),
        ("lift_m", -0.01, 0.0, ("lift range limit",)),
    ],
)
def test_the_lift_is_kept_within_its_rate_and_range(
    robot: Rars, well: Well, field: str, command: float, *, allowed: float, held: tuple[str, ...]
) -> None:
    decision = gate_of(robot).rule(well(START, intent={field: command}))
    assert getattr(decision.allowed, field) == pytest.approx(allowed)
    assert names(decision) == held
    assert lift_free(decision)


@pytest.mark.parametrize(
    ("commanded", "command", "held"),
    [
        (0.0, STEP, False),
        (0.0, STEP + 0.995e-4, False),
        (0.0, STEP + 1.005e-4, True),
        (0.0, -STEP, False),
        (0.0, -STEP - 1.1e-4, True),
        (0.4, 0.4 - STEP, False),
        (0.4, 0.4 - STEP - 1.1e-4, True),
        (0.3, 0.3, False),
    ],
)
def test_a_command_that_the_ramp_delays_is_reported(
    robot: Rars, well: Well, commanded: float, command: float, *, held: bool
) -> None:
    decision = gate_of(robot).rule(well(START, intent={"speed_mps": command}, demanded_speed_mps=commanded))
    assert decision.allowed.speed_mps == command
    assert names(decision) == (("acceleration limit",) if held else ())


def test_what_the_ramp_reaches_in_one_cycle_is_not_reported_even_without_a_tolerance(
    robot: Rars, well: Well, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rules, "SPEED_TOLERANCE_MPS", 0.0)
    reached = ramp_of(robot).step(0.0, 0.5, 0.0, robot.cycle)
    for speed, held in ((reached, ()), (math.nextafter(reached, 1.0), ("acceleration limit",))):
        assert names(gate_of(robot).rule(well(START, intent={"speed_mps": speed}))) == held


def test_in_a_turn_the_ramp_delays_more(robot: Rars, well: Well) -> None:
    snapshot = well(START, intent={"speed_mps": STEP}, steer_rad=TIGHTEST)
    assert names(gate_of(robot).rule(snapshot)) == ("acceleration limit",)


def test_a_command_that_leaves_the_steering_where_it_is_has_nothing_to_clip(robot: Rars, well: Well) -> None:
    decision = gate_of(robot).rule(well(START, intent={"steer_rad": None}))
    assert (names(decision), decision.allowed.steer_rad) == ((), None)


def test_reasons_give_the_numbers(robot: Rars, well: Well) -> None:
    gate = gate_of(robot)
    snapshot = well(
        START, intent={"speed_mps": 0.8, "steer_rad": math.radians(65), "lift_m": 2.0, "lift_rate_mps": 0.5}
    )
    reasons = {event.name: event.reason for event in gate.rule(snapshot).interlock_events}
    assert reasons == {
        "speed limit": "requested 0.80 m/s, allowed is 0.50 m/s",
        "steer angle limit": "requested 65.00 deg, allowed is 60.00 deg",
        "turn radius limit": "requested 60.00 deg, allowed is 58.95 deg",
        "lift rate limit": "requested 0.50 m/s, allowed is 0.10 m/s",
        "lift range limit": "requested 2.00 m, allowed is 1.12 m",
        "acceleration limit": "requested a step from 0.00 to 0.50 m/s at once, limit 1.41 m/s2",
        "lift refused": "the robot is requested to drive with 0.50 m/s",
    }
    assert all(event.remedy and event.since == START for event in gate.rule(snapshot).interlock_events)


TRIPS: Final = {
    "speed limit": {"speed_mps": 0.6},
    "steer angle limit": {"steer_rad": 1.1},
    "turn radius limit": {"steer_rad": 1.04},
    "lift rate limit": {"lift_rate_mps": 0.2},
    "lift range limit": {"lift_m": -0.1},
    "acceleration limit": {"speed_mps": 0.4},
}


GOVERNED: Final = ("lift margin limit", "margin limit")


def test_every_limit_has_a_case() -> None:
    # The governor's need an IMU; the robot's own boundary cases have one.
    assert set(TRIPS) | {"tipping limit", *GOVERNED} == {row.name for row in LIMITS}


@pytest.mark.parametrize("name", TRIPS)
@pytest.mark.parametrize("between", [(), (1, 2)])
def test_a_limit_is_shown_until_it_has_not_clipped_for_300_milliseconds(
    robot: Rars, well: Well, name: str, between: tuple[int, ...]
) -> None:
    gate = gate_of(robot)
    first = [
        event for event in gate.rule(well(START, intent=TRIPS[name])).interlock_events if event.name == name
    ]
    assert first
    clear = START + SECOND
    for now in (clear, *(clear + n for n in between), clear + SHOWN_FOR - 1):
        assert [event for event in gate.rule(well(now)).interlock_events if event.name == name] == first
    assert name not in names(gate.rule(well(clear + SHOWN_FOR)))


@pytest.mark.parametrize("name", TRIPS)
def test_while_stopped_no_limit_is_reported_and_one_that_was_reported_runs_out(
    robot: Rars, well: Well, name: str
) -> None:
    assert name not in names(gate_of(robot).rule(well(START, intent=TRIPS[name], armed=False)))
    gate = gate_of(robot)
    assert name in names(gate.rule(well(START, intent=TRIPS[name])))
    assert name in names(gate.rule(well(START + 1, intent=TRIPS[name], armed=False)))
    assert name not in names(gate.rule(well(START + 1 + SHOWN_FOR, intent=TRIPS[name], armed=False)))


def test_while_stopped_the_steering_stays_where_it_is(robot: Rars, well: Well) -> None:
    gate = gate_of(robot)
    gate.rule(well(START, intent={"steer_rad": 0.3}))
    decision = gate.rule(well(START + 1, intent={"steer_rad": -0.3, "speed_mps": 0.2}, armed=False))
    assert base_stopped(decision)
    assert (decision.allowed.steer_rad, decision.allowed.speed_mps) == (None, 0.0)
    assert gate.rule(well(START + 2, intent={"steer_rad": -0.3})).allowed.steer_rad == -0.3


@pytest.mark.parametrize(
    ("most_ms", "command", "allowed", "held"),
    [
        (250, 0.5, 0.5, ()),
        (500, 0.5, 0.5, ()),
        (501, 0.5, 0.5 * 500 / 501, ("delay limit",)),
        (1000, 0.25, 0.25, ()),
        (1000, 0.2501, 0.25, ("delay limit",)),
        (1000, -0.5, -0.25, ("delay limit",)),
        (2000, 0.5, 0.125, ("delay limit",)),
    ],
)
def test_older_words_are_obeyed_at_less_speed(
    robot: Rars, well: Well, most_ms: int, command: float, *, allowed: float, held: tuple[str, ...]
) -> None:
    limit = AgeLimit(most_ms * MILLISECOND)
    snapshot = well(START, intent={"speed_mps": command}, demanded_speed_mps=allowed, age_limit=limit)
    decision = gate_of(robot).rule(snapshot)
    assert decision.allowed.speed_mps == pytest.approx(allowed, rel=1e-9)
    assert names(decision) == held


def test_the_delay_limit_names_both_ages_and_is_shown_for_300_milliseconds(robot: Rars, well: Well) -> None:
    gate = gate_of(robot)
    limit = AgeLimit(1000 * MILLISECOND)
    snapshot = well(START, intent={"speed_mps": 0.5}, demanded_speed_mps=0.5, age_limit=limit)
    (event, *_) = gate.rule(snapshot).interlock_events
    assert (event.name, event.reason) == (
        "delay limit",
        "requested 0.50 m/s, allowed is 0.25 m/s while commands may be 1000 ms instead of 500 ms old",
    )
    clear = START + SECOND
    for now, shown in ((clear, True), (clear + SHOWN_FOR - 1, True), (clear + SHOWN_FOR, False)):
        assert ("delay limit" in names(gate.rule(well(now, age_limit=limit)))) is shown


@pytest.mark.parametrize(("requested_s", "ms"), [(None, 500), (0.05, 50), (1.0, 1000), (2.0, 2000)])
def test_a_delay_is_agreed_on_up_to_the_files_ceiling(
    robot: Rars, requested_s: float | None, ms: int
) -> None:
    assert robot.agreed_on(requested_s).operator.age_limit_ms == ms


@pytest.mark.parametrize("requested_s", [0.049, 2.001, math.nan])
def test_what_is_beyond_it_is_refused(robot: Rars, requested_s: float) -> None:
    with pytest.raises(RobotFileError, match="50 to 2000 ms may be"):
        robot.agreed_on(requested_s)


def test_a_robot_that_cannot_be_slowed_agrees_on_nothing(robot: Rars) -> None:
    with pytest.raises(RobotFileError, match="cannot be slowed"):
        replace(ROBOT_TYPE, slowed=None).rules(robot.agreed_on(1.0))
