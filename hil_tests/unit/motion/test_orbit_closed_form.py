"""Two bodies by closed forms that need no equation solved: the time follows from a chosen anomaly.

Source: H. D. Curtis, Orbital Mechanics for Engineering Students, chapter 3: Kepler's equations for ellipse
and hyperbola, Barker's for the parabola; and Example 4.3.
"""

import math
from collections.abc import Iterable
from itertools import product

import numpy as np
import pytest

from firmware_bridge.motion import orbit
from firmware_bridge.motion.chain import Matrix
from firmware_bridge.motion.orbit import THESIS, OrbitState, period, propagated, state
from firmware_bridge.motion.orbit_elements import Elements, elements, state_of
from hil_tests.rows import every

MU_EARTH = 398600.4418
UNITS = ((1.0, 2.0), (1.0, 0.005), (MU_EARTH, 7000.0))
"""The center's mu, and a size of orbits in the same units."""


def on_ellipse(mu: float, axis: float, e: float, anomaly: float) -> tuple[OrbitState, float]:
    """Return the state at an eccentric anomaly, and the time since the periapsis."""
    sine, cosine = math.sin(anomaly), math.cos(anomaly)
    rate = math.sqrt(mu / axis**3) / (1.0 - e * cosine)
    minor = axis * math.sqrt(1.0 - e**2)
    found = state((axis * (cosine - e), minor * sine, 0.0), (-axis * sine * rate, minor * cosine * rate, 0.0))
    return found, math.sqrt(axis**3 / mu) * (anomaly - e * sine)


def on_hyperbola(mu: float, axis: float, e: float, anomaly: float) -> tuple[OrbitState, float]:
    """Return the same at a hyperbolic anomaly; `axis` is positive."""
    sine, cosine = math.sinh(anomaly), math.cosh(anomaly)
    rate = math.sqrt(mu / axis**3) / (e * cosine - 1.0)
    minor = axis * math.sqrt(e**2 - 1.0)
    found = state((axis * (e - cosine), minor * sine, 0.0), (-axis * sine * rate, minor * cosine * rate, 0.0))
    return found, math.sqrt(axis**3 / mu) * (e * sine - anomaly)


def on_parabola(mu: float, periapsis: float, half: float) -> tuple[OrbitState, float]:
    """Return the same at the tangent of half the true anomaly."""
    rate = math.sqrt(mu / (2.0 * periapsis**3)) / (1.0 + half**2)
    found = state(
        (periapsis * (1.0 - half**2), 2.0 * periapsis * half, 0.0),
        (-2.0 * periapsis * half * rate, 2.0 * periapsis * rate, 0.0),
    )
    return found, math.sqrt(2.0 * periapsis**3 / mu) * (half + half**3 / 3.0)


def assert_near(found: Matrix, expected: Matrix, size: float) -> None:
    error = float(np.linalg.norm(found - expected))
    assert error < 1e-8 * max(size, float(np.linalg.norm(expected)))


def assert_leads(ends: Iterable[tuple[OrbitState, float]], mu: float, size: float) -> None:
    """Check propagation from one state and its time to another."""
    begin, end = ends
    found = propagated(begin[0], end[1] - begin[1], mu)
    assert_near(found.place, end[0].place, size)
    assert_near(found.speed, end[0].speed, math.sqrt(mu / size))


@every(
    ("units", "e", "begin", "onwards"),
    product(UNITS, (0.0, 0.5, 0.99), (0.0, -3.0, 1.0), (0.0, 1e-6, 0.5, 2.0, 4.0, 6.0)),
)
def test_ellipses(units: tuple[float, float], e: float, begin: float, onwards: float) -> None:
    mu, axis = units
    ends = (on_ellipse(mu, axis, e, anomaly) for anomaly in (begin, begin + onwards))
    assert_leads(ends, mu, axis)


@every(
    ("units", "e", "begin", "onwards"),
    product(UNITS, (1.001, 1.5), (0.0, -6.0, 1.0), (1e-6, 0.5, 3.0, 10.0)),
)
def test_hyperbolas(units: tuple[float, float], e: float, begin: float, onwards: float) -> None:
    mu, axis = units
    ends = (on_hyperbola(mu, axis, e, anomaly) for anomaly in (begin, begin + onwards))
    assert_leads(ends, mu, axis)


@every(("units", "begin", "onwards"), product(UNITS, (0.0, -2.0, 1.0), (1e-6, 0.5, 5.0)))
def test_parabolas(units: tuple[float, float], begin: float, onwards: float) -> None:
    mu, size = units
    ends = (on_parabola(mu, size, half) for half in (begin, begin + onwards))
    assert_leads(ends, mu, size)


@every(
    ("place_m", "speed", "mu", "expected"),
    [
        # Kepler's third law: on a circle of 4 with mu = 4 the speed is 1, and the way 8 pi.
        ((4.0, 0.0, 0.0), (0.0, 1.0, 0.0), 4.0, 8.0 * math.pi),
        ((0.25, 0.0, 0.0), (0.0, 2.0, 0.0), 1.0, math.pi / 4.0),
        # A geostationary satellite in km and s: a sidereal day.
        ((42164.17, 0.0, 0.0), (0.0, math.sqrt(MU_EARTH / 42164.17), 0.0), MU_EARTH, 86164.1),
        # A parabola: half the square of 1 is 1 / 2; and hyperbolas with little energy.
        ((2.0, 0.0, 0.0), (0.0, 1.0, 0.0), 1.0, math.inf),
        ((1.0, 0.0, 0.0), (0.0, math.sqrt(2.01), 0.0), 1.0, math.inf),
        ((1.0, 0.0, 0.0), (0.0, math.sqrt(2.0 + 1e-6), 0.0), 1.0, math.inf),
    ],
)
def test_periods(
    place_m: tuple[float, float, float], speed: tuple[float, float, float], mu: float, expected: float
) -> None:
    assert period(state(place_m, speed), mu) == pytest.approx(expected, rel=1e-6)


def test_after_very_many_whole_revolutions_it_is_where_it_began() -> None:
    begin = on_ellipse(MU_EARTH, 7000.0, 0.3, 1.0)[0]
    for start, mu in ((THESIS, 1.0), (begin, MU_EARTH)):
        end = propagated(start, 2.0**40 * period(start, mu), mu)
        assert end.place == pytest.approx(start.place, rel=1e-12)
        assert end.speed == pytest.approx(start.speed, rel=1e-12)


def test_no_time_takes_more_than_a_hundred_evaluations(monkeypatch: pytest.MonkeyPatch) -> None:
    taken, stumpff = 0, orbit.stumpff

    def counted(value: float) -> tuple[float, float]:
        nonlocal taken
        taken += 1
        return stumpff(value)

    monkeypatch.setattr(orbit, "stumpff", counted)
    for time in (0.0, 1e-9, 0.5, 3.0, 30.0, 60.0):
        taken = 0
        propagated(THESIS, time)
        assert taken <= 100


# Elements


def test_elements_of_a_textbooks_example() -> None:
    """Curtis, Example 4.3, in km and s, rounded as printed."""
    orbit_of = elements(state((-6045.0, -3490.0, 2500.0), (-3.457, 6.618, 2.533)), 398600.0)
    assert orbit_of.axis == pytest.approx(8788.0, abs=0.5)
    assert orbit_of.eccentricity == pytest.approx(0.1712, abs=5e-5)
    angles = (orbit_of.inclination, orbit_of.node, orbit_of.periapsis, orbit_of.anomaly)
    assert np.degrees(angles) == pytest.approx((153.2, 255.3, 20.07, 28.45), abs=0.06)


@every(
    ("place", "speed", "expected"),
    [
        # In the plane, and off it by what counts: the node is where the body rises, at y.
        ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 90.0)),
        ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.99e-12), (0.0, 0.0, 0.0, 90.0)),
        ((0.0, 1.0, 0.0), (-1.0, 0.0, 1e-12), (0.0, 90.0, 0.0, 0.0)),
        # A circle, and what counts as none: the periapsis is at -y, where it comes from.
        ((1.0, 0.0, 0.0), (0.99e-12, 1.0, 0.0), (0.0, 0.0, 0.0, 0.0)),
        ((1.0, 0.0, 0.0), (1e-12, 1.0, 0.0), (0.0, 0.0, 270.0, 90.0)),
        # Backwards in the plane, and upright.
        ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (180.0, 0.0, 0.0, 270.0)),
        ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (90.0, 90.0, 0.0, 0.0)),
    ],
)
def test_angles_of_circles_at_the_bounds_of_plane_and_shape(
    place: tuple[float, float, float],
    speed: tuple[float, float, float],
    expected: tuple[float, float, float, float],
) -> None:
    found = elements(state(place, speed))
    assert (found.axis, found.eccentricity) == pytest.approx((1.0, 0.0), abs=1e-11)
    turned = np.degrees((found.inclination, found.node, found.periapsis, found.anomaly))
    assert (turned - expected + 180.0) % 360.0 - 180.0 == pytest.approx(np.zeros(4), abs=1e-9)


@every(
    ("speed", "mu", "good"),
    [
        # A fall straight down, but for this much of momentum.
        (1e-12, 1.0, True),
        (0.99e-12, 1.0, False),
        # A parabola at 1 has half the square of the speed for mu; with these both energies are 1e-12.
        (2e-6, 1e-12, True),
        (2e-6, 3e-12, True),
        (2e-6, 1.01e-12, False),
        (2e-6, 2.99e-12, False),
    ],
)
def test_the_bounds_of_what_has_elements(speed: float, mu: float, *, good: bool) -> None:
    of = state((1.0, 0.0, 0.0), (0.0, speed, 0.0))
    if good:
        assert elements(of, mu).axis == pytest.approx(1.0 / (2.0 - speed**2 / mu))
    else:
        with pytest.raises(ValueError, match="parabola and a straight fall"):
            elements(of, mu)


@every(
    "given",
    [
        Elements(0.005, 0.3, 1.1, 1.0, 2.0, 3.0),
        # Far out on a hyperbola: 1 + e cos is 0.005.
        Elements(-2.0, 1.5, 0.3, 0.5, 1.0, math.acos(-0.995 / 1.5)),
    ],
)
def test_small_and_far_states_have_the_elements_that_they_are_made_of(given: Elements) -> None:
    for mu in (1.0, MU_EARTH):
        assert elements(state_of(given, mu), mu) == pytest.approx(given, rel=1e-9)


@every(
    ("wrong", "named"),
    [
        (Elements(2.0, 1.0, 0.1, 0.2, 0.3, 0.4), "a = 2, e = 1 and a body at 0.4 rad"),
        (Elements(-2.0, 0.5, 0.1, 0.2, 0.3, 0.4), "a = -2, e = 0.5 and a body at 0.4 rad"),
        # On the asymptote itself, and beyond it.
        (Elements(-2.0, -1.0 / math.cos(3.0), 0.1, 0.2, 0.3, 3.0), "a = -2, e = 1.01011 and a body at 3 rad"),
        (Elements(-2.0, 1.5, 0.1, 0.2, 0.3, 3.0), "a = -2, e = 1.5 and a body at 3 rad"),
    ],
)
def test_elements_of_no_orbit_are_named(wrong: Elements, named: str) -> None:
    with pytest.raises(ValueError, match=f"^no orbit has {named}$"):
        state_of(wrong)
