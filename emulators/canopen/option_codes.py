"""Option codes of CiA 402: reactions to a fault and to a lost connection, ramps before the power goes.

Source: CiA 402-2, 0x6007, 0x605B, 0x605C and 0x605E. A product takes the rows that it has, and adds its own.
"""

from collections.abc import Mapping
from enum import Enum
from types import MappingProxyType
from typing import Final

from emulators.canopen.power_states import RampOption
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address


class ErrorReaction(Enum):
    """Reactions by which the motor is stopped before the fault state."""

    NONE = "only reported"
    DISABLE = "power stage off at once"
    SLOW_DOWN = "ramp with 0x6084, then off"
    QUICK_STOP = "ramp with 0x6085, then off"


RAMP_OPTIONS: Final[Mapping[RampOption, Address]] = MappingProxyType(
    {RampOption.SHUTDOWN: od.SHUTDOWN_OPTION, RampOption.DISABLE: od.DISABLE_OPTION}
)
"""Objects that select a slow-down before the power stage is switched off: 1."""
DECELERATIONS: Final[Mapping[ErrorReaction, Address]] = MappingProxyType(
    {ErrorReaction.SLOW_DOWN: od.PROFILE_DECELERATION, ErrorReaction.QUICK_STOP: od.QUICK_STOP_DECELERATION}
)
"""Objects with the deceleration of a ramp."""

FAULT_REACTION: Final[Mapping[int, ErrorReaction]] = MappingProxyType(
    {0: ErrorReaction.DISABLE, 1: ErrorReaction.SLOW_DOWN, 2: ErrorReaction.QUICK_STOP}
)
"""0x605E; the stops at the current and voltage limit, 3 and 4, are not described here."""
ABORT_CONNECTION: Final[Mapping[int, ErrorReaction]] = MappingProxyType(
    {0: ErrorReaction.NONE, 2: ErrorReaction.DISABLE, 3: ErrorReaction.QUICK_STOP}
)
"""0x6007 for a lost connection; 1, and others, react by 0x605E.

The standard names commands for 2 and 3, not the state that follows. Here each but 0 ends in Fault: that
is the EPOS2's (0x8130), and a guess for any other product.
"""
