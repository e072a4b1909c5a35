"""Option codes of CiA 402: quick stop, halt, faults, lost connections, ramps before the power goes.

Source: CiA 402-2, 0x6007, 0x605A to 0x605E. A product takes the rows that it has, and adds its own.
"""

from collections.abc import Mapping
from enum import Enum
from types import MappingProxyType
from typing import Final, NamedTuple

from emulators.canopen.object_store import ObjectStore
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


class QuickStopOption(NamedTuple):
    """A row of 0x605A."""

    deceleration: Address | None
    """Object with the deceleration of its ramp; None: the power stage goes off at once."""
    lasts: bool
    """True if Quick stop active lasts, with power; else Switch on disabled follows its ramp."""


QUICK_STOP: Final[Mapping[int, QuickStopOption]] = MappingProxyType(
    {
        0: QuickStopOption(None, lasts=False),
        1: QuickStopOption(od.PROFILE_DECELERATION, lasts=False),
        2: QuickStopOption(od.QUICK_STOP_DECELERATION, lasts=False),
        5: QuickStopOption(od.PROFILE_DECELERATION, lasts=True),
        6: QuickStopOption(od.QUICK_STOP_DECELERATION, lasts=True),
    }
)
"""0x605A; the stops at the current and voltage limit, 3, 4, 7 and 8, are not described here."""
WITHOUT_OPTION: Final = 6
"""What a device without 0x605A does: the EPOS2's, and a guess for any other."""
HALT: Final[Mapping[int, Address]] = MappingProxyType(
    {1: od.PROFILE_DECELERATION, 2: od.QUICK_STOP_DECELERATION}
)
"""0x605D: objects with the deceleration of a halt; a device without it halts by 1."""


class QuickStop:
    """The quick stop of one device, by its 0x605A where it has one."""

    def __init__(self, store: ObjectStore, *, lasts: bool = False) -> None:
        """`lasts`: the device stays in Quick stop active whatever the option is."""
        self._store: Final = store
        self._lasts: Final = lasts

    def _row(self) -> QuickStopOption:
        option = self._store.get_or(od.QUICK_STOP_OPTION, WITHOUT_OPTION)
        return QUICK_STOP.get(option, QUICK_STOP[2])

    @property
    def deceleration(self) -> Address | None:
        """The object with its deceleration."""
        return self._row().deceleration

    @property
    def lasts(self) -> bool:
        """True if the device stays in Quick stop active, with power."""
        return self._lasts or self._row().lasts
