"""The EPOS2's power states: transitions as differences from CiA 402's; states that end by themselves.

Source: EPOS Firmware Specification, state transitions (by analogy for the EPOS2), numbered as there, with
maxon's own states Refresh and Measure init.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from emulators.canopen.power_states import (
    Happening,
    PowerStageEffect,
    Transition,
    Trigger,
    leaving,
    of_product,
)
from firmware_bridge.canopen.cia402 import ControlwordCommand, PowerState
from firmware_bridge.units import MILLISECOND, Nanoseconds

_ENABLE = ControlwordCommand.ENABLE_OPERATION
_OFF = PowerStageEffect.OFF

_ABSENT: Final[frozenset[tuple[int, Trigger]]] = frozenset(
    {
        (1, Happening.INITIALIZED),
        (4, _ENABLE),
        # The EPOS2 has no 0x605A: no row leaves Quick stop active by itself.
        (12, Happening.STOPPED),
        # It has two fault reactions: 13 and 14 without power, 17 and 18 with it.
        (13, Happening.FAULT),
        (14, Happening.REACTED),
    }
)
_WITHOUT_POWER: Final = (
    PowerState.START,
    PowerState.NOT_READY_TO_SWITCH_ON,
    PowerState.SWITCH_ON_DISABLED,
    PowerState.READY_TO_SWITCH_ON,
    PowerState.SWITCHED_ON,
    PowerState.REFRESH,
    PowerState.MEASURE_INIT,
)
_OWN: Final = (
    Transition(
        1, PowerState.NOT_READY_TO_SWITCH_ON, Happening.OFFSET_MEASURED, PowerState.SWITCH_ON_DISABLED
    ),
    # 4 leads to Refresh, and only 20 and 21 to Operation enabled.
    Transition(4, PowerState.SWITCHED_ON, _ENABLE, PowerState.REFRESH),
    # 13 for each state without motion: power off at once. 17 below is the one with a ramp.
    *(
        Transition(13, source, Happening.FAULT, PowerState.FAULT_REACTION_DISABLED, _OFF)
        for source in _WITHOUT_POWER
    ),
    Transition(14, PowerState.FAULT_REACTION_DISABLED, Happening.REACTED, PowerState.FAULT, _OFF),
    Transition(17, PowerState.OPERATION_ENABLED, Happening.FAULT, PowerState.FAULT_REACTION_ENABLED),
    Transition(17, PowerState.QUICK_STOP_ACTIVE, Happening.FAULT, PowerState.FAULT_REACTION_ENABLED),
    Transition(18, PowerState.FAULT_REACTION_ENABLED, Happening.REACTED, PowerState.FAULT, _OFF),
    Transition(20, PowerState.REFRESH, Happening.REFRESHED, PowerState.MEASURE_INIT, PowerStageEffect.ON),
    Transition(21, PowerState.MEASURE_INIT, Happening.MEASURED, PowerState.OPERATION_ENABLED),
)

TRANSITIONS: Final = of_product(_ABSENT, _OWN)
"""Transition 19, node reset, leads from every state to Start: see `MotionControl.reset`."""

LEAVING: Final = leaving(TRANSITIONS)
"""The rows by the state that they leave."""

TIMED: Final[Mapping[PowerState, Happening]] = MappingProxyType(
    {
        PowerState.START: Happening.STARTED,
        PowerState.NOT_READY_TO_SWITCH_ON: Happening.OFFSET_MEASURED,
        PowerState.REFRESH: Happening.REFRESHED,
        PowerState.MEASURE_INIT: Happening.MEASURED,
        PowerState.FAULT_REACTION_DISABLED: Happening.REACTED,
    }
)
"""States that end by themselves; a command that arrives in one waits until then."""

BRUSHED_DC: Final = 1
"""Motor type 0x6402 that needs no commutation."""


@dataclass(frozen=True, slots=True)
class Delays:
    """Durations of the states that end by themselves. Assumed: no document gives them.

    A recorded enable sequence of a maxon drive shows 0x0723 and then 0x0737 with nothing between, so for a
    brushed motor Refresh and Measure init pass unseen; a brushless one needs time to find its commutation.
    """

    start: Nanoseconds = 0
    offset: Nanoseconds = 5 * MILLISECOND
    refresh: Nanoseconds = 0
    measure: Nanoseconds = 0
    refresh_brushless: Nanoseconds = 1 * MILLISECOND
    measure_brushless: Nanoseconds = 10 * MILLISECOND

    def of(self, state: PowerState, motor_type: int) -> Nanoseconds:
        """Return how long this state lasts with this motor."""
        brushed = motor_type == BRUSHED_DC
        return {
            PowerState.START: self.start,
            PowerState.NOT_READY_TO_SWITCH_ON: self.offset,
            PowerState.REFRESH: self.refresh if brushed else self.refresh_brushless,
            PowerState.MEASURE_INIT: self.measure if brushed else self.measure_brushless,
        }.get(state, 0)
