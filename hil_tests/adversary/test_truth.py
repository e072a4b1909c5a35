"""What the adversary judges by: figures of the plant, and what they are held against."""

import math
from dataclasses import replace
from typing import Final

import pytest

from emulators.bench.columns import Sample
from emulators.bench.rehearsal import rehearsal_of
from firmware_bridge.kinds import find
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import STANDARD_GRAVITY, from_seconds
from hil_tests.adversary.own import MARGIN_M, OWN, zero_moment_point
from hil_tests.adversary.search import Life
from hil_tests.adversary.truth import Judge, Look, invariants
from hil_tests.scenarios.ride import ARMED, STANDS, fault, ride, step, story

RARS: Final[AnyRobot] = find("rars")
CENTRE_M: Final = 0.220 * 70.0 / 70.6
"""Of platform and rear wheels, ahead of the rear axle: thesis, Tab. 3.1."""
HEIGHT_M: Final = 0.190


def on_slope(degrees: float) -> AnyRobot:
    floor = {"slope": math.radians(degrees), "floor_friction": 0.9}
    return RARS.model_copy(update={"plant": RARS.plant.model_copy(update={"parameters": floor})})


@pytest.mark.parametrize("degrees", [0.0, 10.0, -10.0])
def test_at_rest_the_zero_moment_point_is_below_the_centre_of_mass(degrees: float) -> None:
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
        ("power that nobody watches", {"unwatched": frozenset({"left"})}, 1.0),
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


@pytest.mark.interpreted
def test_a_bridge_that_lets_go_on_a_slope_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("firmware_bridge.bridge.letting_go._pulls", lambda _: None)
    monkeypatch.setattr("firmware_bridge.bridge.letting_go._Axis.slips", False)
    floor = {"slope": 0.05, "floor_friction": 0.9}
    mission = story(STANDS, ARMED, seconds=20).model_copy(
        update={"plant": floor, "fault": (fault("bridge_ends", 4.0),)}
    )
    one = Life(RARS, rehearsal_of(RARS), mission, 0, invariants(RARS))
    violation = one.run(from_seconds(9.0))
    one.rig.finish()
    assert violation is not None
    assert violation.name == "let go, and rolls"
