"""Emergency producer: error register 0x1001, history 0x1003, the message itself.

Source: CiA 301 v4.02, emergency object. The five bytes of the maker are 0.
"""

from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.product import Product
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.cia301 import (
    COB_ID_INVALID,
    COB_ID_MASK,
    SYNC,
    EmergencyMessage,
    encode_emergency,
)
from firmware_bridge.canopen.emergency import NO_ERROR, Emergency, FaultReaction, Recovery, RegisterBit

_FORBIDDEN: Final = (
    range(SYNC + 1),
    range(0x101, 0x181),
    range(0x581, 0x600),
    range(0x601, 0x680),
    range(0x6E0, 0x800),
)
"""Identifiers that CiA 301 keeps for other services, and that of SYNC."""


class EmergencyProducer:
    """Emergency producer of one device: it keeps the errors and writes the emergency messages."""

    def __init__(self, store: ObjectStore, product: Product) -> None:
        self._store = store
        self._rows = product.emergencies
        self._reports_reset = product.reports_reset
        self._history = store.objects.entries(od.ERROR_HISTORY_COUNT.index)
        self._standing: tuple[int, ...] = ()
        store.on_write(od.ERROR_HISTORY_COUNT, self._clear_history)
        store.on_write(od.COB_ID_EMERGENCY, self._check_cob_id)

    @property
    def cob_id(self) -> int | None:
        """Return the identifier of the message; None while 0x1014 switches it off."""
        word = self._store.get(od.COB_ID_EMERGENCY)
        return None if word & COB_ID_INVALID else word & COB_ID_MASK

    def reset(self) -> None:
        """Begin as after power-on: no errors, no history."""
        self._standing = ()
        self._publish()
        self._store.set(od.ERROR_HISTORY_COUNT, 0)
        for address in self._history:
            self._store.set(address, 0)

    def communication_reset(self) -> None:
        """Forget the errors that reset communication ends, and those that had no effect on the motor."""
        self._standing = tuple(code for code in self._standing if not _ends(self._rows.get(code)))
        self._publish()

    def message(self, code: int) -> bytes | None:
        """Note an error, or with code 0 the end of all; return the message, None where none is sent."""
        if code == NO_ERROR:
            self._standing = ()
            self._publish()
            return encode_emergency(EmergencyMessage(code, 0)) if self._reports_reset else None
        if code not in self._standing:
            self._standing = (*self._standing, code)
        self._publish()
        self._remember(code)
        return encode_emergency(EmergencyMessage(code, self._store.get(od.ERROR_REGISTER)))

    def _publish(self) -> None:
        register = 0
        for code in self._standing:
            row = self._rows.get(code)
            register |= RegisterBit.GENERIC if row is None else row.register
        self._store.set(od.ERROR_REGISTER, register)

    def _remember(self, code: int) -> None:
        store = self._store
        # Newest first (CiA 301, 0x1003): the oldest is dropped.
        older = [store.get(address) for address in self._history[:-1]]
        for address, value in zip(self._history, (code, *older), strict=True):
            store.set(address, value)
        count = store.get(od.ERROR_HISTORY_COUNT) + 1
        store.set(od.ERROR_HISTORY_COUNT, min(count, len(self._history)))

    def _clear_history(self, value: int) -> None:
        # CiA 301: only 0 may be written to 0x1003:00, and clears the history.
        if value != 0:
            raise SdoAbort(AbortCode.RANGE, od.ERROR_HISTORY_COUNT)
        for address in self._history:
            self._store.set(address, 0)

    def _check_cob_id(self, word: int) -> None:
        number = word & ~COB_ID_INVALID
        if number > COB_ID_MASK or any(number in each for each in _FORBIDDEN):
            raise SdoAbort(AbortCode.RANGE, od.COB_ID_EMERGENCY)


def _ends(row: Emergency | None) -> bool:
    return row is not None and (
        row.recovery is Recovery.RESET_COMMUNICATION or row.reaction is FaultReaction.NONE
    )
