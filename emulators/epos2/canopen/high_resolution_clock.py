"""The drive's high-resolution clock 0x1013: microseconds at the last SYNC, corrected by each write.

Source: application note Interpolation Position Mode, December 2008, p. 11 and 21. Its real resolution is one
bit time of the bus; here it is 1 us. Assumed: the emulated drive's own clock does not drift, so that a
correction moves the time stamps and leaves a path that runs as it is.
"""

from typing import Final

from emulators.canopen.object_store import ObjectStore
from firmware_bridge.canopen.address import Address
from firmware_bridge.units import MICROSECOND, Nanoseconds

TIME_STAMP: Final = Address(0x1013)


class HighResolutionClock:
    """Counter of microseconds from power-on that wraps after 2^32."""

    def __init__(self, store: ObjectStore) -> None:
        self._latched = 0
        self._correction = 0
        store.on_read(TIME_STAMP, lambda: self._latched)
        store.on_write(TIME_STAMP, self._correct)

    def latch(self, now: Nanoseconds) -> None:
        """Note the time of a SYNC."""
        # The sum binds before the mask: 32 bits of microseconds wrap after 71.6 minutes.
        self._latched = now // MICROSECOND + self._correction & 0xFFFF_FFFF

    def _correct(self, master: int) -> None:
        """Take the master's time at the last SYNC; from now on the clock agrees with it."""
        # It may be negative, and is not masked: `latch` masks the sum.
        self._correction += master - self._latched
        self._latched = master
