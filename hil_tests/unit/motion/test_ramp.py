"""The ramp at its bounds: straight on, in a turn, braking where a turn takes everything, and late cycles."""

import math

import pytest

from firmware_bridge.motion.ramp import BRAKING_SHARE, CATCHES_UP, MARGIN, Ramp
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rars.kinematics import ramp_of
from firmware_bridge.units import MILLISECOND

CYCLE = 50 * MILLISECOND
RAMP = Ramp(limit_mps2=1.3, half_track_m=0.2, longest_step=CYCLE)
STEP = 1.3 * 0.05


def test_the_bounds_come_from_the_robot_file_with_a_margin() -> None:
    ramp = ramp_of(find("rars"))
    assert pytest.approx(0.80) == MARGIN
    assert ramp == Ramp(0.80 * 0.144 * 9.81, 0.2, CYCLE)


@pytest.mark.parametrize(
    ("speed", "target", "set_point"),
    [
        (0.0, 0.5, STEP),
        (0.0, -0.5, -STEP),
        (0.5, 0.0, 0.5 - STEP),
        (-0.5, 0.0, -0.5 + STEP),
        (0.3, 0.3, 0.3),
        (0.3, 0.3 + 0.9 * STEP, 0.3 + 0.9 * STEP),
        (0.3, 0.3 - 0.9 * STEP, 0.3 - 0.9 * STEP),
        (0.3, 0.3 + 1.1 * STEP, 0.3 + STEP),
        (0.3, 0.3 - 1.1 * STEP, 0.3 - STEP),
        (0.03, -0.5, 0.03 - STEP),
        (-0.03, 0.5, -0.03 + STEP),
    ],
)
def test_straight_on_one_step_is_the_limit_at_most(speed: float, target: float, set_point: float) -> None:
    assert RAMP.step(speed, target, 0.0, CYCLE) == pytest.approx(set_point, abs=1e-12)


@pytest.mark.parametrize(("elapsed", "share"), [(0, 0.0), (CYCLE // 2, 0.5), (CYCLE, 1.0), (4 * CYCLE, 1.0)])
def test_a_step_is_as_long_as_its_time_but_no_longer_than_a_cycle(elapsed: int, share: float) -> None:
    assert RAMP.step(0.0, 0.5, 0.0, elapsed) == pytest.approx(share * STEP)


@pytest.mark.parametrize("bend", [1 / 0.415, -1 / 0.415])
def test_the_outer_wheel_stays_within_the_limit(bend: float) -> None:
    # From rest V^2/R is nothing yet: the outer wheel binds, 1 + m/R times the base.
    set_point = RAMP.step(0.0, 0.5, bend, CYCLE)
    assert set_point * (1 + 0.2 / 0.415) == pytest.approx(CATCHES_UP * STEP)
    braked = 0.5 - RAMP.step(0.5, 0.0, bend, CYCLE)
    assert braked * (1 + 0.2 / 0.415) == pytest.approx(STEP), "it brakes by the whole limit"


def test_a_turn_that_changes_takes_its_part_of_the_outer_wheels_limit() -> None:
    # 3 1/(m s) at 0.2 m from the middle: at 0.3 m/s the outer wheel gains 0.18 m/s2 by the turn alone.
    set_point = RAMP.step(0.3, 0.6, 0.0, CYCLE, 3.0)
    assert set_point - 0.3 == pytest.approx(0.05 * (CATCHES_UP * 1.3 - 0.2 * 3.0 * (0.3 + STEP)))
    assert RAMP.step(0.3, 0.6, 0.0, CYCLE, -3.0) == set_point
    assert RAMP.step(0.3, 0.6, 0.0, CYCLE, 1e3) == 0.3, "nothing is left to speed up"
    assert RAMP.step(0.3, 0.0, 0.0, CYCLE, 1e3) == pytest.approx(0.3 - BRAKING_SHARE * STEP)


@pytest.mark.parametrize("bend", [1.0, -1.0])
def test_forward_and_centripetal_acceleration_add_up_as_vectors(bend: float) -> None:
    # At 1.1 m/s on 1 m the turn takes 1.21 m/s2 of 1.3.
    set_point = RAMP.step(1.1, 1.13, bend, CYCLE)
    fastest = 1.13
    along = math.sqrt(1.3**2 - (fastest**2) ** 2)
    assert set_point == pytest.approx(1.1 + along * 0.05)
    assert math.hypot((set_point - 1.1) / 0.05, set_point**2) < 1.3


def test_a_target_above_what_the_turn_allows_is_the_turns_top_speed() -> None:
    # To within one step: the ramp weighs the speed that it might reach, not the one that it will.
    speed = 0.0
    for _ in range(200):
        speed = RAMP.step(speed, 9.0, 1.0, CYCLE)
        assert speed**2 <= 1.3
    assert math.sqrt(1.3) - STEP <= speed <= math.sqrt(1.3)
    back = 0.0
    for _ in range(200):
        back = RAMP.step(back, -9.0, 1.0, CYCLE)
    assert back == -speed


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_near_the_turns_top_speed_nothing_is_left_to_speed_up(sign: float) -> None:
    top = sign * math.sqrt(1.3 / 0.5)
    little = sign * 0.001
    assert RAMP.step(top - little, sign * 9.0, 0.5, CYCLE) == pytest.approx(top - little, abs=1e-8)
    assert RAMP.step(top, sign * 9.0, 0.5, CYCLE) == pytest.approx(top)
    assert RAMP.step(top + little, sign * 9.0, 0.5, CYCLE) == pytest.approx(top)


@pytest.mark.parametrize(("speed", "sign"), [(2.0, 1), (-2.0, -1)])
def test_braking_is_always_possible(speed: float, sign: int) -> None:
    # A turn that tightened at speed takes more than the limit; braking keeps its share.
    set_point = RAMP.step(speed, 0.0, 1.0, CYCLE)
    assert pytest.approx(0.5) == BRAKING_SHARE
    assert set_point == pytest.approx(speed - sign * 0.5 * STEP)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_braking_uses_more_than_its_share_where_there_is_room(sign: float) -> None:
    along = math.sqrt(1.3**2 - (0.9**2) ** 2)
    assert along > 0.5 * 1.3
    assert RAMP.step(sign * 0.9, 0.0, 1.0, CYCLE) == pytest.approx(sign * (0.9 - along * 0.05))


def test_speeding_up_has_no_reserved_share() -> None:
    # 1.14^2 = 1.2996: almost nothing is left to speed up, and braking's share is not lent out.
    assert RAMP.step(1.14, 1.1402, 1.0, CYCLE) - 1.14 < 0.001
    assert RAMP.step(1.13, 1.1401, 1.0, CYCLE) - 1.13 == pytest.approx(
        0.05 * math.sqrt(1.3**2 - 1.1401**4), rel=1e-6
    )
