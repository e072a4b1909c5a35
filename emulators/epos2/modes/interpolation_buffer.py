"""The buffer of interpolated position mode: records in, one after the other out, and its objects.

Sources: application note Interpolation Position Mode, December 2008; maxon EDS (0x20C1, 0x20C4, 0x60C4).
Where they are silent:
* a record counts until the segment that begins with it is over;
* a record for a buffer without access is refused with 0x08000022, one for a full buffer with 0x05040005, and
  the overflow is an error of the mode, too;
* an error clears the buffer and takes the access away; its status bit stays until 0x60C4:06 is written again;
* the underflow warning stands while there are fewer records than 0x20C4:02, the overflow warning while there
  are more than 0x20C4:03, both only with access;
* 0x60C4:04 is the number of records that wait; a write to it has no effect.
"""

from collections.abc import Callable
from enum import IntFlag
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.objects.device_profile import BUFFER_FREE, BUFFER_SIZE
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire.pvt import PvtRecord

DATA_RECORD: Final = Address(0x20C1)
BUFFER_STATUS: Final = Address(0x20C4, 1)
UNDERFLOW_LEVEL: Final = Address(0x20C4, 2)
OVERFLOW_LEVEL: Final = Address(0x20C4, 3)
BUFFER_POSITION: Final = Address(0x60C4, 4)
BUFFER_CLEAR: Final = Address(0x60C4, 6)


class BufferStatus(IntFlag):
    """Bits of 0x20C4:01."""

    UNDERFLOW_WARNING = 1 << 0
    OVERFLOW_WARNING = 1 << 1
    VELOCITY_WARNING = 1 << 2
    ACCELERATION_WARNING = 1 << 3
    UNDERFLOW_ERROR = 1 << 8
    OVERFLOW_ERROR = 1 << 9
    VELOCITY_ERROR = 1 << 10
    ACCELERATION_ERROR = 1 << 11
    ENABLED = 1 << 14
    ACTIVE = 1 << 15


class InterpolationBuffer:
    """First in, first out."""

    def __init__(self, store: ObjectStore, overflow: Callable[[], None]) -> None:
        """Attach to the store; `overflow` is called for a record that found no place."""
        self._store = store
        self.records: list[PvtRecord] = []
        """The first one begins the segment that runs, or would."""
        self.enabled = False
        self.active = False
        """A path is being run."""
        self.warnings = BufferStatus(0)
        """Velocity and acceleration warnings of the segment that runs."""
        self.errors = BufferStatus(0)
        self._overflow = overflow
        store.on_write(DATA_RECORD, self._take)
        store.on_write(BUFFER_CLEAR, self._set_access)
        store.on_read(BUFFER_STATUS, self._status)
        store.on_read(BUFFER_FREE, lambda: max(0, store.get(BUFFER_SIZE) - len(self.records)))
        store.on_read(BUFFER_POSITION, lambda: len(self.records))

    def restart(self) -> None:
        """Begin as after power-on: empty, without access."""
        self._set_access(0)
        self.end()

    def end(self) -> None:
        """Note that the path is over, whatever ended it."""
        self.active = False
        self.warnings = BufferStatus(0)

    def fail(self, error: BufferStatus) -> None:
        """Note an error: the records are gone, and so is the access."""
        self.errors |= error
        self.records.clear()
        self.enabled = False
        self.end()

    def _take(self, word: int) -> None:
        if not self.enabled:
            raise SdoAbort(AbortCode.DEVICE_STATE, DATA_RECORD)
        if len(self.records) >= self._store.get(BUFFER_SIZE):
            self._overflow()
            raise SdoAbort(AbortCode.OUT_OF_MEMORY, DATA_RECORD)
        self.records.append(PvtRecord.decode(word))

    def _set_access(self, enabled: int) -> None:
        self.enabled = bool(enabled)
        # Either value of 0x60C4:06 clears the errors: a new access begins without the former ones.
        self.errors = BufferStatus(0)
        if not enabled:
            self.records.clear()

    def _status(self) -> int:
        status = self.warnings | self.errors
        if self.active:
            status |= BufferStatus.ACTIVE
        if self.enabled:
            status |= BufferStatus.ENABLED
            if len(self.records) < self._store.get(UNDERFLOW_LEVEL):
                status |= BufferStatus.UNDERFLOW_WARNING
            if len(self.records) > self._store.get(OVERFLOW_LEVEL):
                status |= BufferStatus.OVERFLOW_WARNING
        return int(status)
