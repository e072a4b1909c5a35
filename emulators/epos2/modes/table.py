"""The modes of operation of an EPOS2 by their numbers in 0x6060.

Assumed: in diagnostic mode, of which nothing is published, the drive holds its position and does no more.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from emulators.drive.mode import ModeOfOperation
from emulators.drive.profile_velocity import ProfileVelocity
from emulators.drive.shaft import Impossible
from emulators.epos2.modes.digital_position import DigitalPosition
from emulators.epos2.modes.direct import CurrentMode, PositionMode, VelocityMode
from emulators.epos2.modes.homing import MaxonHoming
from emulators.epos2.modes.interpolated_position import InterpolatedPosition
from emulators.epos2.modes.profile_position import WrittenPosition
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire import emergency
from firmware_bridge.families.epos2.wire.modes import Mode

MODES: Final[Mapping[int, type[ModeOfOperation]]] = MappingProxyType(
    {
        Mode.INTERPOLATED_POSITION: InterpolatedPosition,
        Mode.HOMING: MaxonHoming,
        Mode.PROFILE_VELOCITY: ProfileVelocity,
        Mode.PROFILE_POSITION: WrittenPosition,
        Mode.POSITION: PositionMode,
        Mode.VELOCITY: VelocityMode,
        Mode.CURRENT: CurrentMode,
        Mode.DIAGNOSTIC: ModeOfOperation,
        Mode.MASTER_ENCODER: DigitalPosition,
        Mode.STEP_DIRECTION: DigitalPosition,
    }
)

HEEDED: Final[tuple[Address, ...]] = tuple(
    sorted({address for mode in MODES.values() for address in mode.heeds})
)
"""Objects whose writes one of the modes heeds."""

IMPOSSIBLE: Final = Impossible(outside=emergency.POSITION_LIMIT, too_far=emergency.SOFTWARE_PARAMETER)
