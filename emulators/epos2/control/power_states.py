"""The power states of CiA 402 as one table: where each may go, on what, and what happens to the power stage.

Source: EPOS Firmware Specification, state transitions (by analogy for the EPOS2), numbered as there, with
maxon's own states Refresh and Measure init.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Final, TypeAlias

from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.cia402 import Command, State


class Happening(Enum):
    """Events that change the drive's state beside the controlword's commands."""

    STARTED = "firmware started"
    OFFSET_MEASURED = "current offset measured"
    REFRESHED = "power stage refreshed"
    MEASURED = "initial measurement finished"
    FAULT = "fault"
    REACTED = "fault reaction finished"
    FAULT_RESET = "fault reset, cause gone"


class Stage(Enum):
    """Effect of a transition on the power stage."""

    KEEP = "as it was"
    ON = "on"
    OFF = "off"


class RampOption(Enum):
    """The option code that may ask for a slow-down before the transition is completed."""

    NONE = "none"
    SHUTDOWN = "0x605B"
    DISABLE = "0x605C"


Trigger: TypeAlias = Command | Happening


@dataclass(frozen=True, slots=True)
class Transition:
    """One row: number in the specification, from, on, to."""

    number: int
    source: State
    trigger: Trigger
    target: State
    stage: Stage = Stage.KEEP
    ramp: RampOption = RampOption.NONE
    goes_on: bool = False
    """The same command counts once more in the new state: switch on with bit 3 does 3, then 4."""


_DISABLE = Command.DISABLE_VOLTAGE
_QUICK = Command.QUICK_STOP
_SHUTDOWN = Command.SHUTDOWN
_SWITCH_ON = Command.DISABLE_OPERATION
_ENABLE = Command.ENABLE_OPERATION
_OFF = Stage.OFF

TRANSITIONS: Final = (
    Transition(0, State.START, Happening.STARTED, State.NOT_READY_TO_SWITCH_ON, _OFF),
    Transition(1, State.NOT_READY_TO_SWITCH_ON, Happening.OFFSET_MEASURED, State.SWITCH_ON_DISABLED),
    Transition(2, State.SWITCH_ON_DISABLED, _SHUTDOWN, State.READY_TO_SWITCH_ON),
    Transition(3, State.READY_TO_SWITCH_ON, _SWITCH_ON, State.SWITCHED_ON),
    Transition(3, State.READY_TO_SWITCH_ON, _ENABLE, State.SWITCHED_ON, goes_on=True),
    Transition(4, State.SWITCHED_ON, _ENABLE, State.REFRESH),
    Transition(5, State.OPERATION_ENABLED, _SWITCH_ON, State.SWITCHED_ON, _OFF, RampOption.DISABLE),
    Transition(6, State.SWITCHED_ON, _SHUTDOWN, State.READY_TO_SWITCH_ON),
    Transition(7, State.READY_TO_SWITCH_ON, _QUICK, State.SWITCH_ON_DISABLED),
    Transition(7, State.READY_TO_SWITCH_ON, _DISABLE, State.SWITCH_ON_DISABLED),
    Transition(8, State.OPERATION_ENABLED, _SHUTDOWN, State.READY_TO_SWITCH_ON, _OFF, RampOption.SHUTDOWN),
    Transition(9, State.OPERATION_ENABLED, _DISABLE, State.SWITCH_ON_DISABLED, _OFF),
    Transition(10, State.SWITCHED_ON, _QUICK, State.SWITCH_ON_DISABLED),
    Transition(10, State.SWITCHED_ON, _DISABLE, State.SWITCH_ON_DISABLED),
    Transition(11, State.OPERATION_ENABLED, _QUICK, State.QUICK_STOP_ACTIVE),
    Transition(12, State.QUICK_STOP_ACTIVE, _DISABLE, State.SWITCH_ON_DISABLED, _OFF),
    Transition(13, State.START, Happening.FAULT, State.FAULT_REACTION_DISABLED, _OFF),
    Transition(13, State.NOT_READY_TO_SWITCH_ON, Happening.FAULT, State.FAULT_REACTION_DISABLED, _OFF),
    Transition(13, State.SWITCH_ON_DISABLED, Happening.FAULT, State.FAULT_REACTION_DISABLED, _OFF),
    Transition(13, State.READY_TO_SWITCH_ON, Happening.FAULT, State.FAULT_REACTION_DISABLED, _OFF),
    Transition(13, State.SWITCHED_ON, Happening.FAULT, State.FAULT_REACTION_DISABLED, _OFF),
    Transition(13, State.REFRESH, Happening.FAULT, State.FAULT_REACTION_DISABLED, _OFF),
    Transition(13, State.MEASURE_INIT, Happening.FAULT, State.FAULT_REACTION_DISABLED, _OFF),
    Transition(14, State.FAULT_REACTION_DISABLED, Happening.REACTED, State.FAULT, _OFF),
    Transition(15, State.FAULT, Happening.FAULT_RESET, State.SWITCH_ON_DISABLED),
    Transition(16, State.QUICK_STOP_ACTIVE, _ENABLE, State.OPERATION_ENABLED),
    Transition(17, State.OPERATION_ENABLED, Happening.FAULT, State.FAULT_REACTION_ENABLED),
    Transition(17, State.QUICK_STOP_ACTIVE, Happening.FAULT, State.FAULT_REACTION_ENABLED),
    Transition(18, State.FAULT_REACTION_ENABLED, Happening.REACTED, State.FAULT, _OFF),
    Transition(20, State.REFRESH, Happening.REFRESHED, State.MEASURE_INIT, Stage.ON),
    Transition(21, State.MEASURE_INIT, Happening.MEASURED, State.OPERATION_ENABLED),
)
"""Transition 19, node reset, leads from every state to Start: see `MotionControl.reset`."""

LEAVING: Final[Mapping[State, dict[Trigger, Transition]]] = MappingProxyType(
    {state: {row.trigger: row for row in TRANSITIONS if row.source is state} for state in State}
)
"""The rows by the state that they leave."""

TIMED: Final[Mapping[State, Happening]] = MappingProxyType(
    {
        State.START: Happening.STARTED,
        State.NOT_READY_TO_SWITCH_ON: Happening.OFFSET_MEASURED,
        State.REFRESH: Happening.REFRESHED,
        State.MEASURE_INIT: Happening.MEASURED,
        State.FAULT_REACTION_DISABLED: Happening.REACTED,
    }
)
"""States that end by themselves; a command that arrives in one waits until then."""

BRUSHED_DC: Final = 1
"""Motor type 0x6402 that needs no commutation."""


@dataclass(frozen=True, slots=True)
class Delays:
    """Durations of the states that end by themselves. ASSUME: no document gives them.

    A recorded enable sequence of a maxon drive shows 0x0723 and then 0x0737 with nothing between, so for a
    brushed motor Refresh and Measure init pass unseen; a brushless one needs time to find its commutation.
    """

    start: Nanoseconds = 0
    offset: Nanoseconds = 5 * MILLISECOND
    refresh: Nanoseconds = 0
    measure: Nanoseconds = 0
    refresh_brushless: Nanoseconds = 1 * MILLISECOND
    measure_brushless: Nanoseconds = 10 * MILLISECOND

    def of(self, state: State, motor_type: int) -> Nanoseconds:
        """Return how long this state lasts with this motor."""
        brushed = motor_type == BRUSHED_DC
        return {
            State.START: self.start,
            State.NOT_READY_TO_SWITCH_ON: self.offset,
            State.REFRESH: self.refresh if brushed else self.refresh_brushless,
            State.MEASURE_INIT: self.measure if brushed else self.measure_brushless,
        }.get(state, 0)
