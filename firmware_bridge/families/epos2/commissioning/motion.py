"""The writes that may set a motor in motion, or release one, so that the user must confirm first.

The drive's state is not considered: it can change between a look and the write.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import ControlwordCommand, command_of
from firmware_bridge.families.epos2.wire import address as at

_SETS: Final = "an enabled drive follows it at once"
MOVING: Final[Mapping[Address, str]] = MappingProxyType(
    {
        at.CURRENT_MODE_SETTING: _SETS,
        at.POSITION_MODE_SETTING: _SETS,
        at.VELOCITY_MODE_SETTING: _SETS,
        od.TARGET_VELOCITY: _SETS,
        od.MODE: "an enabled drive goes over to the new mode's set-point",
        Address(0x2078, 1): "an output may hold a brake",
        Address(0x207D): "an enabled drive may follow an analog input",
        **{Address(0x2079, pin): "an output may hold a brake" for pin in range(1, 6)},
        **{Address(0x2300, sub): "an enabled drive may follow the other encoder" for sub in range(2, 6)},
    }
)
"""Objects whose writes may move something, and why."""


_RESTING: Final = frozenset({od.TARGET_VELOCITY, at.VELOCITY_MODE_SETTING})
"""Of these zero means rest, and what stops must not wait for an answer."""


def why_it_may_move(address: Address, raw: bytes) -> str | None:
    """Return why writing this may set something in motion; None where it does not."""
    if address == od.CONTROLWORD:
        # Only enabling moves: a stop or a switch-off must not be held up by a question.
        enables = command_of(int.from_bytes(raw[:2], "little")) is ControlwordCommand.ENABLE_OPERATION
        return "it enables operation, and may start a move" if enables else None
    if address in _RESTING and not any(raw):
        return None
    return MOVING.get(address)
