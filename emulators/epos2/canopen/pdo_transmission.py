"""Process data of one drive: what its PDOs carry and when they leave, made ready once per change of settings.

Source: CiA 301 v4.02, process data objects; the EPOS2 knows the transmission types 1, 253 and 255 (EPOS
Firmware Specification, by analogy; type 253 and remote requests recorded from an EPOS2). Where they are
silent: at a SYNC transmit PDOs are sampled before receive PDOs are taken over; a value that its object
refuses is dropped and the PDO's other values count; a PDO without entries is silent; remote requests know no
inhibit time.
"""

from typing import Final

from emulators.epos2.canopen.pdo_settings import ON_CHANGE, SYNCHRONOUS, PdoSettings
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.abort import SdoAbort
from firmware_bridge.wire.epos2 import address as at

EVENT_DRIVEN: Final = frozenset({at.STATUSWORD, at.MODE_DISPLAY})
"""Objects that change only when the drive is awake; every other one moves by itself."""


class ReceivePdo:
    """One valid receive PDO."""

    __slots__ = ("_accepts", "_longest", "_pending", "_unpack", "address", "size", "synchronous")

    def __init__(self, settings: PdoSettings, *, accepts_long: bool) -> None:
        layout = settings.layout()
        self.address = settings.cob_id
        self.size = layout.size
        self.synchronous = settings.transmission == SYNCHRONOUS
        self._longest = 8 if accepts_long else layout.size
        self._unpack = layout.unpack
        self._accepts = tuple(cell.accept for cell in settings.cells())
        self._pending: tuple[int, ...] = ()

    def take(self, payload: bytes) -> None:
        """Take a payload that is long enough; a synchronous PDO keeps it until the next SYNC."""
        if len(payload) > self._longest:
            return
        values = self._unpack(payload)
        if self.synchronous:
            self._pending = values
        else:
            self._apply(values)

    def sync(self) -> None:
        """Take over what waits for SYNC."""
        values, self._pending = self._pending, ()
        if values:
            self._apply(values)

    def forget(self) -> None:
        """Drop what waits for SYNC."""
        self._pending = ()

    def _apply(self, values: tuple[int, ...]) -> None:
        for place, accept in enumerate(self._accepts):
            try:
                accept(values[place])
            except SdoAbort:
                continue


class TransmitPdo:
    """One valid transmit PDO with at least one entry."""

    __slots__ = (
        "_allowed",
        "_inhibit",
        "_known",
        "_last",
        "_moving",
        "_pack",
        "_poll",
        "_reads",
        "address",
        "answers_remote",
        "due",
        "on_change",
        "synchronous",
    )

    def __init__(self, settings: PdoSettings, poll: Nanoseconds) -> None:
        cells = settings.cells()
        self.address = settings.cob_id
        self.answers_remote = settings.answers_remote
        self.synchronous = settings.transmission == SYNCHRONOUS
        self.on_change = settings.transmission == ON_CHANGE
        self._inhibit = settings.inhibit
        self._moving = any(cell.row.address not in EVENT_DRIVEN for cell in cells)
        self._poll = max(poll, self._inhibit) if self._moving else NEVER
        self._pack = settings.layout().pack
        self._reads = tuple(cell.live for cell in cells)
        self._last: bytes | None = None
        self._known = -1
        """The store's count of changes that the last look has seen, where nothing moves by itself."""
        self._allowed: Nanoseconds = 0
        self.due: Nanoseconds = NEVER

    def payload(self) -> bytes:
        """Return what the mapped objects hold now."""
        return self._pack(*[read() for read in self._reads])

    def begin(self, *, sends: bool) -> None:
        """Enter Operational, with or without a first message."""
        self._last = None if sends else self.payload()
        self._known = -1
        self._allowed = 0

    def rest(self) -> None:
        """Leave Operational."""
        self.due = NEVER

    def look(self, now: Nanoseconds, changes: int) -> bytes | None:
        """Return the payload if it has changed and the inhibit time is over; `due`: when to look again.

        `changes` is the store's count of them.
        """
        if changes == self._known and self.due == NEVER:
            return None
        if not self._moving:
            self._known = changes
        payload = self.payload()
        if payload != self._last:
            if now < self._allowed:
                self.due = self._allowed
                return None
            self._last = payload
            self._allowed = now + self._inhibit
            self.due = NEVER if self._poll == NEVER else now + self._poll
            return payload
        self.due = NEVER if self._poll == NEVER else now + self._poll
        return None

    def requested(self) -> bytes:
        """Return the payload for a remote request; a PDO on change has then told it."""
        self._last = self.payload()
        return self._last
