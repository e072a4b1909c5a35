"""A drive in interpolated position mode with its buffer enabled, and how it is fed."""

from typing import TYPE_CHECKING

import pytest

from emulators.epos2.modes.interpolation_buffer import BUFFER_CLEAR, BUFFER_STATUS, DATA_RECORD
from emulators.epos2.objects.device_profile import BUFFER_SIZE
from firmware_bridge.families.epos2.wire.pvt import PvtRecord

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

REACHED, ACTIVE_BIT = 0x0400, 0x1000
UNDERFLOW_WARNING, OVERFLOW_WARNING, VELOCITY_WARNING, ACCELERATION_WARNING = 1, 2, 4, 8
UNDERFLOW, OVERFLOW, VELOCITY, ACCELERATION = 0x100, 0x200, 0x400, 0x800
ENABLED, ACTIVE = 0x4000, 0x8000
ERROR = 0xFF0C


@pytest.fixture
def ready(drive: "Drive") -> "Drive":
    """Facts 4.5: mode 7, 0x06, 0x0F, buffer enabled."""
    return prepared(drive)


def prepared(drive: "Drive") -> "Drive":
    drive.store.set(BUFFER_SIZE, 64)
    drive.enable(mode=7)
    drive.write(BUFFER_CLEAR, 1)
    return drive


def feed(drive: "Drive", *records: tuple[int, int, int]) -> None:
    for position, velocity, ms in records:
        drive.write(DATA_RECORD, int.from_bytes(PvtRecord(position, velocity, ms).encode(), "little"))


def status(drive: "Drive") -> int:
    return drive.read(BUFFER_STATUS)
