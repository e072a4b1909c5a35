"""Two bodies against numerical integration, closed forms and what follows from the printed state."""

import math

import numpy as np
import pytest

from firmware_bridge.motion.chain import Matrix
from firmware_bridge.motion.orbit import (
    THESIS,
    OrbitState,
    between,
    functions,
    period,
    propagated,
    state,
    stumpff,
)
from firmware_bridge.motion.orbit_elements import Elements, elements, state_of
from firmware_bridge.motion.orbit_relative import absolute, closed, relative, transition
from firmware_bridge.motion.orbit_scale import TU_S, Scale, real_seconds
from hil_tests.rows import every

ORBITS = {
    "printed": THESIS,
    "circle": state((1.2, 0.0, 0.0), (0.0, math.sqrt(1.0 / 1.2), 0.0)),
    "upright": state_of(Elements(2.0, 0.3, math.pi / 2.0, 1.0, 2.0, 3.0)),
    "backwards": state_of(Elements(1.5, 0.1, 2.8, 5.0, 4.0, 0.3)),
    "slender": state_of(Elements(2.0, 0.9, 0.4, 0.1, 0.2, 2.0)),
    "hyperbola": state_of(Elements(-2.0, 1.6, 0.3, 0.5, 1.0, -0.8)),
    "parabola": state((1.0, 0.0, 0.2), (0.0, math.sqrt(2.0 / math.hypot(1.0, 0.2)), 0.0)),
}


def integrated(begin: OrbitState, time: float, steps: int) -> Matrix:
    """Return the state after a time by Runge and Kutta's steps, in plain numbers."""

    def slope(y: tuple[float, ...]) -> tuple[float, ...]:
        cube = (y[0] ** 2 + y[1] ** 2 + y[2] ** 2) ** 1.5
        return (y[3], y[4], y[5], -y[0] / cube, -y[1] / cube, -y[2] / cube)

    def moved(y: tuple[float, ...], by: tuple[float, ...], share: float) -> tuple[float, ...]:
        return tuple(one + share * two for one, two in zip(y, by, strict=True))

    y, h = (*map(float, begin.place), *map(float, begin.speed)), time / steps
    for _ in range(steps):
        a = slope(y)
        b = slope(moved(y, a, h / 2.0))
        c = slope(moved(y, b, h / 2.0))
        d = slope(moved(y, c, h))
        y = tuple(
            it + h / 6.0 * (one + 2.0 * two + 2.0 * three + four)
            for it, one, two, three, four in zip(y, a, b, c, d, strict=True)
        )
    return np.array(y)


@every("name", sorted(ORBITS.keys() - {"slender"}))
def test_it_is_where_numerical_integration_leads(name: str) -> None:
    begin, time = ORBITS[name], 4.0
    end = propagated(begin, time)
    assert np.r_[end.place, end.speed] == pytest.approx(integrated(begin, time, 1_600), abs=1e-9)


@pytest.mark.long(beside="test_it_is_where_numerical_integration_leads")
@pytest.mark.parametrize("name", sorted(ORBITS))
def test_it_is_where_numerical_integration_leads_after_a_whole_revolution(name: str) -> None:
    begin = ORBITS[name]
    time = min(1.3 * period(begin), 100.0)
    end = propagated(begin, time)
    fine, coarse = (integrated(begin, time, steps) for steps in (160_000, 80_000))
    assert np.abs(fine - coarse).max() < 1e-9  # the integration's own error
    assert np.r_[end.place, end.speed] == pytest.approx(fine, abs=1e-9)


@every("name", sorted(ORBITS))
def test_f_and_g_keep_their_determinant_and_are_those_of_the_two_states(name: str) -> None:
    begin = ORBITS[name]
    for time in (-700.0, -3.0, 0.0, 1e-9, 0.1, 2.5, 33.0, 1_000.0):
        by = functions(begin, time)
        size = max(1.0, abs(by.f * by.g_rate))
        assert by.f * by.g_rate - by.f_rate * by.g == pytest.approx(1.0, abs=1e-11 * size)
        if abs(time) < 50.0:
            assert between(begin, propagated(begin, time)) == pytest.approx(by, rel=1e-9, abs=1e-9)
        end = propagated(begin, time)
        assert end.energy() == pytest.approx(begin.energy(), abs=1e-9)
        back = propagated(end, -time)
        assert back.place == pytest.approx(begin.place, abs=1e-8)


def test_in_a_plane_f_and_g_are_the_theses_own_with_their_factors_and_dots() -> None:
    flat = state((-0.6, 1.7, 0.0), (-0.95, -0.06, 0.0))
    end = propagated(flat, 7.0)
    (x0, y0, _), (u0, v0, _), (x, y, _), (u, v, _) = flat.place, flat.speed, end.place, end.speed
    h = x0 * v0 - y0 * u0
    printed = ((x * v0 - y * u0) / h, (-x * y0 + y * x0) / h, (u * v0 - v * u0) / h, (-u * y0 + v * x0) / h)
    assert functions(flat, 7.0) == pytest.approx(printed, abs=1e-12)


def test_the_printed_state_is_an_eccentric_medium_orbit() -> None:
    orbit = elements(THESIS)
    assert period(THESIS) == pytest.approx(60.835, abs=5e-4)
    assert orbit.axis == pytest.approx(4.543, abs=5e-4)
    assert orbit.eccentricity == pytest.approx(0.648, abs=5e-4)
    assert math.degrees(orbit.inclination) == pytest.approx(1.00, abs=5e-3)
    assert pytest.approx(806.81, abs=5e-3) == TU_S
    assert real_seconds(period(THESIS)) / 3600.0 == pytest.approx(13.6, abs=0.05)
    path = np.array([propagated(THESIS, 0.1 * n).place for n in range(609)])
    assert np.ptp(path, axis=0)[:2] == pytest.approx((7.2, 8.8), abs=0.05)
    assert 1000.0 * path[:, 2].min() == pytest.approx(-84.0, abs=0.5)
    assert 1000.0 * path[:, 2].max() == pytest.approx(43.0, abs=0.5)


@every("name", sorted(ORBITS.keys() - {"parabola"}))
def test_elements_lead_back_to_the_state(name: str) -> None:
    again = state_of(elements(ORBITS[name]))
    assert again.place == pytest.approx(ORBITS[name].place, abs=1e-12)
    assert again.speed == pytest.approx(ORBITS[name].speed, abs=1e-12)


def test_elements_are_those_that_were_given_and_only_the_anomaly_moves() -> None:
    given = Elements(2.0, 0.3, 1.1, 1.0, 2.0, 3.0)
    assert elements(state_of(given)) == pytest.approx(given)
    later = elements(propagated(state_of(given), 5.0))
    assert later[:5] == pytest.approx(given[:5])
    # Kepler's equation, the other way round.
    since = []
    for anomaly in (given.anomaly, later.anomaly):
        half = math.tan(anomaly / 2.0) * math.sqrt(0.7 / 1.3)
        eccentric = 2.0 * math.atan(half) % math.tau
        since.append((eccentric - 0.3 * math.sin(eccentric)) * 2.0**1.5)
    assert since[1] - since[0] == pytest.approx(5.0, abs=1e-9)


@every(
    ("place", "speed"), [((1.0, 0.0, 0.0), (0.0, math.sqrt(2.0), 0.0)), ((1.0, 0.0, 0.0), (0.3, 0.0, 0.0))]
)
def test_what_has_no_elements_is_refused(
    place: tuple[float, float, float], speed: tuple[float, float, float]
) -> None:
    with pytest.raises(ValueError, match="parabola and a straight fall"):
        elements(state(place, speed))


def test_what_is_no_orbit_is_refused() -> None:
    for wrong in (Elements(2.0, 1.2, 0.0, 0.0, 0.0, 0.0), Elements(-2.0, 1.2, 0.0, 0.0, 0.0, 3.0)):
        with pytest.raises(ValueError, match="no orbit has"):
            state_of(wrong)
    with pytest.raises(ValueError, match="not at its center"):
        propagated(state((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), 1.0)


@every("value", [-30.0, -1.0, -0.999, -1e-8, 0.0, 1e-8, 0.999, 1.0, 40.0])
def test_stumpffs_functions_are_smooth_where_they_change_their_way(value: float) -> None:
    root = complex(value, 0.0) ** 0.5
    if abs(value) > 1e-3:
        c = ((1.0 - np.cos(root)) / value).real
        s = ((root - np.sin(root)) / root**3).real
        assert stumpff(value) == pytest.approx((c, s), rel=1e-12)
    else:
        assert stumpff(value) == pytest.approx((0.5 - value / 24.0, 1.0 / 6.0 - value / 120.0), rel=1e-15)


# On the floor


def test_the_printed_orbit_fits_the_floor_and_its_speeds_the_base() -> None:
    path = [propagated(THESIS, 0.1 * n) for n in range(609)]
    scale = Scale()
    shown = [scale.on_floor(it) for it in path]
    assert np.ptp([it.place for it in shown], axis=0)[:2] == pytest.approx((2.9, 3.5), abs=0.05)
    fastest = max(float(np.hypot(*it.speed[:2])) for it in shown)
    assert fastest == pytest.approx(0.406, abs=5e-4)
    assert scale.on_floor(THESIS).place == pytest.approx((-0.2394, 0.66536, 0.01116))
    assert scale.slowed(path, 0.5, 0.2) == scale
    slower = scale.slowed(path, 0.3, 10.0)
    assert slower.seconds_per_tu == pytest.approx(fastest / 0.3)
    assert max(float(np.hypot(*slower.on_floor(it).speed[:2])) for it in path) == pytest.approx(0.3)
    assert scale.slowed(path, 10.0, 0.157 / 4.0).seconds_per_tu == pytest.approx(2.0, rel=0.005)
    rises = max(abs(float(it.speed[2])) for it in shown)
    assert scale.slowed(path, 10.0, 10.0, rises) == scale
    assert scale.slowed(path, 10.0, 10.0, rises / 3.0).seconds_per_tu == pytest.approx(3.0)
    falls = [it for it in path if it.speed[2] < 0.0]
    lowest = min(float(scale.on_floor(it).speed[2]) for it in falls)
    assert scale.slowed(falls, 10.0, 10.0, -lowest / 3.0).seconds_per_tu == pytest.approx(3.0)
    raised = Scale(height_per_du=1.0).on_floor(THESIS)
    assert (raised.place[2], raised.speed[2]) == pytest.approx((0.0279, 0.0110))
    assert raised.place[0] == pytest.approx(-0.5985 * 0.4)


# Relative motion


def test_small_distances_move_as_the_linear_law_states_and_the_error_is_of_second_order() -> None:
    chief = ORBITS["circle"]
    n = math.tau / period(chief)
    errors = []
    for size in (1e-3, 5e-4):
        seen = OrbitState(size * np.array((1.0, -0.5, 0.8)), size * n * np.array((0.3, -0.4, 0.5)))
        deputy = absolute(chief, seen)
        assert relative(chief, deputy).place == pytest.approx(seen.place, abs=1e-15)
        assert relative(chief, deputy).speed == pytest.approx(seen.speed, abs=1e-15)
        meant = transition(n, 1.0) @ np.r_[seen.place, seen.speed]
        true = relative(propagated(chief, 1.0), propagated(deputy, 1.0))
        errors.append(float(np.abs(np.r_[true.place, true.speed] - meant).max()))
    assert errors[0] < 5e-6
    assert errors[1] == pytest.approx(errors[0] / 4.0, rel=0.02)


def test_the_linear_law_is_a_flow_and_solves_its_equations() -> None:
    n, step = 0.7, 1e-6
    assert transition(n, 0.0) == pytest.approx(np.eye(6))
    assert transition(n, 3.0) == pytest.approx(transition(n, 2.0) @ transition(n, 1.0))
    change = (transition(n, step) - transition(n, -step)) / (2.0 * step)
    law = np.zeros((6, 6))
    law[:3, 3:] = np.eye(3)
    law[3, 0], law[3, 4], law[4, 3], law[5, 2] = 3.0 * n**2, 2.0 * n, -2.0 * n, -(n**2)
    assert change == pytest.approx(law, abs=1e-8)


def test_a_closed_start_comes_back_and_another_drifts() -> None:
    n = 0.7
    begin = closed((0.2, 0.1, 0.05), 0.03, -0.02, n)
    first = np.r_[begin.place, begin.speed]
    assert transition(n, math.tau / n) @ first == pytest.approx(first)
    first[4] += 0.01
    assert (transition(n, math.tau / n) @ first)[1] - first[1] == pytest.approx(-3.0 * math.tau / n * 0.01)
