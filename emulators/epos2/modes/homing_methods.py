"""The homing methods of an EPOS2, each as the ways that it goes: one row for each number of 0x6098.

Source: EPOS Firmware Specification, homing mode (by analogy), as CiA 402 draws them. The shaft goes to a
switch or into a stop fast (0x6099:1), and leaves it, or looks for the index, slowly (0x6099:2). Where the
last way ends, the reference lies.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.wire.epos2.functions import InputFunction


class Goal(Enum):
    """Event that ends a move."""

    CLOSED = "the switch is active; a way to it is left out where it is so already"
    OPEN = "the switch is left"
    INDEX = "the encoder's index is passed"
    STOP = "the current is beyond 0x2080, for the shaft cannot go on"


@dataclass(frozen=True, slots=True)
class HomingWay:
    """One way: with which sign, at the speed of which object, to what."""

    direction: int
    speed: Address
    goal: Goal
    switch: InputFunction | None = None


def _to(switch: InputFunction, direction: int) -> HomingWay:
    return HomingWay(direction, od.HOMING_SPEED_SWITCH, Goal.CLOSED, switch)


def _off(switch: InputFunction, direction: int) -> HomingWay:
    return HomingWay(direction, od.HOMING_SPEED_ZERO, Goal.OPEN, switch)


_NEGATIVE: Final = InputFunction.NEGATIVE_LIMIT
_POSITIVE: Final = InputFunction.POSITIVE_LIMIT
_HOME: Final = InputFunction.HOME
_INDEX_BELOW: Final = HomingWay(-1, od.HOMING_SPEED_ZERO, Goal.INDEX)
_INDEX_ABOVE: Final = HomingWay(1, od.HOMING_SPEED_ZERO, Goal.INDEX)
_STOP_BELOW: Final = HomingWay(-1, od.HOMING_SPEED_SWITCH, Goal.STOP)
_STOP_ABOVE: Final = HomingWay(1, od.HOMING_SPEED_SWITCH, Goal.STOP)

NOTHING_TO_DO: Final = 0
"""The method that needs no homing. Assumed: the position counts as referenced where it is."""
ACTUAL_POSITION: Final = 35
"""The method that takes the actual position for home."""

METHODS: Final[Mapping[int, tuple[HomingWay, ...]]] = MappingProxyType(
    {
        -4: (_STOP_BELOW,),
        -3: (_STOP_ABOVE,),
        -2: (_STOP_BELOW, _INDEX_ABOVE),
        -1: (_STOP_ABOVE, _INDEX_BELOW),
        NOTHING_TO_DO: (),
        1: (_to(_NEGATIVE, -1), _off(_NEGATIVE, 1), _INDEX_ABOVE),
        2: (_to(_POSITIVE, 1), _off(_POSITIVE, -1), _INDEX_BELOW),
        7: (_to(_HOME, 1), _off(_HOME, -1), _INDEX_BELOW),
        11: (_to(_HOME, -1), _off(_HOME, 1), _INDEX_ABOVE),
        17: (_to(_NEGATIVE, -1), _off(_NEGATIVE, 1)),
        18: (_to(_POSITIVE, 1), _off(_POSITIVE, -1)),
        23: (_to(_HOME, 1), _off(_HOME, -1)),
        27: (_to(_HOME, -1), _off(_HOME, 1)),
        33: (_INDEX_BELOW,),
        34: (_INDEX_ABOVE,),
        ACTUAL_POSITION: (),
    }
)
"""The ways of each method, one after the other."""
