"""What happens to a board, drawn at random: lines of a host that means it, and of one that does not.

simavr 1.6 has half of the chip's analog inputs, so nobody asks for the others.
"""

from collections.abc import Callable, Iterator
from random import Random
from typing import Final

from emulators.arduino_omni.mega.pins import ENCODER_PINS, FIRST_ANALOG, PINS
from emulators.arduino_omni.sketches.ros_arduino_bridge import PID_INTERVAL
from hil_tests.interop.simavr.twin import Bytes, Edges, Event, Level, Time, Voltage

WHEELS: Final = len(ENCODER_PINS)
ANALOG: Final = 8
RING: Final = 63
"""Bytes that a busy sketch keeps."""
TAKEN: Final = {0, 1, 20, 21, *(pin for pins in ENCODER_PINS for pin in pins)}
ODD: Final = (0, 1, -1, 255, 256, -255, 300, 32767, -32768, 32768, 65535, 99999, -40000)


def number(random: Random) -> int:
    """Return one that an int can hold or just not, small ones more often."""
    drawn = random.random()
    if drawn < 0.6:
        return random.randint(-60, 60)
    return random.choice(ODD) if drawn < 0.8 else random.randint(-70_000, 70_000)


def pin(random: Random) -> int:
    """Return a pin, or the number of none."""
    return random.randrange(PINS + 8)


def numbers(random: Random, count: int, between: str = " ") -> str:
    """Return some, as many as are asked for, or now and then not."""
    if random.random() < 0.1:
        count = random.randrange(6)
    return between.join(str(number(random)) for _ in range(count))


def gains(random: Random) -> str:
    """Return what follows a `u`: near the sketch's own, or anything; Ko 0 among them."""
    if random.random() < 0.5:
        return f"{random.randint(0, 40)}:{random.randint(0, 30)}:{random.randint(0, 5)}:{random.randint(1, 60)}"
    return numbers(random, 4, random.choice((":", ":", "::", " ")))


def noise(random: Random) -> bytes:
    """Return bytes of any kind, or of those that lines are made of."""
    count = random.randrange(24)
    if random.random() < 0.5:
        return random.randbytes(count)
    return bytes(random.choices(b"bcdemorstuwxz0123456789:- \n\t\0+", k=count))


SAID: Final[tuple[tuple[int, Callable[[Random], str]], ...]] = (
    (8, lambda it: f"m {numbers(it, WHEELS)}"),
    (2, lambda _: "m 0 0 0"),
    (4, lambda it: f"o {numbers(it, WHEELS)}"),
    (6, lambda _: "e"),
    (1, lambda _: "r"),
    (3, lambda it: f"u {gains(it)}"),
    (1, lambda _: "b"),
    (2, lambda it: f"a {it.choice((0, FIRST_ANALOG, 256, 70)) + it.randrange(ANALOG - 2)}"),
    (3, lambda it: f"c {pin(it)} {it.choice((0, 1, 1, 2, -1))}"),
    (4, lambda it: f"d {pin(it)}"),
    (3, lambda it: f"w {pin(it)} {it.choice((0, 1, 1, 2, 257))}"),
    (2, lambda it: f"x {pin(it)} {it.choice((0, 1, 127, 128, 255, 256, -1, number(it)))}"),
    (1, lambda it: f"p {pin(it)}"),
    (1, lambda it: f"{it.choice('stzE~')} {numbers(it, 2)}"),
)
WEIGHTS: Final = [row[0] for row in SAID]


def line(random: Random) -> bytes:
    """Return one, with its end."""
    if random.random() < 0.12:
        return noise(random) + b"\r"
    ((_, said),) = random.choices(SAID, WEIGHTS)
    return said(random).encode() + b"\r"


def around(random: Random) -> Iterator[Event]:
    """Yield what happens that the host has no part in, before it speaks again."""
    for wheel in range(WHEELS):
        if random.random() < 0.4:
            yield Edges(wheel, random.randint(-45, 45) if random.random() < 0.95 else random.randint(-999, 999))
    if random.random() < 0.15:
        free = [it for it in range(PINS) if it not in TAKEN]
        yield Level(random.choice(free), random.random() < 0.5)
    if random.random() < 0.1:
        yield Voltage(random.randrange(ANALOG), random.randrange(1024))


def happening(seed: int, lines: int) -> Iterator[Event]:
    """Yield as many lines, and all that happens between them."""
    random = Random(seed)  # noqa: S311 - nothing is secret
    millis = said = 0
    while said < lines:
        yield from around(random)
        if random.random() < 0.6:
            steps = (1, PID_INTERVAL, PID_INTERVAL, PID_INTERVAL, PID_INTERVAL + 1, 120, 499, 501)
            millis += random.choice(steps)
            yield Time(millis)
        count = 1 if random.random() < 0.8 else random.randint(2, 4)
        together = b"".join(line(random) for _ in range(count))
        if random.random() < 0.01:  # while it listens for an echo, the ring runs over
            together = b"p 30\r" + b"e\r" * random.randint(20, 45)
        elif len(together) > RING:
            continue
        said += together.count(b"\r")
        yield Bytes(together)
