"""The bits of an object's value, decoded.

Sources: EPOS Firmware Specification (state machine, modes; by analogy), maxon's command library for the modes
that are the maker's own.
"""

from collections.abc import Callable, Mapping
from enum import IntEnum
from types import MappingProxyType
from typing import Final, TypeAlias

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import ControlwordBit, Status, command_of
from firmware_bridge.canopen.emergency import NO_ERROR, RegisterBit
from firmware_bridge.families.epos2.wire.emergency import EMERGENCIES
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.families.epos2.wire.power_states import state_of

Words: TypeAlias = tuple[str, ...]
_VOLTAGE_ENABLED: Final = 1 << 4
_BITS: Final[Mapping[int, str]] = {
    _VOLTAGE_ENABLED: "power stage on",
    Status.REMOTE: "remote (NMT operational)",
    Status.TARGET_REACHED: "target reached",
    Status.INTERNAL_LIMIT: "current limited (I2t)",
    Status.REFERENCED: "position referenced to home",
}
_BIT_12: Final[Mapping[IntEnum, str]] = {
    Mode.PROFILE_POSITION: "set-point acknowledged",
    Mode.PROFILE_VELOCITY: "speed is zero",
    Mode.HOMING: "homing attained",
    Mode.INTERPOLATED_POSITION: "interpolation active",
}
_BIT_13: Final[Mapping[IntEnum, str]] = {
    Mode.PROFILE_POSITION: "following error",
    Mode.POSITION: "following error",
    Mode.HOMING: "homing error",
}
_CONTROL: Final[Mapping[IntEnum, Mapping[int, str]]] = {
    Mode.PROFILE_POSITION: {
        ControlwordBit.NEW_SETPOINT: "new set-point",
        ControlwordBit.CHANGE_IMMEDIATELY: "change immediately",
        ControlwordBit.RELATIVE: "relative",
    },
    Mode.HOMING: {ControlwordBit.NEW_SETPOINT: "start homing"},
    Mode.INTERPOLATED_POSITION: {ControlwordBit.NEW_SETPOINT: "enable interpolation"},
}
_REGISTER: Final = {
    RegisterBit.GENERIC: "generic",
    RegisterBit.CURRENT: "current",
    RegisterBit.VOLTAGE: "voltage",
    RegisterBit.TEMPERATURE: "temperature",
    RegisterBit.COMMUNICATION: "communication",
    RegisterBit.PROFILE: "device profile",
    RegisterBit.MANUFACTURER: "manufacturer",
}
_HISTORY: Final = 0x1003
_CODE_MASK: Final = 0xFFFF
_MAKER_MODES_FROM: Final = 16
_STANDARD_MODES: Final = 10


def mode_of(value: int) -> Mode | None:
    """Return a mode by its number; None for one that there is not."""
    return Mode(value) if value in set(Mode) else None


def title(mode: IntEnum | None) -> str:
    """Return a mode's name for people."""
    return "no mode of the EPOS2" if mode is None else mode.name.lower().replace("_", " ")


def _statusword(value: int, mode: IntEnum | None) -> Words:
    state = state_of(value)
    decoded = ["no state of the drive" if state is None else state.title]
    decoded += [text for bit, text in _BITS.items() if value & bit]
    for bit, by_mode in ((Status.SETPOINT_ACKNOWLEDGED, _BIT_12), (Status.FOLLOWING_ERROR, _BIT_13)):
        if value & bit:
            number = bit.bit_length() - 1
            decoded.append(f"bit {number}" if mode is None else by_mode.get(mode, f"bit {number}"))
    return tuple(decoded)


def _controlword(value: int, mode: IntEnum | None) -> Words:
    decoded = [command_of(value).value]
    if value & ControlwordBit.FAULT_RESET:
        decoded.append("fault reset")
    if value & ControlwordBit.HALT:
        decoded.append("halt")
    by_mode = {} if mode is None else _CONTROL.get(mode, {})
    return (*decoded, *(text for bit, text in by_mode.items() if value & bit))


def _register(value: int, _mode: IntEnum | None) -> Words:
    return tuple(text for bit, text in _REGISTER.items() if value & bit) or ("no error",)


def _error(value: int, _mode: IntEnum | None) -> Words:
    code = value & _CODE_MASK
    if code == NO_ERROR:
        return ("no error",)
    known = EMERGENCIES.get(code)
    return (f"0x{code:04X}", "unknown error" if known is None else known.cause)


def _modes(value: int, _mode: IntEnum | None) -> Words:
    # 0x6502: bit 0 is mode 1; the maker's modes, from -1 down, begin at bit 16.
    standard = (mode_of(bit + 1) for bit in range(_STANDARD_MODES) if value >> bit & 1)
    maker = (mode_of(-1 - bit) for bit in range(_STANDARD_MODES) if value >> (_MAKER_MODES_FROM + bit) & 1)
    return tuple(title(mode) for mode in (*standard, *maker))


def _mode(value: int, _mode: IntEnum | None) -> Words:
    return (title(mode_of(value)),)


DECODED: Final[Mapping[Address, Callable[[int, IntEnum | None], Words]]] = MappingProxyType(
    {
        od.STATUSWORD: _statusword,
        od.CONTROLWORD: _controlword,
        od.ERROR_REGISTER: _register,
        od.MODE: _mode,
        od.MODE_DISPLAY: _mode,
        od.SUPPORTED_MODES: _modes,
        **{Address(_HISTORY, subindex): _error for subindex in range(1, 6)},
    }
)
"""Objects whose bits have names, and what gives them; some need the mode that the drive is in."""
BY_MODE: Final = frozenset({od.STATUSWORD, od.CONTROLWORD})
"""Those of them that need the mode."""


def words(address: Address, value: int | str, mode: IntEnum | None = None) -> Words:
    """Return the decoded text of a value; nothing where the number itself is all that there is."""
    decode = DECODED.get(address)
    return () if decode is None or isinstance(value, str) else decode(value, mode)
