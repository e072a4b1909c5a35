"""CiA 402 as the EPOS2 speaks it: states with their statusword patterns, controlword commands, modes.

Sources: EPOS Firmware Specification, sections on the state machine and the controlword (by analogy for the
EPOS2), names as in maxon's command library.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, IntEnum, IntFlag
from types import MappingProxyType
from typing import Final


class PowerState(Enum):
    """A state and its statusword with the bits that identify it: 14, 8 and 6 to 0."""

    START = 0x0000
    NOT_READY_TO_SWITCH_ON = 0x0100
    SWITCH_ON_DISABLED = 0x0140
    READY_TO_SWITCH_ON = 0x0121
    SWITCHED_ON = 0x0123
    REFRESH = 0x4123
    MEASURE_INIT = 0x4133
    OPERATION_ENABLED = 0x0137
    QUICK_STOP_ACTIVE = 0x0117
    FAULT_REACTION_DISABLED = 0x010F
    FAULT_REACTION_ENABLED = 0x011F
    FAULT = 0x0108

    @property
    def title(self) -> str:
        """The state as text."""
        return self.name.lower().replace("_", " ")


STATE_BITS: Final = 0x417F
"""The Statusword bits of the state; 9 to 13 and 15 have other meanings, 7 none."""

_STATE_BY_PATTERN: Final = {state.value: state for state in PowerState}


def state_of(statusword: int) -> PowerState | None:
    """Return the state in a Statusword; None for a pattern that is no state."""
    return _STATE_BY_PATTERN.get(statusword & STATE_BITS)


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
    REFERENCED = 1 << 15


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
    """Modes of operation, 0x6060."""

    INTERPOLATED_POSITION = 7
    HOMING = 6
    PROFILE_VELOCITY = 3
    PROFILE_POSITION = 1
    POSITION = -1
    VELOCITY = -2
    CURRENT = -3
    DIAGNOSTIC = -4
    MASTER_ENCODER = -5
    STEP_DIRECTION = -6
