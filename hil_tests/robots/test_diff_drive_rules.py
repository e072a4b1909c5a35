"""The differential drive's own interlocks by their numbers; each threshold is in every robot's tests."""

import math
from typing import Any, Final, TypeAlias

import pytest
from diff_drive.motion import Motion, State

from emulators.bench.cases import Situation
from emulators.testing.inherited.fake_driver import START, active, gate_of, seen
from firmware_bridge.differential.kinematics import ramp_of
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, SECOND

DIFF_DRIVE: Final = find("diff_drive")
TURN: Final = DIFF_DRIVE.geometry.limits.turn_rate_rad_s
STEP: Final = ramp_of(DIFF_DRIVE).step((0.0, 0.0), (9.0, 0.0), DIFF_DRIVE.cycle)[0]
SPIN: Final = ramp_of(DIFF_DRIVE).step((0.0, 0.0), (0.0, 9.0), DIFF_DRIVE.cycle)[1]
AnySituation: TypeAlias = Situation[Motion, State]


def tripped(situation: AnySituation) -> set[str]:
    return set(active(gate_of(DIFF_DRIVE).rule(seen(DIFF_DRIVE, START, situation))))


def turning(rate: float) -> AnySituation:
    return Situation(body=State(0.0, rate))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_it_turns_too_fast_a_quarter_above_its_limit_until_it_is_below_it(side: float) -> None:
    gate, now = gate_of(DIFF_DRIVE), START
    for share, spins in ((1.249, False), (1.251, True), (1.001, True), (1.0, True)):
        now += SECOND
        decision = gate.rule(seen(DIFF_DRIVE, now, turning(side * share * TURN)))
        assert ("turns too fast" in active(decision)) is spins
    for late, spins in ((300 * MILLISECOND - 1, True), (300 * MILLISECOND, False)):
        decision = gate.rule(seen(DIFF_DRIVE, now + late, turning(side * TURN)))
        assert ("turns too fast" in active(decision)) is spins


def test_a_robot_that_turns_too_fast_has_to_be_armed_again() -> None:
    (event,) = gate_of(DIFF_DRIVE).rule(seen(DIFF_DRIVE, START, turning(1.3 * TURN))).interlock_events
    assert event.interlock.disarms


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("beyond", "reported"), [(0.0, False), (0.995e-4, False), (1.005e-4, True)])
def test_a_step_that_the_ramp_delays_is_reported(sign: float, beyond: float, *, reported: bool) -> None:
    for command in (Motion(sign * (STEP + beyond)), Motion(turn_rad_s=sign * (SPIN + beyond))):
        assert tripped(Situation(command=command)) == ({"acceleration limit"} if reported else set())


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_only_the_change_counts(sign: float) -> None:
    for motion in (Motion(sign * 0.3), Motion(turn_rad_s=sign * 0.5)):
        assert tripped(Situation(command=motion, commanded=motion)) == set()


def test_what_the_ramp_reaches_in_one_cycle_is_not_reported_even_without_a_tolerance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("firmware_bridge.differential.robot.SPEED_TOLERANCE", 0.0)
    reached: list[tuple[Any, set[str]]] = [
        (Motion(STEP), set()),
        (Motion(math.nextafter(STEP, 9.0)), {"acceleration limit"}),
        (Motion(turn_rad_s=SPIN), set()),
        (Motion(turn_rad_s=math.nextafter(SPIN, 9.0)), {"acceleration limit"}),
    ]
    for command, reported in reached:
        assert tripped(Situation(command=command)) == reported
