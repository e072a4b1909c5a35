"""A wire's chance draws what numpy's generator would draw, from the same stream."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.rewind import Rewind
from emulators.wires.chance import Chance

MOSTS = st.one_of(
    st.integers(0, 100),
    st.integers(0, 1 << 34),
    st.sampled_from([(1 << 31) - 1, 1 << 31, 3 << 30, (1 << 32) - 2, (1 << 32) - 1, 1 << 32]),
)


@given(st.integers(0, 1000), st.lists(MOSTS, min_size=1, max_size=40))
def test_it_draws_as_numpy_does(seed: int, mosts: list[int]) -> None:
    generator = np.random.default_rng(seed)
    chance = Chance(np.random.default_rng(seed))
    for most in mosts:
        assert chance.up_to(most) == generator.integers(0, most, endpoint=True)
        assert chance.share() == generator.random()


@pytest.mark.parametrize("most", [5, 3 << 30])
def test_every_number_is_as_likely(most: int) -> None:
    chance, draws = Chance(np.random.default_rng(0)), 20_000
    halves = sum(2 * chance.up_to(most) > most for _ in range(draws))
    assert halves == pytest.approx(draws / 2, abs=4 * (draws / 4) ** 0.5)


def test_it_goes_back_with_time() -> None:
    chance = Chance(np.random.default_rng(3))
    chance.up_to(10)  # leaves half of a word behind
    time = Rewind(chance)
    moment = time.snapshot()
    drawn = [chance.up_to(1000) for _ in range(5)]
    time.restore(moment)
    assert [chance.up_to(1000) for _ in range(5)] == drawn
