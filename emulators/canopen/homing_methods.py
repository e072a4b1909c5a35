"""Homing methods of CiA 402, each as the moves that it is made of: one row for each number of 0x6098.

Source: CiA 402-2, homing mode. The shaft goes to a switch or into a stop fast (0x6099:1), and leaves it, or
looks for the index, slowly (0x6099:2). Where the last move ends, the reference lies. The standard draws where
each method ends and in which direction it begins, not every move: here the switch is always sought first, and
the edge is then approached slowly from the side that the index is sought to. A product makes its own table
of these rows, those that it has, and of its own.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum, IntEnum
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address


class Switch(IntEnum):
    """Switches at the shaft, by their bits in 0x60FD."""

    NEGATIVE_LIMIT = 0
    POSITIVE_LIMIT = 1
    HOME = 2

    @property
    def bit(self) -> int:
        """The bit, set where the switch is active."""
        return 1 << self


class Goal(Enum):
    """Event that ends a move."""

    CLOSED = "the switch is active; a move to it is left out where it is so already"
    OPEN = "the switch is left"
    INDEX = "the encoder's index is passed"
    STOP = "the current is beyond a limit, for the shaft cannot go on; a product's"


@dataclass(frozen=True, slots=True)
class HomingMove:
    """One move: with which sign, at the speed of which object, to what."""

    direction: int
    speed: Address
    goal: Goal
    switch: Switch | None = None
    turns_at: Switch | None = None
    """The limit switch at which the move goes on the other way, where the switch lies behind its start."""


def _at_edge(switch: Switch, first: int, *, far: bool, onto: bool, turns: bool) -> tuple[HomingMove, ...]:
    """Return the moves from anywhere to one edge of a switch.

    `first`: direction of the search, by its sign. `far`: the edge behind the switch, in that direction, not
    the one before it. `onto`: the edge is passed towards the active side, not away from it. `turns`: the
    search goes on the other way at the limit switch.
    """
    limit = (Switch.POSITIVE_LIMIT if first > 0 else Switch.NEGATIVE_LIMIT) if turns else None
    off = first if far else -first
    to = HomingMove(first, od.HOMING_SPEED_SWITCH, Goal.CLOSED, switch, limit)
    leave = HomingMove(off, od.HOMING_SPEED_ZERO, Goal.OPEN, switch)
    back = HomingMove(-off, od.HOMING_SPEED_ZERO, Goal.CLOSED, switch)
    return (to, leave, back) if onto else (to, leave)


INDEX_BELOW: Final = HomingMove(-1, od.HOMING_SPEED_ZERO, Goal.INDEX)
INDEX_ABOVE: Final = HomingMove(1, od.HOMING_SPEED_ZERO, Goal.INDEX)

NOTHING_TO_DO: Final = 0
"""The method that needs no homing."""
ACTUAL_POSITION: Final = 35
"""The method that takes the actual position for home; since CiA 402-2 v3 it is 37."""
ACTUAL_POSITION_NEW: Final = 37
WITHOUT_INDEX: Final = 16
"""Added to the number of a method, 1 to 14, that ends at the index."""


def _edges() -> Iterator[tuple[int, tuple[HomingMove, ...]]]:
    limits = (Switch.NEGATIVE_LIMIT, -1), (Switch.POSITIVE_LIMIT, 1)
    for number, (switch, first) in enumerate(limits, 1):
        yield number, _at_edge(switch, first, far=False, onto=False, turns=False)
    # A home switch that is active from its edge to the end of the way: positive, then negative.
    for number, first in ((3, 1), (5, -1)):
        for onto in (False, True):
            yield number + onto, _at_edge(Switch.HOME, first, far=False, onto=onto, turns=False)
    # A home switch in the middle of the way: each of its two edges, from each side.
    for number, first in ((7, 1), (11, -1)):
        for place, (far, onto) in enumerate(((False, False), (False, True), (True, True), (True, False))):
            yield number + place, _at_edge(Switch.HOME, first, far=far, onto=onto, turns=True)


def _methods() -> Iterator[tuple[int, tuple[HomingMove, ...]]]:
    yield NOTHING_TO_DO, ()
    for number, moves in _edges():
        yield number, (*moves, INDEX_ABOVE if moves[-1].direction > 0 else INDEX_BELOW)
        yield number + WITHOUT_INDEX, moves
    yield 33, (INDEX_BELOW,)
    yield 34, (INDEX_ABOVE,)
    yield from ((ACTUAL_POSITION, ()), (ACTUAL_POSITION_NEW, ()))


CIA_402: Final[Mapping[int, tuple[HomingMove, ...]]] = MappingProxyType(dict(sorted(_methods())))
"""The moves of each method, one after the other; 15, 16, 31, 32 and 36 are reserved."""
