"""Disturbances of frames on a CAN bus with faults: sender, time, number, by chance or each.

Their effect on the bus is in `emulators.wires.faulty_can`.
"""

from dataclasses import dataclass
from enum import Enum

from numpy.random import Generator

from firmware_bridge.units import NEVER, Nanoseconds


class Effect(Enum):
    """Effect of a disturbance on a frame."""

    ERROR = "it is damaged on the bus, and ends in an error flag"
    LOSS = "it is lost between its sender and the bus, unnoticed"
    OVERRUN = "a receiver's controller has no room for it, and reports that"


@dataclass(frozen=True, slots=True)
class Disturbance:
    """Disturbance of frames from `begin` until `end`, at most of `count` of them.

    `sender` names the sender of those frames (None: every sender); `receiver` names the only station that
    sees them wrongly, as with a bad plug there (None: all do). Of the frames that it could meet it meets a
    `share`, which `generator` draws; a share of 1 draws nothing.
    """

    sender: str | None = None
    receiver: str | None = None
    begin: Nanoseconds = 0
    end: Nanoseconds = NEVER
    count: int | None = None
    effect: Effect = Effect.ERROR
    share: float = 1.0
    generator: Generator | None = None


class Standing:
    """A disturbance at work, and how many frames it may still meet."""

    __slots__ = ("left", "of", "what")

    def __init__(self, what: Disturbance, of: object = None) -> None:
        self.what = what
        self.of = of
        self.left = what.count

    def meets(self, sender: str, now: Nanoseconds) -> bool:
        """Return whether it meets a frame of this sender now, which counts; drawn again at every call."""
        what = self.what
        if what.sender not in (None, sender) or not what.begin <= now < what.end or self.left == 0:
            return False
        # A node does not receive its own frames: a bad plug there does not concern them.
        if what.receiver == sender:
            return False
        # Last: a frame that could not be met takes no random number.
        if what.share < 1.0 and what.generator is not None and what.generator.random() >= what.share:
            return False
        if self.left is not None:
            self.left -= 1
        return True
