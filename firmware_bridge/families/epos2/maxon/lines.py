"""The choice of a serial line's ends by its protocol."""

from collections.abc import Callable

from firmware_bridge.families.epos2.maxon.end import DeviceEnd, HostEnd
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.maxon.v1 import V1Device, V1Host
from firmware_bridge.families.epos2.maxon.v2 import V2Device, V2Host
from firmware_bridge.units import Nanoseconds


def device_end(generation: Generation, timeout: Callable[[], Nanoseconds], bad_checksum: int) -> DeviceEnd:
    """Return the drive's end; `timeout` is called at each start of one, `bad_checksum` is V2's complaint."""
    if generation is Generation.V1:
        return V1Device(timeout)
    return V2Device(timeout, bad_checksum)


def host_end(generation: Generation, timeout: Nanoseconds) -> HostEnd:
    """Return the host's end, which waits `timeout` for each step of the device."""
    return V1Host(timeout) if generation is Generation.V1 else V2Host(timeout)
