"""The adversary's criteria: figures of the plant, and their bounds."""

import math
from dataclasses import replace
from typing import Final

import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.columns import Sample
from emulators.bench.faults import Fault
from emulators.bench.mission import Mission
from firmware_bridge.families.motor_shield.driver.booting import Booting
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.units import STANDARD_GRAVITY, from_seconds
from hil_tests.adversary.own import MARGIN_M, OWN, zero_moment_point
from hil_tests.adversary.reached import Reached
from hil_tests.adversary.search import Life
from hil_tests.adversary.truth import Judge, Look, invariants
from hil_tests.scenarios.ride import ARMED, STANDS, fault, ride, step, story

RARS: Final[AnyRobot] = find("rars")
CENTRE_M: Final = 0.220 * 70.0 / 70.6
"""Center of platform and rear wheels, ahead of the rear axle: thesis, Tab. 3.1."""
HEIGHT_M: Final = 0.190


def on_slope(degrees: float) -> AnyRobot:
    floor = {"slope": math.radians(degrees), "floor_friction": 0.9}
    return RARS.model_copy(update={"plant": RARS.plant.model_copy(update={"parameters": floor})})


@pytest.mark.parametrize("degrees", [0.0, 10.0, -10.0])
def test_at_rest_the_zero_moment_point_is_below_the_center_of_mass(degrees: float) -> None:
    robot = on_slope(degrees)
    one = ride(seconds=5, robot=robot)
    one.runs_until(1.5)
    along, across = zero_moment_point(robot, one.rig)
    assert along == pytest.approx(CENTRE_M - HEIGHT_M * math.tan(math.radians(degrees)), abs=0.002)
    assert across == pytest.approx(0.0, abs=1e-4)
    one.rig.finish()


def test_in_a_turn_it_moves_outwards_and_braking_forwards() -> None:
    one = ride(ARMED, step(4.0, speed_mps=0.5, steer_deg=40), step(6.5, emergency_stop=True), seconds=20)
    one.runs_until(6.4)
    along, across = zero_moment_point(RARS, one.rig)
    felt = abs(one.now["speed_mps"] * one.now["yaw_rate_rad_s"])
    assert across == pytest.approx(HEIGHT_M * felt / STANDARD_GRAVITY, rel=1e-6)
    assert across > 0.005
    one.runs_until(6.75)
    braking, _ = zero_moment_point(RARS, one.rig)
    assert braking > along + 0.01
    tipping = next(own for own in OWN["rars"] if "tipping" in own.name)
    assert 0.0 < tipping.ratio(RARS, one.rig) < MARGIN_M / 0.1
    one.rig.finish()


def look(**how: object) -> Look:
    """The robot at rest, disarmed, without power, its bridge alive."""
    row = Sample(0, (), {})
    nothing: Look = Look(
        RARS,
        row,
        speeds=dict.fromkeys(("left", "right", "steer", "lift"), 0.0),
        places=dict.fromkeys(("steer", "lift"), 0.0),
        powered=frozenset(),
        unwatched=frozenset(),
        may_move=False,
        gone=False,
        ending=False,
        rolled_m=0.0,
        stopped=False,
        own=dict.fromkeys((own.name for own in OWN["rars"]), 0.0),
    )
    return replace(nothing, **how)  # type: ignore[arg-type] # as they come


@pytest.mark.parametrize(
    ("name", "how", "within_s"),
    [
        ("power without a bridge", {"gone": True, "powered": frozenset({"left"})}, 2.0),
        ("an emergency stop with power", {"stopped": True, "powered": frozenset({"lift"})}, 5.0),
        ("an end without an end", {"ending": True}, 15.0),
        ("let go, and rolls", {"rolled_m": 0.0201}, 0.0),
        ("power that no one watches", {"unwatched": frozenset({"left"})}, 1.0),
        (
            "power for what is left out",
            {"powered": frozenset({"left", "right"}), "left_out": frozenset({"left"})},
            2.0,
        ),
    ],
)
def test_a_rule_is_broken_when_it_was_for_its_time(
    name: str, how: dict[str, object], within_s: float
) -> None:
    judge = Judge(invariants(RARS))
    assert judge.look(0, look()) is None
    wrong = look(**how)
    if within_s:
        assert judge.look(0, wrong) is None
        assert judge.look(from_seconds(within_s) - 1, wrong) is None
    violation = judge.look(from_seconds(within_s), wrong)
    assert violation is not None
    assert violation.name == name


SPEED: Final = "speed beyond its limit"


@pytest.mark.parametrize(
    ("how", "broken"),
    [
        ({"powered": frozenset({"left", "right"})}, True),
        ({"powered": frozenset({"right"})}, False),
        ({"powered": frozenset({"right"}), "left_out": frozenset({"left"})}, True),
        ({"let_go": True}, True),
        ({}, False),
    ],
)
def test_too_fast_is_what_has_the_power_of_its_mode_or_was_let_go_by_the_bridge_itself(
    how: dict[str, object], *, broken: bool
) -> None:
    own = {**look().own, SPEED: 1.01}
    violation = Judge(invariants(RARS)).look(0, look(own=own, may_move=True, **how))
    assert (violation is not None and violation.name == SPEED) is broken


@pytest.mark.interpreted
def test_a_bridge_that_drives_as_fast_as_ever_after_a_failure_is_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    steps = (step(3.5, mode="lift_failed"), step(4.0, arm=True), step(5.0, speed_mps=0.4))
    mission = story(STANDS, *steps, seconds=20)
    # What the interlocks and the ramp have for this mode; the judge takes the robot file.
    geometry = type(RARS.geometry)
    narrow = RARS.geometry.narrowed
    one = Life(RARS, bench_setup_of(RARS), mission, 0, invariants(RARS))
    assert one.run(from_seconds(8.0)) is None
    one.rig.finish()
    monkeypatch.setattr(geometry, "narrowed", property(lambda self: self.limits))
    monkeypatch.setattr(
        "hil_tests.adversary.own.limits",
        lambda _, rig: narrow if rig.bridge.seen.facts.mode else RARS.geometry.limits,
    )
    one = Life(RARS, bench_setup_of(RARS), mission, 0, invariants(RARS))
    violation = one.run(from_seconds(8.0))
    one.rig.finish()
    assert violation is not None
    assert violation.name == SPEED


@pytest.mark.long(beside="test_a_rule_is_broken_when_it_was_for_its_time")
@pytest.mark.interpreted
def test_a_bridge_that_lets_go_on_a_slope_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("firmware_bridge.bridge.power_down._pulls", lambda _: None)
    monkeypatch.setattr("firmware_bridge.bridge.power_down._Axis.slips", False)
    floor = {"slope": 0.05, "floor_friction": 0.9}
    mission = story(STANDS, ARMED, seconds=20).model_copy(
        update={"plant": floor, "fault": (fault("bridge_ends", 4.0),)}
    )
    one = Life(RARS, bench_setup_of(RARS), mission, 0, invariants(RARS))
    violation = one.run(from_seconds(9.0))
    one.rig.finish()
    assert violation is not None
    assert violation.name == "let go, and rolls"


ROME: Final = over_protocol(find("rome"), "mw", 3)
STOPS_ITSELF: Final = find("rome")
WHEELS: Final = frozenset({"one", "two", "three"})


def rolling(robot: AnyRobot, **how: object) -> Look:
    """A robot's three wheels turn with power; it is disarmed."""
    wheels = look(robot=robot, speeds=dict.fromkeys(WHEELS, 1.0), places={}, powered=WHEELS)
    return replace(wheels, own=dict.fromkeys((own.name for own in OWN["rome"]), 0.0), **how)  # type: ignore[arg-type]


def ahead(robot: AnyRobot, *faults: Fault) -> Life:
    """Return a life in which it arms, and drives ahead."""
    steps = [{"at_s": 3.0, "title": "arm", "arm": True}, {"at_s": 3.5, "title": "go", "speed_mps": 0.3}]
    bench_setup = bench_setup_of(robot)
    does = tuple(map(bench_setup.step.model_validate, steps))
    mission = Mission(title="ahead", duration_s=20.0, step=does, fault=faults)
    return Life(robot, bench_setup, mission, 0, invariants(robot))


@pytest.mark.parametrize(
    ("robot", "how", "name", "within_s"),
    [
        (STOPS_ITSELF, {}, "motion with power that may not be", 3.2),
        (STOPS_ITSELF, {"unreached": WHEELS}, "a board that no one reaches runs on", 2.1),
        (ROME, {"unreached": WHEELS}, "motion with power that may not be", 3.2),
        (ROME, {"unreached": WHEELS, "runs_on": WHEELS, "gone": True}, None, 1_000.0),
    ],
)
def test_a_board_has_its_time_to_boot_and_what_no_one_reaches_is_judged_by_its_own_stop(
    robot: AnyRobot, how: dict[str, object], name: str | None, within_s: float
) -> None:
    judge, turns = Judge(invariants(robot)), rolling(robot, **how)
    assert judge.look(0, turns) is None
    assert judge.look(from_seconds(within_s) - 1, turns) is None
    violation = judge.look(from_seconds(within_s), turns)
    assert (None if violation is None else violation.name) == name


@pytest.mark.parametrize(
    ("robot", "faults", "until_s", "unreached", "runs_on"),
    [
        (ROME, (), 0.3, False, False),
        (ROME, (fault("board_silent", 0.2),), 0.3, True, True),
        (STOPS_ITSELF, (fault("board_silent", 0.2),), 0.3, True, False),
        (STOPS_ITSELF, (fault("board_brown_out", 0.2),), 0.3, True, True),
        (STOPS_ITSELF, (fault("i2c_stuck", 0.2),), 0.3, True, True),
        (STOPS_ITSELF, (fault("serial_unplugged", 0.2),), 0.3, True, False),
        (ROME, (fault("bridge_ends", 0.2, how="killed"),), 0.3, True, True),
        (ROME, (fault("bridge_ends", 0.2),), 3.0, True, False),
        (ROME, (fault("board_hangs", 0.3),), 0.3, False, True),
        (ROME, (fault("board_hangs", 0.2),), 0.3, False, False),
    ],
)
def test_whom_a_word_reaches_is_known_by_the_bench(
    robot: AnyRobot, faults: tuple[Fault, ...], until_s: float, *, unreached: bool, runs_on: bool
) -> None:
    """A bridge that has ended in good order is no excuse for a board that runs on."""
    one = ahead(robot, *faults)
    one.rig.run(from_seconds(until_s))
    found = Reached(robot).look(one.rig)
    one.rig.finish()
    assert found == (WHEELS if unreached else frozenset(), WHEELS if runs_on else frozenset())


@pytest.mark.interpreted
def test_a_board_that_hangs_and_is_not_reset_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Booting, "pulse", lambda *_: ())
    one = ahead(ROME, fault("board_hangs", 5.0))
    violation = one.run(from_seconds(10.0))
    one.rig.finish()
    assert violation is not None
    assert violation.name == "motion with power that may not be"


def _ends(_: object) -> None:
    raise KeyError("nothing")


def test_a_bridge_that_ends_in_an_exception_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    one = ahead(ROME)
    monkeypatch.setattr(one.rig, "run", _ends)
    violation = one.run(from_seconds(1.0))
    one.rig.finish()
    assert violation is not None
    assert violation.name == "KeyError: 'nothing'"
