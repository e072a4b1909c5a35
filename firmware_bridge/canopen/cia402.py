"""CiA 402: power states with their statusword patterns, controlword commands, modes.

Source: CiA 402-2, state machine, Controlword and Statusword. A product has its own table of states where its
patterns are others, or its states more.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum, IntFlag
from types import MappingProxyType
from typing import Final


class PowerState(Enum):
    """States of CiA 402, and those that a product has between them."""

    START = "start"
    """It has no pattern in the standard: a device there does not communicate yet."""
    NOT_READY_TO_SWITCH_ON = "not ready to switch on"
    SWITCH_ON_DISABLED = "switch on disabled"
    READY_TO_SWITCH_ON = "ready to switch on"
    SWITCHED_ON = "switched on"
    REFRESH = "refresh"
    """A product's: the power stage is prepared."""
    MEASURE_INIT = "measure init"
    """A product's: the initial measurement is under way."""
    OPERATION_ENABLED = "operation enabled"
    QUICK_STOP_ACTIVE = "quick stop active"
    FAULT_REACTION_DISABLED = "fault reaction disabled"
    """A product's: Fault reaction active, entered without power."""
    FAULT_REACTION_ENABLED = "fault reaction enabled"
    """Fault reaction active in the standard, from whatever state it is entered."""
    FAULT = "fault"

    @property
    def title(self) -> str:
        """The state as text."""
        return self.value


@dataclass(frozen=True, slots=True)
class StatePattern:
    """Statusword bits that are as in `value` where `mask` is set."""

    state: PowerState
    mask: int
    value: int


class StateTable:
    """The states that a Statusword can show."""

    def __init__(self, rows: Sequence[StatePattern]) -> None:
        """Take the patterns, of which no two fit the same Statusword."""
        self.words: Final[Mapping[PowerState, int]] = {row.state: row.value for row in rows}
        """The Statusword of each state, without any other bit."""
        by_mask: dict[int, dict[int, PowerState]] = {}
        for row in rows:
            by_mask.setdefault(row.mask, {})[row.value] = row.state
        self._by_mask: Final = tuple(by_mask.items())

    def state_of(self, statusword: int) -> PowerState | None:
        """Return the state in a Statusword; None for a pattern that is no state."""
        for mask, states in self._by_mask:
            state = states.get(statusword & mask)
            if state is not None:
                return state
        return None


STATES: Final = StateTable(
    (
        # Bit 5, quick stop, does not count where the mask is 0x4F; bit 4, voltage enabled, never does.
        StatePattern(PowerState.NOT_READY_TO_SWITCH_ON, 0x4F, 0x00),
        StatePattern(PowerState.SWITCH_ON_DISABLED, 0x4F, 0x40),
        StatePattern(PowerState.READY_TO_SWITCH_ON, 0x6F, 0x21),
        StatePattern(PowerState.SWITCHED_ON, 0x6F, 0x23),
        StatePattern(PowerState.OPERATION_ENABLED, 0x6F, 0x27),
        StatePattern(PowerState.QUICK_STOP_ACTIVE, 0x6F, 0x07),
        StatePattern(PowerState.FAULT_REACTION_ENABLED, 0x4F, 0x0F),
        StatePattern(PowerState.FAULT, 0x4F, 0x08),
    )
)
"""The states of the standard."""


class Status(IntFlag):
    """Statusword bits beside the state."""

    REMOTE = 1 << 9
    TARGET_REACHED = 1 << 10
    INTERNAL_LIMIT = 1 << 11
    SETPOINT_ACKNOWLEDGED = 1 << 12
    """Profile position mode."""
    SPEED_IS_ZERO = 1 << 12
    """Profile velocity mode."""
    HOMING_ATTAINED = 1 << 12
    """Homing mode."""
    INTERPOLATION_ACTIVE = 1 << 12
    """Interpolated position mode."""
    FOLLOWING_ERROR = 1 << 13
    HOMING_ERROR = 1 << 13
    """Homing mode."""


class ControlwordBit(IntFlag):
    """Controlword bits."""

    SWITCH_ON = 1 << 0
    ENABLE_VOLTAGE = 1 << 1
    NO_QUICK_STOP = 1 << 2
    ENABLE_OPERATION = 1 << 3
    NEW_SETPOINT = 1 << 4
    """Profile position mode."""
    ENABLE_INTERPOLATION = 1 << 4
    """Interpolated position mode."""
    CHANGE_IMMEDIATELY = 1 << 5
    RELATIVE = 1 << 6
    FAULT_RESET = 1 << 7
    HALT = 1 << 8


class ControlwordCommand(Enum):
    """Controlword commands, checked in the order of `COMMANDS`; fault reset is an edge of its own."""

    DISABLE_VOLTAGE = "disable voltage"
    QUICK_STOP = "quick stop"
    SHUTDOWN = "shutdown"
    DISABLE_OPERATION = "switch on / disable operation"
    ENABLE_OPERATION = "enable operation"


@dataclass(frozen=True, slots=True)
class ControlPattern:
    """Bits that must be as in `value` where `mask` is set."""

    command: ControlwordCommand
    mask: int
    value: int


COMMANDS: Final = (
    # Transitions 7, 9, 10 and 12 of CiA 402: bit 1 at 0 is enough, whatever the others are.
    ControlPattern(ControlwordCommand.DISABLE_VOLTAGE, 0b0000_0010, 0b0000_0000),
    # Transitions 7, 10 and 11: bit 2 is active at 0; bits 0 and 3 do not count.
    ControlPattern(ControlwordCommand.QUICK_STOP, 0b0000_0110, 0b0000_0010),
    # Transitions 2, 6 and 8.
    ControlPattern(ControlwordCommand.SHUTDOWN, 0b0000_0111, 0b0000_0110),
    # Transition 3 in Ready to switch on, 5 in Operation enabled: one bit pattern for both.
    ControlPattern(ControlwordCommand.DISABLE_OPERATION, 0b0000_1111, 0b0000_0111),
    # Transitions 4 and 16; the drives of many makers go through 3 and 4 at once.
    ControlPattern(ControlwordCommand.ENABLE_OPERATION, 0b0000_1111, 0b0000_1111),
)


def command_of(controlword: int) -> ControlwordCommand:
    """Return the command of a controlword; the patterns cover every value."""
    for pattern in COMMANDS:
        if controlword & pattern.mask == pattern.value:
            return pattern.command
    raise AssertionError(controlword)


_WORDS: Final = {pattern.command: pattern.value for pattern in COMMANDS}


def word_of(command: ControlwordCommand) -> int:
    """Return the plainest controlword of a command: no bit but those that make it."""
    return _WORDS[command]


FAULT_RESET_WORDS: Final = (0x0000, int(ControlwordBit.FAULT_RESET))
"""The Controlwords of a fault reset, in order: it is a rising edge; in Fault the first does nothing."""

PASSING: Final = frozenset(
    {
        PowerState.START,
        PowerState.NOT_READY_TO_SWITCH_ON,
        PowerState.REFRESH,
        PowerState.MEASURE_INIT,
        PowerState.FAULT_REACTION_DISABLED,
        PowerState.FAULT_REACTION_ENABLED,
    }
)
"""States that the drive leaves by itself."""

TOWARDS: Final[Mapping[PowerState, Mapping[PowerState, ControlwordCommand]]] = MappingProxyType(
    {
        PowerState.OPERATION_ENABLED: {
            # Transitions 2, 3 and 4, one after the other; 16 leads back from the quick stop.
            PowerState.SWITCH_ON_DISABLED: ControlwordCommand.SHUTDOWN,
            PowerState.READY_TO_SWITCH_ON: ControlwordCommand.DISABLE_OPERATION,
            PowerState.SWITCHED_ON: ControlwordCommand.ENABLE_OPERATION,
            PowerState.QUICK_STOP_ACTIVE: ControlwordCommand.ENABLE_OPERATION,
        },
        PowerState.READY_TO_SWITCH_ON: {
            # Transitions 2, 6 and 8: without torque, and ready to be switched on again.
            PowerState.SWITCH_ON_DISABLED: ControlwordCommand.SHUTDOWN,
            PowerState.SWITCHED_ON: ControlwordCommand.SHUTDOWN,
            PowerState.OPERATION_ENABLED: ControlwordCommand.SHUTDOWN,
        },
        # Transition 11.
        PowerState.QUICK_STOP_ACTIVE: {PowerState.OPERATION_ENABLED: ControlwordCommand.QUICK_STOP},
        PowerState.SWITCH_ON_DISABLED: {
            # Transitions 7, 10, 9 and 12: the power stage goes off, in 9 without a ramp.
            PowerState.READY_TO_SWITCH_ON: ControlwordCommand.DISABLE_VOLTAGE,
            PowerState.SWITCHED_ON: ControlwordCommand.DISABLE_VOLTAGE,
            PowerState.OPERATION_ENABLED: ControlwordCommand.DISABLE_VOLTAGE,
            PowerState.QUICK_STOP_ACTIVE: ControlwordCommand.DISABLE_VOLTAGE,
        },
    }
)
"""The transitions of the power state machine: by wanted state, the next command in each state before it.

None leads out of Fault, whose reset is an operator's decision, nor out of Quick stop active but by enabling
or by disabling: a shaft that is held there is released only by such a command.
"""


def towards(state: PowerState | None, wanted: PowerState) -> ControlwordCommand | None:
    """Return the next command on the way; None at its end, where there is none, or where waiting leads on."""
    return None if state is None else TOWARDS.get(wanted, {}).get(state)


class Mode(IntEnum):
    """Modes of operation of the standard, 0x6060; those of makers are negative."""

    NONE = 0
    PROFILE_POSITION = 1
    VELOCITY = 2
    PROFILE_VELOCITY = 3
    PROFILE_TORQUE = 4
    HOMING = 6
    INTERPOLATED_POSITION = 7
    CYCLIC_POSITION = 8
    CYCLIC_VELOCITY = 9
    CYCLIC_TORQUE = 10
    CYCLIC_TORQUE_WITH_ANGLE = 11

    @property
    def supported_bit(self) -> int:
        """The bit of 0x6502; 0 for no mode."""
        return 1 << self - 1 if self else 0
