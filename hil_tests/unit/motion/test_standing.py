"""How firmly a robot stands: figures of the thesis, and the edges' inequalities against trying them out."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from firmware_bridge.motion.standing import Standing
from firmware_bridge.units import STANDARD_GRAVITY
from hil_tests.rows import every

WHEELBASE = 0.515
TRAPEZIUM = ((0.0, -0.2), (WHEELBASE, -0.168), (WHEELBASE, 0.168), (0.0, 0.2))
RECTANGLE = ((0.0, -0.168), (WHEELBASE, -0.168), (WHEELBASE, 0.168), (0.0, 0.168))
BACK = 0.141
ANGLES = st.floats(-0.6, 0.6)
PULLS = st.floats(-5.0, 5.0)


def height(payload_kg: float, table_m: float) -> float:
    return (70.0 * 0.19 + 8.0 * (table_m - 0.5) / 2.0 + payload_kg * table_m) / (70.0 + payload_kg)


@every(
    ("payload_kg", "table_m", "back_deg", "across_deg"),
    [(10.0, 1.5, 19.3, 22.6), (0.0, 0.5, 36.6, 41.5)],
)
def test_static_tip_angles_of_the_thesis_model(
    payload_kg: float, table_m: float, back_deg: float, across_deg: float
) -> None:
    centre = (BACK, 0.0, height(payload_kg, table_m))
    for pitch, roll, angle in ((1.0, 0.0, back_deg), (0.0, 1.0, across_deg), (0.0, -1.0, across_deg)):
        held, gone = (math.radians(angle + step) for step in (-0.06, 0.06))
        assert Standing(RECTANGLE, centre, pitch * held, roll * held).margin() > 0.0
        assert Standing(RECTANGLE, centre, pitch * gone, roll * gone).margin() < 0.0


def test_ten_kilograms_on_thirty_degrees_leave_0_034_g_uphill() -> None:
    standing = Standing(RECTANGLE, (BACK, 0.0, height(10.0, 0.5)), math.radians(30.0))
    low, high = standing.accelerations(0.0, 0.0)
    assert high / STANDARD_GRAVITY == pytest.approx(0.034, abs=5e-4)
    assert low < 0.0
    # x_z = x_cg - z tan(30 degrees).
    assert standing.margin() == pytest.approx(0.009, abs=5e-4)
    without = Standing(RECTANGLE, (BACK, 0.0, 0.19), math.radians(30.0))
    assert without.accelerations(0.0, 0.0)[1] / STANDARD_GRAVITY == pytest.approx(0.144, abs=2e-3)


@given(ANGLES, ANGLES, PULLS, st.floats(0.0, 0.02), st.floats(0.1, 0.5))
def test_at_the_bounds_of_the_acceleration_the_margin_is_the_least(
    pitch: float, roll: float, left: float, least: float, centre_height: float
) -> None:
    standing = Standing(TRAPEZIUM, (BACK, 0.0, centre_height), pitch, roll)
    low, high = standing.accelerations(left, least)
    if low > high:
        assert max(standing.margin(step / 10.0, left) for step in range(-200, 200)) < least + 1e-9
        return
    for bound in (low, high):
        assert standing.margin(bound, left) == pytest.approx(least, abs=1e-9)
    assert standing.margin((low + high) / 2.0, left) >= least - 1e-9
    assert standing.margin(low - 0.01, left) < least
    assert standing.margin(high + 0.01, left) < least


def pushed(centre: tuple[float, float, float], pitch: float, speed: float, *, over_front: bool) -> bool:
    """Return whether a point mass whose wheels stop at once turns over the edge ahead, by its energy."""
    x, _, z = centre
    room = WHEELBASE - x if over_front else x
    # The angle of gravity in the plane across the edge, from the floor's normal, outwards.
    leans = -pitch if over_front else pitch
    now = math.atan2(room, z) - leans
    lever = math.hypot(room, z)
    return now < 0.0 or speed**2 / 2.0 > STANDARD_GRAVITY * lever * (1.0 - math.cos(now))


@given(ANGLES, st.floats(0.1, 0.6), st.floats(0.05, 0.45), st.sampled_from(("front", "rear")))
def test_below_the_safe_speed_the_energy_does_not_reach_over_the_edge(
    pitch: float, centre_height: float, x: float, edge: str
) -> None:
    centre, over_front = (x, 0.0, centre_height), edge == "front"
    safe = Standing(RECTANGLE, centre, pitch).safe_speed(1.0 if over_front else -1.0)
    assume(safe > 1e-3)
    assert not pushed(centre, pitch, 0.999 * safe, over_front=over_front)
    assert pushed(centre, pitch, 1.001 * safe, over_front=over_front)


def test_a_robot_that_turns_over_by_itself_has_no_safe_speed() -> None:
    assert Standing(RECTANGLE, (BACK, 0.0, 0.404), math.radians(25.0)).safe_speed(-1.0) == 0.0


@pytest.mark.parametrize("tilt", [(math.pi / 2, 0.0), (0.0, math.pi / 2), (math.nan, 0.0), (2.0, 2.0)])
def test_a_tilt_that_no_robot_stands_on_is_refused(tilt: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="tilted by"):
        Standing(TRAPEZIUM, (BACK, 0.0, 0.19), *tilt)


def test_nose_downhill_the_rear_wheels_bear_less_and_hold_less() -> None:
    down, up = (
        Standing(TRAPEZIUM, (BACK, 0.0, 0.404), math.radians(degrees)).friction(0.0, WHEELBASE)
        for degrees in (-20.0, 20.0)
    )
    # The rear pair's share by moments about the front contacts: (0.515 - 0.141 -+ 0.404 tan 20) / 0.515.
    assert down == pytest.approx(math.tan(math.radians(20.0)) / 0.44070, rel=1e-4)
    assert up == pytest.approx(math.tan(math.radians(20.0)) / 1.01174, rel=1e-4)
    # Across the slope all wheels hold, whatever the height.
    across = Standing(TRAPEZIUM, (BACK, 0.0, 0.404), 0.0, math.radians(20.0))
    assert across.friction(0.0, WHEELBASE) == pytest.approx(math.tan(math.radians(20.0)))
    assert Standing(TRAPEZIUM, (BACK, 0.0, 0.404), math.radians(-45.0)).friction(0.0, WHEELBASE) == math.inf


@given(ANGLES, ANGLES, st.floats(0.1, 1.2), st.floats(0.1, 0.6))
def test_up_to_the_highest_that_is_held_the_friction_is_enough(
    pitch: float, roll: float, friction: float, centre_height: float
) -> None:
    def needs(height_m: float) -> float:
        return Standing(TRAPEZIUM, (BACK, 0.0, height_m), pitch, roll).friction(0.0, WHEELBASE)

    standing = Standing(TRAPEZIUM, (BACK, 0.0, centre_height), pitch, roll)
    highest = standing.highest_held(friction, 0.0, WHEELBASE)
    if highest == math.inf:
        assert needs(centre_height) <= friction * (1.0 + 1e-9)
    elif highest > 1e-6:
        assert needs(highest * 0.999) <= friction * (1.0 + 1e-9)
        assert needs(highest * 1.001 + 1e-6) > friction
    else:
        assert needs(max(centre_height, 1e-3)) > friction * (1.0 - 1e-9)
