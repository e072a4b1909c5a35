"""The kernel in C and its reference in Python do the same, to the bit; a planted difference is found."""

import ctypes
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from emulators.servo import kernel
from emulators.servo.axis import (
    AT_REST,
    CURRENT_LIMITED,
    ELECTRONIC_GEAR,
    FOLLOWING_ERROR,
    MOVE,
    PROFILE_DONE,
    RAMP,
    SINE,
    SPLINE,
    TARGET_REACHED,
    UNDER_VOLTAGE,
)
from hil_tests.lanes import examples
from hil_tests.unit.servo.campaign import KINDS, PLANNED_KINDS, Draw, digest, legs, tame, wild
from hil_tests.unit.servo.side_by_side import (
    COMPILERS,
    COUNT,
    KERNEL,
    REFERENCE,
    SANE,
    Leg,
    Motors,
    Order,
    Side,
    compiled,
    difference,
)

TICKS = {"few": 300_000, "many": 3_500_000}
"""Ticks of single axes, for each way of drawing."""


Pair = Callable[..., tuple[Side, Side]]


@pytest.fixture(scope="session")
def pair(plant_library: ctypes.CDLL, native: kernel.KernelLibrary) -> Pair:
    def make(draw: Draw = tame, seed: int = 0, fmi: int = 3, noise: float = 0.02) -> tuple[Side, Side]:
        raw = [draw(np.random.default_rng([seed, axis])) for axis in range(COUNT)]
        reference, one = (
            Side(Motors(plant_library, fmi, seed=seed, noise=noise), tuple(raw), found)
            for found in (REFERENCE, native)
        )
        assert (reference.bank.native, one.bank.native) == (False, True)
        return reference, one

    return make


@pytest.mark.long(keeps=["tame-few"])
@pytest.mark.parametrize("much", TICKS)
@pytest.mark.parametrize("draw", [tame, wild])
def test_millions_of_ticks_agree_to_the_bit(pair: Pair, draw: Draw, much: str) -> None:
    ticks, seed, seen, shapes = 0, 0, 0, set()
    while ticks < TICKS[much]:
        reference, one = pair(draw, seed, fmi=2 + seed % 2, noise=(0.0, 0.02, 0.2)[seed % 3])
        for leg in legs(np.random.default_rng(seed), 60, KINDS + PLANNED_KINDS):
            events = reference.lives(leg)
            assert events == one.lives(leg)
            assert not difference(reference, one)
            ticks += leg.ticks * COUNT
            for axis in one.axes:
                seen |= axis.flags
                shapes.add((axis.profile, axis.shape))
            if isinstance(events, str):
                break
        seed += 1
    everything = AT_REST | CURRENT_LIMITED | FOLLOWING_ERROR | TARGET_REACHED | PROFILE_DONE
    assert much == "few" or seen & everything == everything
    assert shapes >= {(MOVE, SINE), (RAMP, SINE), (SPLINE, 0), (ELECTRONIC_GEAR, 0)}


ORDERS = st.builds(
    Order,
    axis=st.integers(0, COUNT - 1),
    kind=st.sampled_from(sorted({*KINDS, *PLANNED_KINDS})),
    value=st.integers(-(2**31), 2**31 - 1),
    speed=st.integers(-30_000, 30_000),
    up=st.integers(0, 2**32 - 1),
    down=st.integers(0, 2**32 - 1),
)
LIVES = st.lists(
    st.builds(Leg, st.lists(ORDERS, max_size=4).map(tuple), st.integers(1, 60)), min_size=1, max_size=12
)


JUMPS: Final = Leg(
    (*(Order(0, kind, 0, 0, 0, 0) for kind in (5, 0, 0)), Order(0, 12, 19_559_216, 0, 0, 0)), 18
)
"""A spline there and back in 1 ms: its acceleration by the gain for it was more than 63 bits."""


@settings(max_examples=examples(60), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(life=LIVES, seed=st.integers(0, 2**16), draw=st.sampled_from((tame, wild)))
@example(life=[JUMPS], seed=9, draw=wild)
def test_whatever_is_ordered_both_obey_alike(pair: Pair, life: list[Leg], seed: int, draw: Draw) -> None:
    reference, one = pair(draw, seed)
    power = Leg(tuple(Order(axis, 0, 0, 0, 1000, 1000) for axis in range(COUNT)), 3)
    for leg in (power, *life):
        events = reference.lives(leg)
        assert events == one.lives(leg)
        assert not difference(reference, one)
        if isinstance(events, str):
            break


@pytest.mark.parametrize("draw", [tame, wild])
def test_how_a_run_is_cut_into_advances_makes_no_difference(pair: Pair, draw: Draw) -> None:
    whole, cut = (pair(draw, 5)[1] for _ in range(2))
    for leg in legs(np.random.default_rng(5), 20):
        refused = isinstance(whole.lives(leg), str)
        for tick in range(leg.ticks):
            if isinstance(cut.lives(Leg(() if tick else leg.orders, 1)), str):
                break
        assert not difference(whole, cut)
        if refused:
            break


def turning() -> tuple[Leg, ...]:
    """All axes on their way to a position, then some more time."""
    orders = tuple(Order(axis, kind, 40_000, 2000, 3000, 3000) for axis in range(COUNT) for kind in (0, 2))
    return Leg(orders, 155), Leg((), 1000)


GAINS = ("current_p", "current_i", "position_p", "position_i", "position_d")


@pytest.mark.parametrize("gain", GAINS)
def test_one_bit_in_a_gain_is_caught(
    plant_library: ctypes.CDLL, native: kernel.KernelLibrary, gain: str
) -> None:
    planted = replace(SANE, **{gain: getattr(SANE, gain) ^ 1})
    reference = Side(Motors(plant_library), (SANE,) * COUNT, REFERENCE)
    one = Side(Motors(plant_library), (SANE, planted, SANE, SANE), native)
    for leg in turning():
        reference.runs(leg)
        one.runs(leg)
    # The gain itself differs, of course; what counts is what it led to.
    led_to = [(axis.current_average, axis.position_integral, axis.encoder) for axis in one.axes]
    expected = [(axis.current_average, axis.position_integral, axis.encoder) for axis in reference.axes]
    assert [a == b for a, b in zip(led_to, expected, strict=True)] == [True, False, True, True]
    assert difference(reference, one).startswith("axis1.")


def test_an_order_that_comes_one_tick_late_is_caught(pair: Pair) -> None:
    reference, one = pair(lambda _: SANE)
    begin = turning()[0]
    order = (Order(2, 1, 0, -500, 900, 900),)
    # Tick 160 begins a ms: what is ordered before it counts in this ms, what comes after it in the next.
    for side, at in ((reference, 160), (one, 161)):
        side.runs(replace(begin, ticks=at))
        side.runs(Leg(order, 300 - at))
    assert reference.bank.now == one.bank.now
    assert difference(reference, one).startswith("axis2.")


def test_an_event_comes_at_its_exact_tick_and_names_its_axis(pair: Pair) -> None:
    reference, one = pair(lambda _: SANE, noise=0.0)
    for side in (reference, one):
        side.runs(Leg((), 600))
        side.axes[3].call = 1
        # The call is received in the next ms, and reported when the tick that received it is over.
        assert side.bank.advance(side.bank.now + 95 * 100_000) == (60_100_000, ("axis3",))
    assert not difference(reference, one)


def test_an_empty_battery_is_an_event_in_both(pair: Pair) -> None:
    reference, one = pair(lambda _: SANE)
    for side in (reference, one):
        side.runs(Leg((), 1200))
        side.plant.breaks(at=1205, failing=4, replaced=3, replacement=8.0)
        assert side.bank.advance(10**9) == (121_100_000, tuple(f"axis{k}" for k in range(COUNT)))
        assert all(axis.flags & UNDER_VOLTAGE for axis in side.axes)
    assert not difference(reference, one)


BUILDS = [(compiler, level) for compiler in COMPILERS for level in ("-O0", "-O1", "-O2", "-O3")]


@pytest.fixture(scope="session")
def reference(plant_library: ctypes.CDLL, native: kernel.KernelLibrary) -> dict[Draw, str]:
    return {draw: _digest(plant_library, native, draw) for draw in (tame, wild)}


def _digest(plant: ctypes.CDLL, found: kernel.KernelLibrary, draw: Draw) -> str:
    raw = tuple(draw(np.random.default_rng([3, axis])) for axis in range(COUNT))
    return digest(Side(Motors(plant, seed=3), raw, found), 3, 150)


@pytest.mark.long(keeps=["/usr/bin/gcc--O3"])
@pytest.mark.parametrize(("compiler", "level"), BUILDS)
def test_every_compiler_and_level_gives_the_same_bits(
    compiler: str,
    level: str,
    tmp_path: Path,
    plant_library: ctypes.CDLL,
    reference: dict[Draw, str],
) -> None:
    found = kernel.load(compiled(tmp_path, KERNEL, level, compiler=compiler))
    for draw, expected in reference.items():
        assert _digest(plant_library, found, draw) == expected


def test_no_arithmetic_of_the_kernel_is_undefined(
    tmp_path: Path, plant_library: ctypes.CDLL, reference: dict[Draw, str]
) -> None:
    # Every overflow, shift and cast that C leaves undefined would end this process here.
    flags = ("-O1", "-fsanitize=undefined,float-cast-overflow", "-fsanitize-undefined-trap-on-error")
    found = kernel.load(compiled(tmp_path, KERNEL, *flags))
    assert found.library is not None, found.reason
    for draw, expected in reference.items():
        assert _digest(plant_library, found, draw) == expected
