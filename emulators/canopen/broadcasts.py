"""SYNC and TIME as one device takes them: their identifiers, and the time of day that TIME has given.

Source: CiA 301 v4.02, 0x1005 and 0x1012. A device takes TIME where bit 31 of 0x1012 is set. It sends neither:
bit 30 is refused, and so are identifiers of 29 bits. A SYNC of any length is taken.
"""

from datetime import datetime, timedelta
from functools import partial
from typing import Final

from emulators.canopen.object_store import ObjectStore
from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.time_of_day import decode_time
from firmware_bridge.units import MICROSECOND, Nanoseconds

PRODUCES: Final = 1 << 30
CONSUMES: Final = 1 << 31


class Broadcasts:
    """Identifiers of SYNC and TIME, and the device's time of day."""

    def __init__(self, store: ObjectStore) -> None:
        self._store: Final = store
        self._touched = False
        self._given: tuple[datetime, Nanoseconds] | None = None
        for address in (od.COB_ID_SYNC, od.COB_ID_TIME):
            if address in store.objects:
                store.on_write(address, partial(self._take, address))

    @property
    def sync(self) -> int:
        """The identifier of SYNC; the standard's where there is no 0x1005."""
        if od.COB_ID_SYNC not in self._store.objects:
            return cia301.SYNC
        return self._store.get(od.COB_ID_SYNC) & cia301.COB_ID_MASK

    @property
    def time(self) -> int | None:
        """The identifier of TIME; None where the device does not take it."""
        word = self._store.get(od.COB_ID_TIME) if od.COB_ID_TIME in self._store.objects else 0
        return word & cia301.COB_ID_MASK if word & CONSUMES else None

    def renew(self) -> bool:
        """Return whether an identifier may have changed since the last question."""
        touched, self._touched = self._touched, False
        return touched

    def set_time(self, payload: bytes, now: Nanoseconds) -> None:
        """Take the payload of TIME; one that is too short changes nothing."""
        time = decode_time(payload)
        if time is not None:
            self._given = time, now

    def time_of_day(self, now: Nanoseconds) -> datetime | None:
        """Return the time of day; None before the first TIME."""
        if self._given is None:
            return None
        time, taken = self._given
        return time + timedelta(microseconds=(now - taken) // MICROSECOND)

    def forget(self) -> None:
        """Begin without a time of day, as after power-on."""
        self._given = None

    def _take(self, address: Address, word: int) -> None:
        if word & (PRODUCES | cia301.COB_ID_EXTENDED):
            raise SdoAbort(AbortCode.RANGE, address)
        self._touched = True
