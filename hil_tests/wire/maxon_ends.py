"""Both ends of a serial line, and one command as each protocol writes it."""

import pytest

from firmware_bridge.families.epos2.maxon.end import DeviceEnd
from firmware_bridge.families.epos2.maxon.frame import Frame, Generation
from firmware_bridge.families.epos2.maxon.lines import device_end
from firmware_bridge.units import MILLISECOND, Nanoseconds

TIMEOUT: Nanoseconds = 500 * MILLISECOND
BAD_CHECKSUM = 0x0504_0004
both = pytest.mark.parametrize("generation", Generation)


def device(generation: Generation = Generation.V1) -> DeviceEnd:
    return device_end(generation, lambda: TIMEOUT, BAD_CHECKSUM)


READ = Frame(0x10, bytes.fromhex("41600001"))
REQUESTED_V1 = bytes.fromhex("1001 41600001 ABF0")
REQUESTED_V2 = bytes.fromhex("9002 1002 41600001 64CF")
REQUESTED = {Generation.V1: REQUESTED_V1, Generation.V2: REQUESTED_V2}
