"""A two-line element set: the report's own numbers, its units, and what is no such set."""

import math
import sys

import pytest

from firmware_bridge.motion.orbit import period, propagated
from firmware_bridge.motion.orbit_tle import state_of_tle

FIVE = (
    "1 00005U 58002B   00179.78495062  .00000023  00000-0  28098-4 0  4753",
    "2 00005  34.2682 348.7242 1859667 331.7664  19.3264 10.82419157413667",
)
"""Vanguard 1, the first set of AIAA 2006-6753."""
RADIUS_KM, MU = 6378.135, 398600.8
TU_S = math.sqrt(RADIUS_KM**3 / MU)


@pytest.mark.parametrize(
    ("minutes", "place_km", "speed_km_s"),
    [
        (0.0, (7022.46529266, -1400.08296755, 0.03995155), (1.893841015, 6.405893759, 4.534807250)),
        (360.0, (-7154.03120202, -3783.17682504, -3536.19412294), (4.741887409, -4.151817765, -2.093935425)),
    ],
)
def test_it_states_what_the_report_has_printed(
    minutes: float, place_km: tuple[float, ...], speed_km_s: tuple[float, ...]
) -> None:
    found = state_of_tle(*FIVE, minutes) if minutes else state_of_tle(*FIVE)
    assert [it * RADIUS_KM for it in found.place] == pytest.approx(place_km, abs=1e-6)
    assert [it * RADIUS_KM / TU_S for it in found.speed] == pytest.approx(speed_km_s, abs=1e-8)


def test_two_bodies_go_on_as_the_set_does_for_a_while() -> None:
    begin = state_of_tle(*FIVE)
    turn_min = period(begin) * TU_S / 60.0
    assert turn_min == pytest.approx(1440.0 / 10.82419157, rel=2e-3), "mean motion, in turns a day"
    by_set, by_two = state_of_tle(*FIVE, 10.0), propagated(begin, 600.0 / TU_S)
    assert math.dist(by_set.place, by_two.place) * RADIUS_KM < 5.0


@pytest.mark.parametrize(
    ("first", "second", "states"),
    [
        (FIVE[0][:-1], FIVE[1], "line 1 of"),
        (FIVE[0][:-1] + "4", FIVE[1], "the sum of its digits"),
        (FIVE[1], FIVE[0], "line 1 of"),
        (FIVE[0], FIVE[1].replace("34.2682", "34.2683"), "line 2 of"),
        ("", "", "line 1 of"),
    ],
)
def test_what_is_no_set_is_refused(first: str, second: str, states: str) -> None:
    with pytest.raises(ValueError, match=states):
        state_of_tle(first, second)


def test_a_body_that_has_come_down_is_reported() -> None:
    falls = (
        "1 28872U 05037B   05333.02012661  .25992681  00000-0  24476-3 0  1534",
        "2 28872  96.4736 157.9986 0303955 244.0492 110.6523 16.46015938 10708",
    )
    with pytest.raises(ValueError, match=r"cannot be computed then: .*decayed"):
        state_of_tle(*falls, 60.0)


def test_without_the_library_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sgp4.api", None)
    with pytest.raises(ValueError, match=r"pip install 'firmware-bridge\[orbit\]'"):
        state_of_tle(*FIVE)


def test_each_line_of_each_set_has_its_length() -> None:
    """The last digit twice: it is still the sum of those that count."""
    first, second = FIVE
    for _ in range(2):
        state_of_tle(first, second)
        with pytest.raises(ValueError, match="line 1 of"):
            state_of_tle(first + first[-1], second)
        for _ in range(2):
            with pytest.raises(ValueError, match="line 2 of"):
                state_of_tle(first, second + second[-1])
