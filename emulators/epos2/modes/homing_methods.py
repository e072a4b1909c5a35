"""The EPOS2's homing methods: those of CiA 402 that it has, and maxon's own with a mechanical stop.

Source: EPOS Firmware Specification, homing mode (by analogy). A stop is met where the current is beyond
0x2080. The switches are functions of input pins, whose numbers are those of the bits of 0x60FD. No search
turns at a limit switch, which is a fault there. Assumed: with method 0 the position counts as referenced
where it is.
"""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Final

from emulators.canopen.homing_methods import CIA_402, INDEX_ABOVE, INDEX_BELOW, Goal, HomingMove
from firmware_bridge.canopen import objects as od

_STOP_BELOW: Final = HomingMove(-1, od.HOMING_SPEED_SWITCH, Goal.STOP)
_STOP_ABOVE: Final = HomingMove(1, od.HOMING_SPEED_SWITCH, Goal.STOP)

METHODS: Final[Mapping[int, tuple[HomingMove, ...]]] = MappingProxyType(
    {
        -4: (_STOP_BELOW,),
        -3: (_STOP_ABOVE,),
        -2: (_STOP_BELOW, INDEX_ABOVE),
        -1: (_STOP_ABOVE, INDEX_BELOW),
        **{
            number: tuple(replace(move, turns_at=None) for move in CIA_402[number])
            for number in (0, 1, 2, 7, 11, 17, 18, 23, 27, 33, 34, 35)
        },
    }
)
"""The moves of each method, one after the other."""
