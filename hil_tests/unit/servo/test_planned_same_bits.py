"""Planned demands in both kernels: the same bits over millions of ticks; a planted difference is caught."""

import ctypes
import shutil
from pathlib import Path

import numpy as np
import pytest

from emulators.servo import kernel
from emulators.servo.axis import ELECTRONIC_GEAR, MOVE, PROFILE_DONE, RAMP, SINE, SPLINE, TARGET_REACHED
from hil_tests.unit.servo.campaign import PLANNED_KINDS, Draw, legs, tame, wild
from hil_tests.unit.servo.side_by_side import (
    COUNT,
    KERNEL,
    SANE,
    TWIN,
    Leg,
    Motors,
    Order,
    Side,
    compiled,
    difference,
)

TICKS = {"few": 150_000, "many": 1_500_000}
"""Ticks of single axes, for each way of drawing."""


@pytest.mark.long(keeps=["few-tame"])
@pytest.mark.parametrize("draw", [tame, wild])
@pytest.mark.parametrize("much", TICKS)
def test_planned_demands_agree_to_the_bit(
    plant_library: ctypes.CDLL, native: kernel.Found, draw: Draw, much: str
) -> None:
    ticks, seed, seen, done = 0, 1000, set(), 0
    while ticks < TICKS[much]:
        raw = tuple(draw(np.random.default_rng([seed, axis])) for axis in range(COUNT))
        twin, one = (Side(Motors(plant_library, seed=seed), raw, found) for found in (TWIN, native))
        for leg in legs(np.random.default_rng(seed), 60, PLANNED_KINDS):
            events = twin.lives(leg)
            assert events == one.lives(leg)
            assert not difference(twin, one)
            ticks += leg.ticks * COUNT
            for axis in one.axes:
                seen.add((axis.profile, axis.shape))
                done |= axis.flags
            if isinstance(events, str):
                break
        seed += 1
    assert seen >= {(MOVE, SINE), (RAMP, SINE), (SPLINE, 0), (ELECTRONIC_GEAR, 0)}
    assert done & (PROFILE_DONE | TARGET_REACHED) == PROFILE_DONE | TARGET_REACHED


PLANTED = [
    ("sine.h", "rest = SINE_5 -", "rest = SINE_5 + 65536 -", 10),
    ("sine.h", "2 * at < length", "2 * at <= length + 2", 10),
    ("sine.h", "following += 1;", "following += 0;", 10),
    ("spline.h", "floor_division(gone * at, length);\n    speed", "(gone * at / length);\n    speed", 12),
    ("spline.h", "axis->call = 1;", "axis->call = 0;", 12),
    ("electronic_gear.h", "counted - whole * axis->gear_denominator", "0", 13),
    ("electronic_gear.h", "value + axis->analogue_offset", "value + axis->analogue_offset + 1", 14),
]


@pytest.mark.long(keeps=["sine.h-following += 1;-following += 0;-10"])
@pytest.mark.parametrize(("file", "right", "wrong", "kind"), PLANTED)
def test_a_planted_difference_is_caught(  # noqa: PLR0917 - a row of the table, and its fixtures
    tmp_path: Path, plant_library: ctypes.CDLL, file: str, right: str, wrong: str, kind: int
) -> None:
    folder = tmp_path / "native"
    shutil.copytree(KERNEL[0].parent, folder)
    source = (folder / file).read_text(encoding="ascii")
    assert source.count(right) == 1
    (folder / file).write_text(source.replace(right, wrong), encoding="ascii")
    planted = kernel.load(compiled(tmp_path, [folder / path.name for path in KERNEL], "-O2"))
    twin, one = (Side(Motors(plant_library), (SANE,) * COUNT, found) for found in (TWIN, planted))
    power = Leg(tuple(Order(axis, 0, 0, 0, 1000, 1000) for axis in range(COUNT)), 30)
    begins = Leg(tuple(Order(axis, kind, -4001 - axis, 997, 30_001, 20_011) for axis in range(COUNT)), 300)
    turns = Leg(tuple(Order(axis, 15, 49_993, 0, 1, 1) for axis in range(COUNT)), 2000)
    found = ""
    for leg in (power, begins, turns, turns):
        if twin.lives(leg) != one.lives(leg) or difference(twin, one):
            found = difference(twin, one) or "an event"
    assert found


def test_without_a_plant_there_is_no_difference(plant_library: ctypes.CDLL, native: kernel.Found) -> None:
    # What the planted ones are held against.
    for kind in (10, 12, 13, 14):
        twin, one = (Side(Motors(plant_library), (SANE,) * COUNT, found) for found in (TWIN, native))
        for leg in (
            Leg(tuple(Order(axis, 0, 0, 0, 1000, 1000) for axis in range(COUNT)), 30),
            Leg(tuple(Order(axis, kind, -4001 - axis, 997, 30_001, 20_011) for axis in range(COUNT)), 300),
            Leg(tuple(Order(axis, 15, 49_993, 0, 1, 1) for axis in range(COUNT)), 4000),
        ):
            assert twin.lives(leg) == one.lives(leg)
            assert not difference(twin, one)
