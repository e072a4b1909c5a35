"""Which modes of operation an EPOS2 has: one row for each.

ASSUME: in diagnostic mode, of which nothing is published, the drive holds its position and does nothing else.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from emulators.epos2.modes.digital_position import DigitalPosition
from emulators.epos2.modes.direct import Current, Position, Velocity
from emulators.epos2.modes.homing import Homing
from emulators.epos2.modes.interpolated_position import InterpolatedPosition
from emulators.epos2.modes.mode import ModeOfOperation
from emulators.epos2.modes.profile_position import ProfilePosition
from emulators.epos2.modes.profile_velocity import ProfileVelocity
from firmware_bridge.wire.cia402 import Mode
from firmware_bridge.wire.epos2.address import Address

MODES: Final[Mapping[int, type[ModeOfOperation]]] = MappingProxyType(
    {
        Mode.INTERPOLATED_POSITION: InterpolatedPosition,
        Mode.HOMING: Homing,
        Mode.PROFILE_VELOCITY: ProfileVelocity,
        Mode.PROFILE_POSITION: ProfilePosition,
        Mode.POSITION: Position,
        Mode.VELOCITY: Velocity,
        Mode.CURRENT: Current,
        Mode.DIAGNOSTIC: ModeOfOperation,
        Mode.MASTER_ENCODER: DigitalPosition,
        Mode.STEP_DIRECTION: DigitalPosition,
    }
)
"""Every mode by its number in 0x6060."""

HEEDED: Final[tuple[Address, ...]] = tuple(
    sorted({address for mode in MODES.values() for address in mode.heeds})
)
"""Objects whose writes one of the modes heeds."""
