"""Random events of a board: lines of a host that follows the protocol, and of one that does not.

simavr 1.6 has half of the chip's analog inputs, so the others are not read.
"""

from collections.abc import Callable, Iterator
from typing import Final

from numpy.random import Generator, default_rng

from emulators.arduino_omni.mega.pins import ENCODER_PINS, FIRST_ANALOG, PINS
from emulators.arduino_omni.sketches.ros_arduino_bridge import PID_INTERVAL
from hil_tests.interop.simavr.comparison import Bytes, Edges, Event, Level, Time, Voltage

WHEELS: Final = len(ENCODER_PINS)
ANALOG: Final = 8
RING: Final = 63
"""Capacity of a busy sketch in bytes."""
TAKEN: Final = {0, 1, 20, 21, *(pin for pins in ENCODER_PINS for pin in pins)}
FREE: Final = tuple(it for it in range(PINS) if it not in TAKEN)
ODD: Final = (0, 1, -1, 255, 256, -255, 300, 32767, -32768, 32768, 65535, 99999, -40000)
SIGNS: Final = b"bcdemorstuwxz0123456789:- \n\t\0+"
STEPS: Final = (1, PID_INTERVAL, PID_INTERVAL, PID_INTERVAL, PID_INTERVAL + 1, 120, 499, 501)
"""ms from one thing to the next."""


class Dice:
    """Throws."""

    def __init__(self, seed: int) -> None:
        self._random: Final[Generator] = default_rng(seed)

    def chance(self, share: float) -> bool:
        """Return True in that share of all cases."""
        return bool(self._random.random() < share)

    def between(self, low: int, high: int) -> int:
        """Return one of these, both ends among them."""
        return int(self._random.integers(low, high, endpoint=True))

    def one(self, *these: int) -> int:
        """Return one of these."""
        return these[self.between(0, len(these) - 1)]

    def number(self) -> int:
        """Return one that an int can hold or just not, small ones more often."""
        if self.chance(0.6):
            return self.between(-60, 60)
        return self.one(*ODD) if self.chance(0.5) else self.between(-70_000, 70_000)

    def pin(self) -> int:
        """Return a pin, or the number of none."""
        return self.between(0, PINS + 7)

    def numbers(self, count: int, between: str = " ") -> str:
        """Return the requested number of numbers, or now and then another one."""
        if self.chance(0.1):
            count = self.between(0, 5)
        return between.join(str(self.number()) for _ in range(count))

    def gains(self) -> str:
        """Return what follows a `u`: near the sketch's own, or anything; Ko 0 among them."""
        if self.chance(0.5):
            ends = ((0, 40), (0, 30), (0, 5), (1, 60))
            return ":".join(str(self.between(*it)) for it in ends)
        return self.numbers(4, (":", "::", " ")[self.between(0, 2)])

    def noise(self) -> bytes:
        """Return bytes of any kind, or of those that lines are made of."""
        count = self.between(0, 23)
        if self.chance(0.5):
            return self._random.bytes(count)
        return bytes(self.one(*SIGNS) for _ in range(count))


STATED: Final[tuple[tuple[int, Callable[[Dice], str]], ...]] = (
    (8, lambda it: f"m {it.numbers(WHEELS)}"),
    (2, lambda _: "m 0 0 0"),
    (4, lambda it: f"o {it.numbers(WHEELS)}"),
    (6, lambda _: "e"),
    (1, lambda _: "r"),
    (3, lambda it: f"u {it.gains()}"),
    (1, lambda _: "b"),
    (2, lambda it: f"a {it.one(0, FIRST_ANALOG, 256, 70) + it.between(0, ANALOG - 3)}"),
    (3, lambda it: f"c {it.pin()} {it.one(0, 1, 1, 2, -1)}"),
    (4, lambda it: f"d {it.pin()}"),
    (3, lambda it: f"w {it.pin()} {it.one(0, 1, 1, 2, 257)}"),
    (2, lambda it: f"x {it.pin()} {it.one(0, 1, 127, 128, 255, 256, -1, it.number())}"),
    (1, lambda it: f"p {it.pin()}"),
    (1, lambda it: f"{chr(it.one(*b'stzE~'))} {it.numbers(2)}"),
)
WEIGHED: Final = tuple(place for place, (weight, _) in enumerate(STATED) for _ in range(weight))


def line(dice: Dice) -> bytes:
    """Return one, with its end."""
    if dice.chance(0.12):
        return dice.noise() + b"\r"
    _, stated = STATED[dice.one(*WEIGHED)]
    return stated(dice).encode() + b"\r"


def around(dice: Dice) -> Iterator[Event]:
    """Yield what happens that the host has no part in, before it speaks again."""
    for wheel in range(WHEELS):
        if dice.chance(0.4):
            yield Edges(wheel, dice.between(-45, 45) if dice.chance(0.95) else dice.between(-999, 999))
    if dice.chance(0.15):
        yield Level(dice.one(*FREE), dice.chance(0.5))
    if dice.chance(0.1):
        yield Voltage(dice.between(0, ANALOG - 1), dice.between(0, 1023))


def happening(seed: int, lines: int) -> Iterator[Event]:
    """Yield as many lines, and all that happens between them."""
    dice = Dice(seed)
    millis = stated = 0
    while stated < lines:
        yield from around(dice)
        if dice.chance(0.6):
            millis += dice.one(*STEPS)
            yield Time(millis)
        count = 1 if dice.chance(0.8) else dice.between(2, 4)
        together = b"".join(line(dice) for _ in range(count))
        if dice.chance(0.01):  # while it listens for an echo, the ring runs over
            together = b"p 30\r" + b"e\r" * dice.between(20, 45)
        elif len(together) > RING:
            continue
        stated += together.count(b"\r")
        yield Bytes(together)
