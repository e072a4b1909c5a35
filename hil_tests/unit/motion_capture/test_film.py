"""A plant on film: its body at the exposures, though no one stops there; and chance that is drawn ahead."""

import math

import numpy as np
import pytest

from emulators.motion_capture.bodies import on_floor
from emulators.motion_capture.chance import AT_ONCE, Chance
from emulators.motion_capture.film import Film
from emulators.motion_capture.system import Timing
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

TIMING = Timing()


class Walking:
    """A plant that goes ahead at 1 m/s and turns at 1 rad/s, and wakes someone at some instants."""

    def __init__(self, *wakes: Nanoseconds) -> None:
        self.now: Nanoseconds = 0
        self.wakes = list(wakes)

    @property
    def outputs(self) -> tuple[float, ...]:
        seconds = to_seconds(self.now)
        return (math.nan, seconds, -seconds, 0.5 * seconds)

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        if self.wakes and self.wakes[0] <= until:
            self.now = self.wakes.pop(0)
            return self.now, ("someone",)
        self.now = until
        return until, ()


def film_of(walking: Walking) -> Film:
    return Film(walking, walking, ("else", "x", "y", "heading"), TIMING.exposed_at)


@pytest.mark.parametrize("strides", [(50,), (3, 9, 10, 50), tuple(range(51))])
def test_each_exposure_shows_its_own_instant_however_the_physics_is_requested(
    strides: tuple[int, ...],
) -> None:
    walking = Walking()
    film = film_of(walking)
    for stride in strides:
        assert film.advance(stride * MILLISECOND) == (stride * MILLISECOND, ())
        assert walking.now == stride * MILLISECOND
    for number in range(12):
        at = TIMING.exposed_at(number)
        seconds = to_seconds(at)
        assert film(at) == on_floor(seconds, -seconds, 0.5 * seconds)


def test_who_is_woken_is_woken_at_his_instant_and_no_exposure_is_lost() -> None:
    second = TIMING.exposed_at(2)
    walking = Walking(7 * MILLISECOND, second, second)
    film = film_of(walking)
    reached = []
    while (reported := film.advance(10 * MILLISECOND))[1]:
        reached.append(reported[0])
    assert reached == [7 * MILLISECOND, second, second]
    assert film(second).position[0] == to_seconds(second)
    assert walking.now == 10 * MILLISECOND


def test_between_two_exposures_the_one_before_is_shown_and_before_the_first_kept_that_one() -> None:
    film = film_of(Walking())
    film.advance(20 * MILLISECOND)
    assert film(TIMING.exposed_at(3) - 1) == film(TIMING.exposed_at(2))
    assert film(-1) == film(0)


def test_what_is_drawn_ahead_is_what_the_generator_gives_one_by_one() -> None:
    chance, generator = Chance(np.random.default_rng(5)), np.random.default_rng(5)
    for count in (7, 1, AT_ONCE - 11, 13, 3 * AT_ONCE, 2):
        assert chance.normals(count) == [float(generator.standard_normal()) for _ in range(count)]
