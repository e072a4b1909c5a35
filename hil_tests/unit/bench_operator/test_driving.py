"""A mission's inputs as the bridge receives them: speed, steering, lift, lamp and detector."""

import math

import pytest

from emulators.bench.log import Subject
from emulators.robots.rars import BENCH_SETUP
from firmware_bridge.intent import Arm, ConfirmPosition, Disarm
from hil_tests.unit.bench_operator.joined import find, join, mission


@pytest.mark.parametrize("how", ["stick", "twist"])
@pytest.mark.parametrize(
    ("speed", "steer_deg"), [(0.3, 20.0), (0.3, -20.0), (-0.3, 20.0), (-0.3, -20.0), (0.5, 0.0)]
)
def test_what_the_mission_states_is_what_the_bridge_understands(
    how: str, speed: float, steer_deg: float
) -> None:
    joined = join(mission(f"1.0 speed_mps = {speed}; steer_deg = {steer_deg}", head=f'input = "{how}"\n'))
    assert joined.run(0.99).command.speed_mps == 0.0
    intent = joined.run(1.0)
    assert intent.command.speed_mps == pytest.approx(speed, abs=0.00026)
    assert intent.command.steer_rad is not None
    assert math.degrees(intent.command.steer_rad) == pytest.approx(steer_deg, abs=0.031)


@pytest.mark.parametrize("how", ["stick", "twist"])
@pytest.mark.parametrize("radius", [1.5, -0.8])
def test_a_radius_is_steered(how: str, radius: float) -> None:
    joined = join(mission(f"1.0 speed_mps = 0.3; radius_m = {radius}", head=f'input = "{how}"\n'))
    steer = joined.run(2.0).command.steer_rad
    assert steer is not None
    # R = a_k / 2 + w cot(theta) (thesis 2.13)
    assert 0.105 + 0.515 / math.tan(abs(steer)) == pytest.approx(abs(radius), rel=2e-3)
    assert math.copysign(1.0, steer) == math.copysign(1.0, radius)


def test_a_twist_can_ask_for_more_than_the_limits() -> None:
    joined = join(mission("1.0 speed_mps = 0.8; steer_deg = 80.0", head='input = "twist"\n'))
    intent = joined.run(2.0)
    assert intent.command.speed_mps == pytest.approx(0.8)
    assert intent.command.steer_rad is not None
    assert math.degrees(intent.command.steer_rad) == pytest.approx(80.0, abs=0.01)


def test_the_line_accelerates_as_in_the_thesis() -> None:
    joined = join(find("line"))
    speeds = {at: joined.run(at).command.speed_mps for at in (4.0, 9.0, 14.0, 18.9, 24.0, 29.0, 31.0)}
    expected = {4.0: 0.0, 9.0: 0.12, 14.0: 0.24, 18.9: 0.24, 24.0: 0.12, 29.0: 0.0, 31.0: 0.0}
    assert speeds == pytest.approx(expected, abs=0.00026)
    confirmed = [ConfirmPosition("steer", 0.0), ConfirmPosition("lift", 0.0)]
    assert joined.robotlike.requests == [*confirmed, Arm(), Disarm()]


def test_lift_lamp_and_detector() -> None:
    joined = join(mission("1.0 arm = true", "2.0 lift_m = 0.4; headlamp = true; detector = true"))
    intent = joined.run(2.1)
    assert intent.command.lift_m == pytest.approx(0.4, abs=1e-6)
    assert (intent.command.headlamp, intent.command.detector) == (True, True)
    assert joined.driver.diary.texts(Subject.ANSWERED) == [
        "arm: accepted", "headlamp: accepted", "detector: accepted", "lift: accepted",
    ]  # fmt: skip


def test_buttons_are_tapped() -> None:
    joined = join(mission('1.0 press = "headlamp"', '2.0 press = "detector"'))
    assert (joined.run(1.5).command.headlamp, joined.run(1.5).command.detector) == (True, False)
    assert (joined.run(2.5).command.headlamp, joined.run(2.5).command.detector) == (True, True)


def test_the_lift_moves_by_stick_until_reported_otherwise() -> None:
    joined = join(mission("1.0 lift_rate_mps = -0.05", "2.0 lift_rate_mps = 0.0"))
    assert joined.run(1.5).command.lift_rate_mps == pytest.approx(-0.05)
    assert joined.run(2.5).command.lift_rate_mps == 0.0


@pytest.mark.long(beside="test_its_missions_drive_without_a_refusal_and_it_ends_without_power")
def test_every_shipped_mission_runs_to_its_end() -> None:
    for script in filter(
        lambda one: one.pilot is None and one.survey is None, map(find, BENCH_SETUP.shipped())
    ):
        joined = join(script)
        joined.run(script.duration_s)
        assert len(joined.driver.diary.texts(Subject.STEP)) == len(script.step)
