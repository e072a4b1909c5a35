"""Campaigns: settings of any kind, random orders at random instants, and the hash of what became of them."""

import hashlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields
from typing import Final

import numpy as np

from emulators.servo.scaling import Settings
from hil_tests.unit.servo.side_by_side import COUNT, SANE, Leg, Order, Side

KINDS: Final = (0, 1, 1, 2, 2, 2, 3, 4, 5, 6, 7, 8, 8)
PLANNED_KINDS: Final = (0, 2, 4, 6, 7, 10, 10, 10, 11, 11, 12, 12, 12, 13, 13, 14, 15, 15)
Draw = Callable[[np.random.Generator], Settings]


def wild(draw: np.random.Generator) -> Settings:
    """Any values that the objects admit."""

    def number(low: int, high: int) -> int:
        return int(draw.integers(low, high + 1))

    widest = {
        "encoder_pulses": (16, 2_500_000),
        "max_speed": (0, 2**32 - 1),
        "following_error": (0, 2**32 - 1),
    }
    widest |= {
        "position_window": (0, 2**32 - 1),
        "velocity_window": (0, 2**32 - 1),
        "thermal_time": (1, 5400),
    }
    signed = ("current_p", "current_i", "velocity_p", "velocity_i", "position_p", "position_i", "position_d")
    values = {
        field.name: number(
            *widest.get(field.name, (-(2**15), 2**15 - 1) if field.name in signed else (0, 2**16 - 1))
        )
        for field in fields(Settings)
    }
    return Settings(**values)


def tame(draw: np.random.Generator) -> Settings:
    """Values with which the motors of the test turn well, near their limits and windows."""
    chosen = {
        "current_p": int(draw.integers(100, 250)),
        "velocity_p": int(draw.integers(300, 3000)),
        "position_p": int(draw.integers(50, 600)),
        "continuous_current": int(draw.integers(300, 6000)),
        "peak_current": int(draw.integers(300, 12_000)),
        "thermal_time": int(draw.integers(1, 10)),
        "following_error": int(draw.integers(20, 4000)),
        "position_window": int(draw.integers(0, 50)),
        "position_window_time": int(draw.integers(0, 20)),
        "velocity_window": int(draw.integers(0, 200)),
        "velocity_acceleration_forward": int(draw.integers(0, 3000)),
        "position_speed_forward": int(draw.integers(0, 3000)),
        "max_speed": int(draw.integers(100, 12_000)),
    }
    rest = {field.name: getattr(SANE, field.name) for field in fields(Settings) if field.name not in chosen}
    return Settings(**rest, **chosen)


def legs(draw: np.random.Generator, count: int, kinds: Sequence[int] = KINDS) -> Iterator[Leg]:
    """Random orders at random instants, in the midst of a ms, too."""
    for number in range(count):
        orders = []
        for axis in range(COUNT):
            if number == 0 or draw.random() < 0.3:
                kind = 0 if number == 0 else int(draw.choice(kinds))
                span = int(draw.choice((30, 3000, 300_000)))
                speeds = (int(draw.integers(-span, span + 1)), int(draw.integers(0, 6000)))
                up, down = (int(value) for value in draw.integers(100, 300_000, 2))
                orders.append(Order(axis, kind, speeds[0], speeds[1] - 3000, up, down))
        yield Leg(tuple(orders), int(draw.integers(1, 700)))


def digest(side: Side, seed: int, count: int) -> str:
    """Run a campaign on one side, and return the hash of all that happened."""
    running = hashlib.sha256()
    for leg in legs(np.random.default_rng(seed), count, KINDS + PLANNED_KINDS):
        events = side.lives(leg)
        running.update(repr(events).encode() + side.bits())
        if isinstance(events, str):
            break
    return running.hexdigest()
