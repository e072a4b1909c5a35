"""Reference and kernel record the same numbers at the same ticks, whatever happens meanwhile."""

import ctypes

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from emulators.servo import kernel
from emulators.servo.record import FIELDS
from emulators.servo.recorder import Recorder
from hil_tests.lanes import examples
from hil_tests.unit.servo.campaign import legs
from hil_tests.unit.servo.side_by_side import COUNT, REFERENCE, SANE, Leg, Motors, Order, Side, difference


def recorded(side: Side) -> list[tuple[object, ...]]:
    """Return all that the recorders hold, but for the addresses of their memory."""
    numbers = [field[0] for field in Recorder._fields_ if field[1] is ctypes.c_int64]
    return [
        (*(getattr(axis.recorder, name) for name in numbers), bytes(axis.recorder.numbers))
        for axis in side.axes
    ]


@settings(max_examples=examples(25), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    seed=st.integers(0, 2**16),
    sources=st.lists(st.sampled_from(FIELDS), min_size=1, max_size=4).map(tuple),
    capacity=st.integers(1, 128),
    period=st.integers(1, 40),
    share=st.floats(0, 1),
    triggers=st.integers(0, 15),
)
def test_both_record_the_same(
    *,
    plant_library: ctypes.CDLL,
    native: kernel.KernelLibrary,
    seed: int,
    sources: tuple[str, ...],
    capacity: int,
    period: int,
    share: float,
    triggers: int,
) -> None:
    sides = [Side(Motors(plant_library, seed=seed), (SANE,) * COUNT, each) for each in (REFERENCE, native)]
    for number, leg in enumerate(legs(np.random.default_rng(seed), 8)):
        for side in sides:
            if number == 2:
                for axis in side.axes[:3]:
                    axis.recorder.triggers = triggers
                    preceding = int(share * capacity)
                    axis.recorder.start(axis, sources, capacity=capacity, period=period, preceding=preceding)
            if number == 5:
                side.axes[1].pins ^= 2
                side.axes[2].recorder.trigger()
        events = sides[0].lives(leg)
        assert events == sides[1].lives(leg)
        assert not difference(*sides)
        assert recorded(sides[0]) == recorded(sides[1])
        if isinstance(events, str):
            return


def test_a_recorder_that_is_off_changes_nothing(
    plant_library: ctypes.CDLL, native: kernel.KernelLibrary
) -> None:
    on, off = (Side(Motors(plant_library), (SANE,) * COUNT, native) for _ in range(2))
    on.axes[0].recorder.start(on.axes[0], ("position",), capacity=8, period=3, preceding=0)
    power = Leg(tuple(Order(axis, kind, 0, 900, 900, 900) for axis in range(COUNT) for kind in (0, 1)), 500)
    on.runs(power)
    off.runs(power)
    on.axes[0].recording = 0
    assert not difference(on, off)
    assert list(on.axes[0].recorder.numbers[:3]) != [0, 0, 0]
