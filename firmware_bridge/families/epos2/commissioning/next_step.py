"""The next Controlword towards motion, by a drive's state, mode and present Controlword (CiA 402)."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen.cia402 import ControlwordBit, PowerState, Status
from firmware_bridge.families.epos2.wire.modes import Mode

BY_STATE: Final[Mapping[PowerState, str]] = MappingProxyType(
    {
        PowerState.START: "wait: the drive starts",
        PowerState.NOT_READY_TO_SWITCH_ON: "wait: the drive starts",
        PowerState.SWITCH_ON_DISABLED: "0x0006 to 0x6040, shutdown",
        PowerState.READY_TO_SWITCH_ON: "0x0007 to 0x6040, switch on",
        PowerState.SWITCHED_ON: "0x000F to 0x6040, enable operation: the motor gets power",
        PowerState.REFRESH: "wait: the power stage is prepared",
        PowerState.MEASURE_INIT: "wait: the current offset is measured",
        PowerState.QUICK_STOP_ACTIVE: "0x000F to 0x6040, enable operation; 0x0000 disables the power stage",
        PowerState.FAULT_REACTION_DISABLED: "wait: the reaction to the fault is under way",
        PowerState.FAULT_REACTION_ENABLED: "wait: the reaction to the fault is under way",
        PowerState.FAULT: "remove the cause (see history), then 0x0080 to 0x6040, fault reset: bit 7 needs a "
        "0 -> 1 change",
    }
)
BY_MODE: Final[Mapping[Mode, str]] = MappingProxyType(
    {
        Mode.PROFILE_VELOCITY: "a target velocity to 0x60FF, then 0x000F to 0x6040",
        Mode.POSITION: "a position to 0x2062",
        Mode.VELOCITY: "a velocity to 0x206B",
        Mode.CURRENT: "a current to 0x2030",
        Mode.MASTER_ENCODER: "it follows its second encoder",
        Mode.STEP_DIRECTION: "it follows the steps at its inputs",
    }
)
"""In operation enabled, for modes whose set-points count as they are written."""
BY_EDGE: Final[Mapping[Mode, str]] = MappingProxyType(
    {
        Mode.PROFILE_POSITION: "a target position to 0x607A, then",
        Mode.HOMING: "a method to 0x6098, then",
        Mode.INTERPOLATED_POSITION: "records to 0x20C1, then",
    }
)
"""In operation enabled, for modes that bit 4 of the Controlword starts."""


def next_step(state: PowerState | None, mode: Mode | None, controlword: int | None, statusword: int) -> str:
    """Return what brings the drive nearer to motion; empty where that is not known."""
    if state is not PowerState.OPERATION_ENABLED:
        return "" if state is None else BY_STATE[state]
    if mode is None or controlword is None:
        return ""
    if controlword & ControlwordBit.HALT:
        return f"0x{controlword & ~ControlwordBit.HALT & 0xFFFF:04X} to 0x6040: halt, bit 8, holds it"
    return _started_by_bit_4(mode, controlword, statusword) if mode in BY_EDGE else BY_MODE.get(mode, "")


def _started_by_bit_4(mode: Mode, controlword: int, statusword: int) -> str:
    if not controlword & ControlwordBit.NEW_SETPOINT:
        return f"{BY_EDGE[mode]} 0x001F to 0x6040: bit 4 needs a 0 -> 1 change"
    if mode is Mode.PROFILE_POSITION and statusword & Status.SETPOINT_ACKNOWLEDGED:
        return "0x000F to 0x6040: the set-point was taken, and bit 4 has to fall before the next one"
    return f"0x000F to 0x6040, {BY_EDGE[mode]} 0x001F: bit 4 was set already; it needs a 0 -> 1 change"
