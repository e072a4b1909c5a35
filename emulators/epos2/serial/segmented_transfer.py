"""A segmented transfer between the serial host and the drive on its line: one at a time, 63 bytes a segment.

Assumed: a wrong toggle bit or length ends the transfer, and without one a segment is an unknown command.
"""

from dataclasses import dataclass, field

from emulators.canopen.object_store import ObjectStore
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.maxon.messages import (
    DIRECT_SEGMENT,
    SegmentOut,
    SegmentRead,
    SegmentTaken,
    SegmentWrite,
    control,
    length_of,
    toggle_of,
)


@dataclass(slots=True)
class _SegmentedRead:
    address: Address
    rest: bytes
    toggle: bool = False


@dataclass(slots=True)
class _SegmentedWrite:
    address: Address
    length: int
    taken: bytearray = field(default_factory=bytearray)
    toggle: bool = False


def payload_of(segment: SegmentWrite) -> bytes:
    """Return a segment's payload; SdoAbort where it is shorter than its length field."""
    length = length_of(segment)
    if len(segment.raw) < length:
        raise SdoAbort(AbortCode.TOO_SHORT)
    return segment.raw[:length]


class SegmentedTransfer:
    """An object that the host reads or writes piece by piece."""

    def __init__(self, store: ObjectStore) -> None:
        self._store = store
        self._under_way: _SegmentedRead | _SegmentedWrite | None = None

    def end(self) -> None:
        """Forget a transfer that is under way."""
        self._under_way = None

    def begin_read(self, address: Address) -> None:
        """Take the object's bytes as they are now; SdoAbort."""
        # An earlier transfer ends also where the new one is refused.
        self._under_way = None
        self._under_way = _SegmentedRead(address, self._store.read(address))

    def begin_write(self, address: Address, length: int) -> None:
        """Expect so many bytes; SdoAbort where the object does not take them."""
        self._under_way = None
        self._store.check_writable(address, length)
        self._under_way = _SegmentedWrite(address, length)

    def read(self, segment: SegmentRead) -> SegmentOut:
        """Return the next segment; SdoAbort."""
        transfer = self._under_way
        if not isinstance(transfer, _SegmentedRead):
            raise SdoAbort(AbortCode.UNKNOWN_COMMAND)
        self._check(transfer, toggle=toggle_of(segment))
        chunk, transfer.rest = transfer.rest[:DIRECT_SEGMENT], transfer.rest[DIRECT_SEGMENT:]
        if not transfer.rest:
            self._under_way = None
        head = control(len(chunk), toggle=toggle_of(segment), more=bool(transfer.rest))
        return SegmentOut(0, head, chunk)

    def write(self, segment: SegmentWrite) -> SegmentTaken:
        """Take the next segment, with the last one write the object; SdoAbort."""
        transfer = self._under_way
        if not isinstance(transfer, _SegmentedWrite):
            raise SdoAbort(AbortCode.UNKNOWN_COMMAND)
        self._check(transfer, toggle=toggle_of(segment))
        self._under_way = None  # until the segment has been taken
        chunk = payload_of(segment)
        transfer.taken += chunk
        if len(transfer.taken) > transfer.length:
            raise SdoAbort(AbortCode.TOO_LONG, transfer.address)
        if len(transfer.taken) == transfer.length:
            self._store.write(transfer.address, bytes(transfer.taken))
        else:
            self._under_way = transfer
        return SegmentTaken(0, control(len(chunk), toggle=toggle_of(segment)))

    def _check(self, transfer: _SegmentedRead | _SegmentedWrite, *, toggle: bool) -> None:
        if toggle is not transfer.toggle:
            self._under_way = None
            raise SdoAbort(AbortCode.TOGGLE, transfer.address)
        transfer.toggle = not transfer.toggle
