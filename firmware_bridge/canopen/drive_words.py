"""The bits of a CiA 402 drive's values, decoded for people: a product's tables, one way of reading them.

Source: CiA 301 (error register) and CiA 402-2 (Statusword, Controlword, modes, 0x6502).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Final, TypeAlias

from firmware_bridge.canopen import cia402
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import ControlwordBit, StateTable, Status, command_of
from firmware_bridge.canopen.emergency import NO_ERROR, RegisterBit

Words: TypeAlias = tuple[str, ...]
VOLTAGE_ENABLED: Final = 1 << 4
BITS: Final[Mapping[int, str]] = {
    VOLTAGE_ENABLED: "voltage enabled",
    Status.REMOTE: "remote",
    Status.TARGET_REACHED: "target reached",
    Status.INTERNAL_LIMIT: "internal limit active",
}
BIT_12: Final[Mapping[int, str]] = {
    cia402.Mode.PROFILE_POSITION: "set-point acknowledged",
    cia402.Mode.PROFILE_VELOCITY: "speed is zero",
    cia402.Mode.HOMING: "homing attained",
    cia402.Mode.INTERPOLATED_POSITION: "interpolation active",
    cia402.Mode.CYCLIC_POSITION: "follows the command value",
    cia402.Mode.CYCLIC_VELOCITY: "follows the command value",
    cia402.Mode.CYCLIC_TORQUE: "follows the command value",
}
BIT_13: Final[Mapping[int, str]] = {
    cia402.Mode.PROFILE_POSITION: "following error",
    cia402.Mode.HOMING: "homing error",
    cia402.Mode.CYCLIC_POSITION: "following error",
}
_CONTROL: Final[Mapping[int, Mapping[int, str]]] = {
    cia402.Mode.PROFILE_POSITION: {
        ControlwordBit.NEW_SETPOINT: "new set-point",
        ControlwordBit.CHANGE_IMMEDIATELY: "change immediately",
        ControlwordBit.RELATIVE: "relative",
    },
    cia402.Mode.HOMING: {ControlwordBit.NEW_SETPOINT: "start homing"},
    cia402.Mode.INTERPOLATED_POSITION: {ControlwordBit.NEW_SETPOINT: "enable interpolation"},
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
_HISTORY_ENTRIES: Final = range(1, 0xFF)
_CODE_MASK: Final = 0xFFFF
_MAKER_MODES_FROM: Final = 16
_STANDARD_MODES: Final = 11
BY_MODE: Final = frozenset({od.STATUSWORD, od.CONTROLWORD})
"""Objects whose bits mean something else in another mode."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveWords:
    """What the bits of a product's drives stand for."""

    states: StateTable
    modes: type[IntEnum]
    no_mode: str
    """The title of a number that is no mode."""
    bits: Mapping[int, str]
    """Statusword bits beside the state that mean the same in every mode."""
    bit_12: Mapping[int, str]
    bit_13: Mapping[int, str]
    """Their meanings by mode."""
    causes: Mapping[int, str]
    """Causes of errors by their codes."""

    def mode_of(self, value: int) -> IntEnum | None:
        """Return a mode by its number; None for one that there is not."""
        return self.modes(value) if value in set(self.modes) else None

    def title(self, mode: IntEnum | None) -> str:
        """Return a mode's name for people."""
        return self.no_mode if mode is None else mode.name.lower().replace("_", " ")

    def words(self, address: Address, value: int | str, mode: IntEnum | None = None) -> Words:
        """Return the decoded text of a value; nothing where the number itself is all that there is."""
        if isinstance(value, str):
            return ()
        if address.index == _HISTORY and address.subindex in _HISTORY_ENTRIES:
            return self._error(value)
        decode = _DECODED.get(address)
        return () if decode is None else decode(self, value, mode)

    def statusword(self, value: int, mode: IntEnum | None) -> Words:
        """Decode 0x6041."""
        state = self.states.state_of(value)
        decoded = ["no state of the drive" if state is None else state.title]
        decoded += [text for bit, text in self.bits.items() if value & bit]
        for bit, by_mode in (
            (Status.SETPOINT_ACKNOWLEDGED, self.bit_12),
            (Status.FOLLOWING_ERROR, self.bit_13),
        ):
            if value & bit:
                number = f"bit {bit.bit_length() - 1}"
                decoded.append(number if mode is None else by_mode.get(mode, number))
        return tuple(decoded)

    def controlword(self, value: int, mode: IntEnum | None) -> Words:
        """Decode 0x6040."""
        decoded = [command_of(value).value]
        if value & ControlwordBit.FAULT_RESET:
            decoded.append("fault reset")
        if value & ControlwordBit.HALT:
            decoded.append("halt")
        by_mode = {} if mode is None else _CONTROL.get(mode, {})
        return (*decoded, *(text for bit, text in by_mode.items() if value & bit))

    def register(self, value: int, _mode: IntEnum | None) -> Words:
        """Decode 0x1001."""
        return tuple(text for bit, text in _REGISTER.items() if value & bit) or ("no error",)

    def supported(self, value: int, _mode: IntEnum | None) -> Words:
        """Decode 0x6502: bit 0 is mode 1; a maker's modes, from -1 down, begin at bit 16."""
        standard = (self.mode_of(bit + 1) for bit in range(_STANDARD_MODES) if value >> bit & 1)
        maker = (
            self.mode_of(-1 - bit) for bit in range(_STANDARD_MODES) if value >> (_MAKER_MODES_FROM + bit) & 1
        )
        return tuple(self.title(mode) for mode in (*standard, *maker))

    def mode(self, value: int, _mode: IntEnum | None) -> Words:
        """Decode 0x6060 and 0x6061."""
        return (self.title(self.mode_of(value)),)

    def _error(self, value: int) -> Words:
        code = value & _CODE_MASK
        if code == NO_ERROR:
            return ("no error",)
        return (f"0x{code:04X}", self.causes.get(code, "unknown error"))


_DECODED: Final[Mapping[Address, Callable[[DriveWords, int, IntEnum | None], Words]]] = {
    od.STATUSWORD: DriveWords.statusword,
    od.CONTROLWORD: DriveWords.controlword,
    od.ERROR_REGISTER: DriveWords.register,
    od.MODE: DriveWords.mode,
    od.MODE_DISPLAY: DriveWords.mode,
    od.SUPPORTED_MODES: DriveWords.supported,
}
