"""The power state machine of CiA 402 as one table: where each state may go, on what, with which effect.

Source: CiA 402-2, power drive system state machine, numbered as there. A product makes its own table of these
rows, without those that it has not, and with its own.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Final, TypeAlias

from firmware_bridge.canopen.cia402 import ControlwordCommand, PowerState


class Happening(Enum):
    """Events that change the device's state beside the controlword's commands."""

    STARTED = "firmware started"
    INITIALIZED = "initialization finished"
    OFFSET_MEASURED = "current offset measured"
    """A product's."""
    REFRESHED = "power stage refreshed"
    """A product's."""
    MEASURED = "initial measurement finished"
    """A product's."""
    STOPPED = "quick stop finished"
    FAULT = "fault"
    REACTED = "fault reaction finished"
    FAULT_RESET = "fault reset, cause gone"


class PowerStageEffect(Enum):
    """Effect of a transition on the power stage."""

    KEEP = "as it was"
    ON = "on"
    OFF = "off"


class RampOption(Enum):
    """The option code that may demand a slow-down before the transition is completed."""

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
_ON = PowerStageEffect.ON
_OFF = PowerStageEffect.OFF

CIA_402: Final = (
    Transition(0, PowerState.START, Happening.STARTED, PowerState.NOT_READY_TO_SWITCH_ON, _OFF),
    Transition(1, PowerState.NOT_READY_TO_SWITCH_ON, Happening.INITIALIZED, PowerState.SWITCH_ON_DISABLED),
    Transition(2, PowerState.SWITCH_ON_DISABLED, _SHUTDOWN, PowerState.READY_TO_SWITCH_ON),
    Transition(3, PowerState.READY_TO_SWITCH_ON, _SWITCH_ON, PowerState.SWITCHED_ON),
    # 0x000F does 3 and then 4.
    Transition(3, PowerState.READY_TO_SWITCH_ON, _ENABLE, PowerState.SWITCHED_ON, goes_on=True),
    Transition(4, PowerState.SWITCHED_ON, _ENABLE, PowerState.OPERATION_ENABLED, _ON),
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
    Transition(11, PowerState.OPERATION_ENABLED, _QUICK, PowerState.QUICK_STOP_ACTIVE),
    Transition(12, PowerState.QUICK_STOP_ACTIVE, _DISABLE, PowerState.SWITCH_ON_DISABLED, _OFF),
    # With 0x605A at 0 to 4; with 5 to 8 the state lasts.
    Transition(12, PowerState.QUICK_STOP_ACTIVE, Happening.STOPPED, PowerState.SWITCH_ON_DISABLED, _OFF),
    *(
        Transition(13, source, Happening.FAULT, PowerState.FAULT_REACTION_ENABLED)
        for source in (
            PowerState.START,
            PowerState.NOT_READY_TO_SWITCH_ON,
            PowerState.SWITCH_ON_DISABLED,
            PowerState.READY_TO_SWITCH_ON,
            PowerState.SWITCHED_ON,
            PowerState.OPERATION_ENABLED,
            PowerState.QUICK_STOP_ACTIVE,
        )
    ),
    Transition(14, PowerState.FAULT_REACTION_ENABLED, Happening.REACTED, PowerState.FAULT, _OFF),
    # Switch on disabled, not Ready: after a fault the whole sequence of commands is needed again.
    Transition(15, PowerState.FAULT, Happening.FAULT_RESET, PowerState.SWITCH_ON_DISABLED),
    Transition(16, PowerState.QUICK_STOP_ACTIVE, _ENABLE, PowerState.OPERATION_ENABLED),
)
"""The transitions of the standard."""


def of_product(absent: frozenset[tuple[int, Trigger]], own: Iterable[Transition]) -> tuple[Transition, ...]:
    """Return a product's transitions by their numbers: the standard's without `absent`, and its `own`."""
    kept = [row for row in CIA_402 if (row.number, row.trigger) not in absent]
    return tuple(sorted((*kept, *own), key=lambda row: row.number))


def leaving(rows: Iterable[Transition]) -> Mapping[PowerState, Mapping[Trigger, Transition]]:
    """Return transitions by the state that they leave, and by what they follow."""
    found: dict[PowerState, dict[Trigger, Transition]] = {state: {} for state in PowerState}
    for row in rows:
        found[row.source][row.trigger] = row
    return MappingProxyType(found)
