"""Commands of a drive, whatever carries them: Controlwords, set-points, network commands, states.

Sources: CiA 402 for Controlwords and states, CiA 301 for the network.
"""

from typing import Final, NamedTuple

from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen.objects import TARGET_POSITION, TARGET_VELOCITY
from firmware_bridge.robot import CommandForm

TARGET: Final = {CommandForm.SPEED: TARGET_VELOCITY, CommandForm.POSITION: TARGET_POSITION}

NEW_SET_POINT: Final = 0x003F
"""Go to the target now."""
ENABLE: Final = 0x000F
HALT: Final = 0x010F
FAULT_RESET: Final = 0x0080
DISABLE_VOLTAGE: Final = 0x0000
QUICK_STOP: Final = 0x000B
"""A drive with power ramps down and keeps it; one without gets none."""
UNPOWERED: Final = (DISABLE_VOLTAGE, 0x0002, 0x0006, 0x0007, QUICK_STOP)
"""Disable voltage, quick stop (twice), shutdown, switch on: none enables power or commands motion."""
START_HOMING: Final = 0x001F
"""The Controlword that starts homing; in place it turns no shaft, and `zeroing` permits no other use."""
POWERED: Final = (ENABLE, HALT, NEW_SET_POINT, START_HOMING)
"""Controlwords after which the drive has power and may have torque."""
STOP_WORDS: Final = (DISABLE_VOLTAGE, 0x0002, QUICK_STOP)
CONTROLWORDS: Final = {
    CommandForm.SPEED: (*UNPOWERED, FAULT_RESET, ENABLE, HALT),
    CommandForm.POSITION: (*UNPOWERED, FAULT_RESET, ENABLE, HALT, NEW_SET_POINT),
}

POWERED_STATES: Final = (
    PowerState.REFRESH,
    PowerState.MEASURE_INIT,
    PowerState.OPERATION_ENABLED,
    PowerState.QUICK_STOP_ACTIVE,
    PowerState.FAULT_REACTION_ENABLED,
)
"""In which the motor may have torque."""

LISTED_NMT: Final = (
    NmtCommand.START,
    NmtCommand.ENTER_PRE_OPERATIONAL,
    NmtCommand.RESET_NODE,
    NmtCommand.RESET_COMMUNICATION,
)
"""The permitted NMT commands. STOP is none: a stopped drive receives neither set-points nor SDO."""


class GuardedSetPoint(NamedTuple):
    """The set-point in force for a drive."""

    word: int
    target: int
    """Units of speed or counts."""
