"""The power states of CiA 402 as one table: where each may go, on what, and what happens to the power stage.

Source: EPOS Firmware Specification, state transitions (by analogy for the EPOS2), numbered as there, with
maxon's own states Refresh and Measure init.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Final, TypeAlias

from firmware_bridge.canopen.cia402 import ControlwordCommand, PowerState
from firmware_bridge.units import MILLISECOND, Nanoseconds


class Happening(Enum):
    """Events that change the drive's state beside the controlword's commands."""

    STARTED = "firmware started"
    OFFSET_MEASURED = "current offset measured"
    REFRESHED = "power stage refreshed"
    MEASURED = "initial measurement finished"
    FAULT = "fault"
    REACTED = "fault reaction finished"
    FAULT_RESET = "fault reset, cause gone"


class PowerStageEffect(Enum):
    """Effect of a transition on the power stage."""

    KEEP = "as it was"
    ON = "on"
    OFF = "off"


class RampOption(Enum):
    """The option code that may ask for a slow-down before the transition is completed."""

    NONE = "none"
    SHUTDOWN = "0x605B"
    DISABLE = "0x605C"


Trigger: TypeAlias = ControlwordCommand | Happening


@dataclass(frozen=True, slots=True)
class Transition:
    """One row: number in the specification, from, on, to."""

    number: int
    source: PowerState
    trigger: Trigger
    target: PowerState
    stage: PowerStageEffect = PowerStageEffect.KEEP
    ramp: RampOption = RampOption.NONE
    goes_on: bool = False
    """The same command counts once more in the new state: switch on with bit 3 does 3, then 4."""


_DISABLE = ControlwordCommand.DISABLE_VOLTAGE
_QUICK = ControlwordCommand.QUICK_STOP
_SHUTDOWN = ControlwordCommand.SHUTDOWN
_SWITCH_ON = ControlwordCommand.DISABLE_OPERATION
_ENABLE = ControlwordCommand.ENABLE_OPERATION
_OFF = PowerStageEffect.OFF

TRANSITIONS: Final = (
    Transition(0, PowerState.START, Happening.STARTED, PowerState.NOT_READY_TO_SWITCH_ON, _OFF),
    Transition(
        1, PowerState.NOT_READY_TO_SWITCH_ON, Happening.OFFSET_MEASURED, PowerState.SWITCH_ON_DISABLED
    ),
    Transition(2, PowerState.SWITCH_ON_DISABLED, _SHUTDOWN, PowerState.READY_TO_SWITCH_ON),
    Transition(3, PowerState.READY_TO_SWITCH_ON, _SWITCH_ON, PowerState.SWITCHED_ON),
    # 0x000F does 3 and then 4; maxon's library never sends 0x0007 on its way up.
    Transition(3, PowerState.READY_TO_SWITCH_ON, _ENABLE, PowerState.SWITCHED_ON, goes_on=True),
    # maxon's own: 4 leads to Refresh, and only 20 and 21 to Operation enabled.
    Transition(4, PowerState.SWITCHED_ON, _ENABLE, PowerState.REFRESH),
    Transition(5, PowerState.OPERATION_ENABLED, _SWITCH_ON, PowerState.SWITCHED_ON, _OFF, RampOption.DISABLE),
    Transition(6, PowerState.SWITCHED_ON, _SHUTDOWN, PowerState.READY_TO_SWITCH_ON),
    # Without power there is nothing to ramp: in 7 and 10 a quick stop acts as disable voltage.
    Transition(7, PowerState.READY_TO_SWITCH_ON, _QUICK, PowerState.SWITCH_ON_DISABLED),
    Transition(7, PowerState.READY_TO_SWITCH_ON, _DISABLE, PowerState.SWITCH_ON_DISABLED),
    Transition(
        8, PowerState.OPERATION_ENABLED, _SHUTDOWN, PowerState.READY_TO_SWITCH_ON, _OFF, RampOption.SHUTDOWN
    ),
    Transition(9, PowerState.OPERATION_ENABLED, _DISABLE, PowerState.SWITCH_ON_DISABLED, _OFF),
    Transition(10, PowerState.SWITCHED_ON, _QUICK, PowerState.SWITCH_ON_DISABLED),
    Transition(10, PowerState.SWITCHED_ON, _DISABLE, PowerState.SWITCH_ON_DISABLED),
    # The power stays on, and no row leaves Quick stop active by itself: only 12 and 16 do.
    Transition(11, PowerState.OPERATION_ENABLED, _QUICK, PowerState.QUICK_STOP_ACTIVE),
    Transition(12, PowerState.QUICK_STOP_ACTIVE, _DISABLE, PowerState.SWITCH_ON_DISABLED, _OFF),
    # 13 for each state without motion: power off at once. 17 below is the one with a ramp.
    Transition(13, PowerState.START, Happening.FAULT, PowerState.FAULT_REACTION_DISABLED, _OFF),
    Transition(
        13, PowerState.NOT_READY_TO_SWITCH_ON, Happening.FAULT, PowerState.FAULT_REACTION_DISABLED, _OFF
    ),
    Transition(13, PowerState.SWITCH_ON_DISABLED, Happening.FAULT, PowerState.FAULT_REACTION_DISABLED, _OFF),
    Transition(13, PowerState.READY_TO_SWITCH_ON, Happening.FAULT, PowerState.FAULT_REACTION_DISABLED, _OFF),
    Transition(13, PowerState.SWITCHED_ON, Happening.FAULT, PowerState.FAULT_REACTION_DISABLED, _OFF),
    Transition(13, PowerState.REFRESH, Happening.FAULT, PowerState.FAULT_REACTION_DISABLED, _OFF),
    Transition(13, PowerState.MEASURE_INIT, Happening.FAULT, PowerState.FAULT_REACTION_DISABLED, _OFF),
    Transition(14, PowerState.FAULT_REACTION_DISABLED, Happening.REACTED, PowerState.FAULT, _OFF),
    # Switch on disabled, not Ready: after a fault the whole sequence of commands is needed again.
    Transition(15, PowerState.FAULT, Happening.FAULT_RESET, PowerState.SWITCH_ON_DISABLED),
    Transition(16, PowerState.QUICK_STOP_ACTIVE, _ENABLE, PowerState.OPERATION_ENABLED),
    Transition(17, PowerState.OPERATION_ENABLED, Happening.FAULT, PowerState.FAULT_REACTION_ENABLED),
    Transition(17, PowerState.QUICK_STOP_ACTIVE, Happening.FAULT, PowerState.FAULT_REACTION_ENABLED),
    Transition(18, PowerState.FAULT_REACTION_ENABLED, Happening.REACTED, PowerState.FAULT, _OFF),
    Transition(20, PowerState.REFRESH, Happening.REFRESHED, PowerState.MEASURE_INIT, PowerStageEffect.ON),
    Transition(21, PowerState.MEASURE_INIT, Happening.MEASURED, PowerState.OPERATION_ENABLED),
)
"""Transition 19, node reset, leads from every state to Start: see `MotionControl.reset`."""

LEAVING: Final[Mapping[PowerState, dict[Trigger, Transition]]] = MappingProxyType(
    {state: {row.trigger: row for row in TRANSITIONS if row.source is state} for state in PowerState}
)
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
