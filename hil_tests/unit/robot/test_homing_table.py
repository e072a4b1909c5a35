"""`[axes.zero.homing]` in a robot file: each key at its bound, and beyond it in words."""

import pytest

from firmware_bridge.robot import RobotFileError
from hil_tests.scenarios.homed import LIFT, STEER, homed

LIFT_AT = "axes[3]"
SEEKS_S = 90.8197


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("speed = 4.0", "speed = 29.3"),
        ("zero_speed = 1.0", "zero_speed = 0.0042"),
        ("offset = 0.21", "offset = 36.0\nat = 363.27862"),
        ("within_s = 100.0", "within_s = 90.88"),
        ("current_a = 0.5", "current_a = 2.0"),
    ],
)
def test_a_table_at_its_bounds_is_good(old: str, new: str) -> None:
    assert homed(LIFT.replace(old, new)).axes[3].zero.homing is not None


@pytest.mark.parametrize(
    ("old", "new", "key", "words"),
    [
        (
            "method = -4",
            "method = 35",
            f"{LIFT_AT}.zero.homing.method",
            "must be one of -4, -3, -2, -1, 1, 2, 7",
        ),
        ("method = -4", "method = 0", f"{LIFT_AT}.zero.homing.method", "must be one of"),
        ("method = -4", "", f"{LIFT_AT}.zero.homing.method", "is missing"),
        ("\nspeed = 4.0", "", f"{LIFT_AT}.zero.homing.speed", "is missing"),
        ("\nspeed = 4.0", "\nsped = 4.0", f"{LIFT_AT}.zero.homing.sped", "perhaps 'speed'?"),
        ("\nspeed = 4.0", "\nspeed = -4.0", f"{LIFT_AT}.zero.homing.speed", "greater than 0"),
        ("\nspeed = 4.0", "\nspeed = 29.4", LIFT_AT, "goes with 29.4, top_speed is 29.3"),
        ("zero_speed = 1.0", "zero_speed = 29.4", LIFT_AT, "goes with 29.4, top_speed is 29.3"),
        (
            "zero_speed = 1.0",
            "zero_speed = 0.0041",
            LIFT_AT,
            "has 0.0041 where 1 rpm of the motor is 0.004189",
        ),
        ("acceleration = 40.0", "acceleration = 0.001", LIFT_AT, "1 rpm of the motor"),
        ("offset = 0.21", "at = -0.1", LIFT_AT, "ends at -0.1, which is not within travel"),
        ("offset = 0.21", "at = 363.3", LIFT_AT, "ends at 363.3, which is not within travel"),
        ("offset = 0.21", "offset = -364.0", LIFT_AT, "an offset longer than travel"),
        ("within_s = 100.0", "within_s = 90.87", LIFT_AT, "lasts 90.9 s from end to end, within_s is less"),
        ("current_a = 0.5", "", f"{LIFT_AT}.zero.homing", "method -4 needs current_a"),
        (
            "method = -4",
            "method = 17",
            f"{LIFT_AT}.zero.homing",
            "method 17 goes by no stop and takes no current_a",
        ),
        ("current_a = 0.5", "current_a = 2.1", LIFT_AT, "more current_a than the drive may give"),
        (
            "offset = 0.21",
            'after = ["stear"]',
            f"{LIFT_AT}.zero.homing.after",
            "no axis 'stear'; perhaps 'steer'?",
        ),
        ("offset = 0.21", 'after = ["lift"]', f"{LIFT_AT}.zero.homing.after", "would wait for 'lift'"),
    ],
)
def test_a_mistake_is_reported_with_its_key(old: str, new: str, key: str, words: str) -> None:
    assert old in LIFT
    with pytest.raises(RobotFileError) as wrong:
        homed(LIFT.replace(old, new))
    reported = str(wrong.value)
    assert f"homed.toml: {key}: " in reported
    assert words in reported


def test_two_that_wait_for_each_other_are_reported() -> None:
    with pytest.raises(RobotFileError) as wrong:
        homed(LIFT.replace("offset = 0.21", 'after = ["steer"]'), STEER)
    assert "'steer' would wait for 'lift', which waits for it" in str(wrong.value)


@pytest.mark.parametrize(
    ("method", "turns", "seeks_s"), [(33, 1, 0.0), (17, 0, SEEKS_S), (1, 1, SEEKS_S), (-2, 1, SEEKS_S)]
)
def test_how_far_and_how_long_follow_from_the_method(method: int, turns: int, seeks_s: float) -> None:
    """363.28 rad at 4 rad/s; a turn of the motor is 0.2513 rad, at 1 rad/s; an offset of 0.21 rad at 4."""
    by_stop = method < 0
    text = LIFT.replace("method = -4", f"method = {method}")
    axis = homed(text if by_stop else text.replace("current_a = 0.5", "#")).axes[3]
    homing, travel = axis.zero.homing, axis.travel
    assert homing is not None
    assert travel is not None
    assert homing.furthest(travel, axis.motor_turn) == pytest.approx(363.489 + 0.2513 * turns, abs=1e-3)
    expected = seeks_s + 0.0525 + 0.2513 * turns
    assert homing.lasts_s(travel, axis.motor_turn) == pytest.approx(expected, abs=1e-3)
