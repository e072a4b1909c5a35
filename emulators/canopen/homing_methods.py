"""Homing methods of CiA 402, each as the moves that it is made of: one row for each number of 0x6098.

Source: CiA 402-2, homing mode. The shaft goes to a switch or into a stop fast (0x6099:1), and leaves it, or
looks for the index, slowly (0x6099:2). Where the last move ends, the reference lies. A product makes its own
table of these rows, those that it has, and of its own.
"""

from collections.abc import Mapping
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


def _to(switch: Switch, direction: int) -> HomingMove:
    return HomingMove(direction, od.HOMING_SPEED_SWITCH, Goal.CLOSED, switch)


def _off(switch: Switch, direction: int) -> HomingMove:
    return HomingMove(direction, od.HOMING_SPEED_ZERO, Goal.OPEN, switch)


_NEGATIVE: Final = Switch.NEGATIVE_LIMIT
_POSITIVE: Final = Switch.POSITIVE_LIMIT
_HOME: Final = Switch.HOME
INDEX_BELOW: Final = HomingMove(-1, od.HOMING_SPEED_ZERO, Goal.INDEX)
INDEX_ABOVE: Final = HomingMove(1, od.HOMING_SPEED_ZERO, Goal.INDEX)

NOTHING_TO_DO: Final = 0
"""The method that needs no homing."""
ACTUAL_POSITION: Final = 35
"""The method that takes the actual position for home."""

CIA_402: Final[Mapping[int, tuple[HomingMove, ...]]] = MappingProxyType(
    {
        NOTHING_TO_DO: (),
        1: (_to(_NEGATIVE, -1), _off(_NEGATIVE, 1), INDEX_ABOVE),
        2: (_to(_POSITIVE, 1), _off(_POSITIVE, -1), INDEX_BELOW),
        7: (_to(_HOME, 1), _off(_HOME, -1), INDEX_BELOW),
        11: (_to(_HOME, -1), _off(_HOME, 1), INDEX_ABOVE),
        17: (_to(_NEGATIVE, -1), _off(_NEGATIVE, 1)),
        18: (_to(_POSITIVE, 1), _off(_POSITIVE, -1)),
        23: (_to(_HOME, 1), _off(_HOME, -1)),
        27: (_to(_HOME, -1), _off(_HOME, 1)),
        33: (INDEX_BELOW,),
        34: (INDEX_ABOVE,),
        ACTUAL_POSITION: (),
    }
)
"""The moves of each method, one after the other; methods without a row are not described here."""
