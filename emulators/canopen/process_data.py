"""Process data of one device: contents and instants of its PDOs, made ready once per change of settings.

Source: CiA 301 v4.02, process data objects; v4.2 for the time-out of receive PDOs. Where it is silent: at a
SYNC transmit PDOs are sampled before receive PDOs are taken over; a value that its object refuses is dropped
and the PDO's other values count; a PDO without entries is silent; remote requests know no inhibit time; the
first SYNC in Operational sends a PDO of type 0, and is the first of those that types 1 to 240 count; the
event timer of a transmit PDO runs from the start on, a receive PDO's from its first message; before a SYNC a
PDO of type 252 answers with the present values.
"""

from collections.abc import Callable
from functools import partial
from typing import Final, TypeAlias

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.pdo_settings import RECEIVE, TRANSMIT, PdoSettings
from emulators.canopen.product import Product
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import SdoAbort
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.canopen.pdo import AT_SYNC_IF_CHANGED, EVENT_DRIVEN, SAMPLED_AT_SYNC, SYNCHRONOUS
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.can import REMOTE

AWAKE: Final = frozenset({od.STATUSWORD, od.MODE_DISPLAY})
"""Objects that change only when the device is awake; every other one moves by itself."""


class ReceivePdo:
    """One valid receive PDO."""

    def __init__(self, settings: PdoSettings, *, accepts_long: bool) -> None:
        layout = settings.layout()
        self.address = settings.cob_id
        self.size = layout.size
        self.synchronous = settings.transmission in SYNCHRONOUS
        self._timeout = settings.event_timer
        self.timed = self._timeout > 0
        self.due: Nanoseconds = NEVER
        """Time at which it is missed."""
        self._longest = 8 if accepts_long else layout.size
        self._unpack = layout.unpack
        self._accepts = tuple(cell.accept for cell in settings.cells())
        self._pending: tuple[int, ...] = ()

    def take(self, payload: bytes, now: Nanoseconds) -> None:
        """Take a payload that is long enough; a synchronous PDO keeps it until the next SYNC."""
        if self.timed:
            self.due = now + self._timeout
        if len(payload) > self._longest:
            return
        values = self._unpack(payload)
        if self.synchronous:
            self._pending = values
        else:
            self._apply(values)

    def sync(self) -> None:
        """Take over what waits for SYNC."""
        # Taken once: without a new frame the next SYNC changes nothing.
        values, self._pending = self._pending, ()
        if values:
            self._apply(values)

    def forget(self) -> None:
        """Drop what waits for SYNC, and miss nothing."""
        self._pending = ()
        self.due = NEVER

    def _apply(self, values: tuple[int, ...]) -> None:
        for place, accept in enumerate(self._accepts):
            try:
                accept(values[place])
            except SdoAbort:
                continue


class TransmitPdo:
    """One valid transmit PDO with at least one entry."""

    def __init__(self, settings: PdoSettings, poll: Nanoseconds) -> None:
        cells = settings.cells()
        self.address = settings.cob_id
        self.answers_remote = settings.answers_remote
        self.synchronous = settings.transmission in SYNCHRONOUS or settings.transmission == SAMPLED_AT_SYNC
        self.on_change = settings.transmission in EVENT_DRIVEN
        self._type = settings.transmission
        self._syncs = 0
        """SYNCs until the next message, of types 1 to 240."""
        self._sample: bytes | None = None
        """What type 252 sends: the values of the last SYNC."""
        self._inhibit = settings.inhibit
        self._period = settings.event_timer
        self._event: Nanoseconds = NEVER
        """Time at which the event timer has passed."""
        self._moving = any(cell.row.address not in AWAKE for cell in cells)
        # Such values raise no event: they are compared at intervals, no shorter than they may be sent.
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
        self._event = NEVER
        self._syncs = 1
        self._sample = None

    def rest(self) -> None:
        """Leave Operational."""
        self.due = NEVER

    def sync(self) -> bytes | None:
        """Return what leaves at this SYNC, if anything does."""
        if self._type == SAMPLED_AT_SYNC:
            self._sample = self.payload()
            return None
        if self._type == AT_SYNC_IF_CHANGED:
            payload = self.payload()
            changed, self._last = payload != self._last, payload
            return payload if changed else None
        self._syncs -= 1
        if self._syncs:
            return None
        self._syncs = self._type
        return self.payload()

    def look(self, now: Nanoseconds, changes: int) -> bytes | None:
        """Return the payload if it is to be sent and the inhibit time is over; `due`: when to look again.

        `changes` is the store's count of them.
        """
        # The usual case, with every frame on the bus: nothing has changed.
        if changes == self._known and self.due == NEVER:
            return None
        if not self._moving:
            self._known = changes
        if self._period and self._event == NEVER:
            self._event = now + self._period
        payload = self.payload()
        if payload != self._last or now >= self._event:
            if now < self._allowed:
                # Inhibited: what is sent then are the values of that instant, not these.
                self.due = self._allowed
                return None
            self._last = payload
            self._allowed = now + self._inhibit
            self._event = now + self._period if self._period else NEVER
            self.due = self._next(now)
            return payload
        self.due = self._next(now)
        return None

    def _next(self, now: Nanoseconds) -> Nanoseconds:
        return min(self._event, NEVER if self._poll == NEVER else now + self._poll)

    def requested(self) -> bytes:
        """Return the payload for a remote request; an event-driven PDO has then sent it."""
        self._last = self.payload() if self._sample is None else self._sample
        return self._last


FrameHandler: TypeAlias = Callable[[bytes, Nanoseconds], None]
"""Handler of a frame's payload and its time of arrival."""


class ProcessData:
    """The PDOs that `PdoSettings` describe, built again after each change of those."""

    def __init__(self, store: ObjectStore, product: Product, state: Callable[[], NmtState]) -> None:
        self._store = store
        self._product = product
        self._state = state
        self._touched: list[int] = []
        owned = [(each, number) for each in (RECEIVE, TRANSMIT) for number in each.numbers(store)]
        self._settings = tuple(
            PdoSettings(store, each, number, product, state=state, touched=self._toucher(place))
            for place, (each, number) in enumerate(owned)
        )
        self._receivers: Final = len(RECEIVE.numbers(store))
        self._receive: list[ReceivePdo | None] = [None] * self._receivers
        self._transmit: list[TransmitPdo | None] = [None] * (len(owned) - self._receivers)
        self.receive: tuple[ReceivePdo, ...] = ()
        """Valid receive PDOs."""
        self.transmit: tuple[TransmitPdo, ...] = ()
        """Valid transmit PDOs that carry something."""
        self.waits_for_sync = False
        """True if some receive PDO takes effect at SYNC."""
        self._at_sync: tuple[TransmitPdo, ...] = ()
        self._on_change: tuple[TransmitPdo, ...] = ()
        self._timed: tuple[ReceivePdo, ...] = ()
        self.touch_all()
        self.renew()

    def _toucher(self, place: int) -> Callable[[], None]:
        return lambda: self._touched.append(place)

    def touch_all(self) -> None:
        """Mark every PDO to be built again: its objects changed without hooks."""
        self._touched.extend(range(len(self._settings)))

    def renew(self) -> bool:
        """Make the touched PDOs ready; True when there were any."""
        if not self._touched:
            return False
        for place in sorted(set(self._touched)):
            settings = self._settings[place]
            if place < self._receivers:
                self._receive[place] = self._receiver(settings)
            else:
                self._transmit[place - self._receivers] = self._transmitter(settings)
        self._touched.clear()
        self.receive = tuple(pdo for pdo in self._receive if pdo)
        self.transmit = tuple(pdo for pdo in self._transmit if pdo)
        self.waits_for_sync = any(pdo.synchronous for pdo in self.receive)
        self._at_sync = tuple(pdo for pdo in self.transmit if pdo.synchronous)
        self._on_change = tuple(pdo for pdo in self.transmit if pdo.on_change)
        self._timed = tuple(pdo for pdo in self.receive if pdo.timed)
        return True

    def _receiver(self, settings: PdoSettings) -> ReceivePdo | None:
        if not settings.valid or not settings.cells():
            return None
        return ReceivePdo(settings, accepts_long=self._product.accepts_long_pdo)

    def _transmitter(self, settings: PdoSettings) -> TransmitPdo | None:
        if not settings.valid or not settings.cells():
            return None
        pdo = TransmitPdo(settings, self._product.poll)
        # A PDO that becomes valid in Operational begins as if the node had just entered it.
        if self._state() is NmtState.OPERATIONAL:
            pdo.begin(sends=self._product.sends_on_start)
        return pdo

    def routes(
        self,
        collision: FrameHandler,
        request: Callable[[TransmitPdo, bytes, Nanoseconds], None],
        received: Callable[[tuple[ReceivePdo, ...], bytes, Nanoseconds], None],
    ) -> dict[int, FrameHandler]:
        """Return the identifiers that count in Operational, with their handlers; PDOs may share one."""
        routes: dict[int, FrameHandler] = {}
        for sent in self.transmit:
            # A data frame with the device's own transmit COB-ID has another sender: EMCY 8150.
            routes[sent.address] = collision
            if sent.answers_remote:
                routes[sent.address | REMOTE] = partial(request, sent)
        for pdo in self.receive:
            # Two PDOs with one COB-ID both take the frame.
            sharing = tuple(other for other in self.receive if other.address == pdo.address)
            routes[pdo.address] = partial(received, sharing)
        return routes

    def begin(self) -> None:
        """Enter Operational."""
        self.renew()
        for pdo in self.transmit:
            pdo.begin(sends=self._product.sends_on_start)

    def rest(self) -> None:
        """Leave Operational: nothing waits any longer."""
        for received in self.receive:
            received.forget()
        for transmitted in self.transmit:
            transmitted.rest()

    def sync(self) -> list[tuple[int, bytes]]:
        """Return what leaves at SYNC; then take over what waited for it."""
        sent = [(pdo.address, it) for pdo in self._at_sync if (it := pdo.sync()) is not None]
        for pdo in self.receive:
            if pdo.synchronous:
                pdo.sync()
        return sent

    def changes(self, now: Nanoseconds) -> list[tuple[int, bytes]]:
        """Return what has changed and may leave now."""
        sent: list[tuple[int, bytes]] = []
        changes = self._store.changes
        for pdo in self._on_change:
            payload = pdo.look(now, changes)
            if payload is not None:
                sent.append((pdo.address, payload))
        return sent

    def missed(self, now: Nanoseconds) -> bool:
        """Return whether a receive PDO has just been missed; each time is reported once."""
        late = [pdo for pdo in self._timed if pdo.due <= now]
        for pdo in late:
            pdo.due = NEVER
        return bool(late)

    @property
    def due(self) -> Nanoseconds:
        """Return when to look for changes again, or to miss a message, even if nothing happens."""
        due = NEVER
        for pdo in self._on_change:
            due = min(due, pdo.due)
        for received in self._timed:
            due = min(due, received.due)
        return due
