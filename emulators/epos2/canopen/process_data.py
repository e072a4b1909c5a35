"""The eight PDOs of one drive together: who takes a frame, what SYNC moves, what has changed.

It refuses to know the objects' meaning and the bus; it gives and takes identifiers and payloads.
"""

from collections.abc import Callable
from functools import partial
from typing import TypeAlias

from emulators.epos2.canopen.pdo_settings import RECEIVE, TRANSMIT, PdoSettings
from emulators.epos2.canopen.pdo_transmission import ReceivePdo, TransmitPdo
from emulators.epos2.objects.device_profile import DeviceProfile
from emulators.epos2.objects.store import ObjectStore
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.can import REMOTE
from firmware_bridge.wire.canopen import NmtState
from firmware_bridge.wire.epos2.objects_pdo import PDOS

Heard: TypeAlias = Callable[[bytes, Nanoseconds], None]
"""Takes a frame's payload, and when it came."""


class ProcessData:
    """What `PdoSettings` describe, made ready again whenever they were touched."""

    def __init__(self, store: ObjectStore, profile: DeviceProfile, state: Callable[[], NmtState]) -> None:
        self._store = store
        self._profile = profile
        self._state = state
        self._touched: list[int] = []
        self._receive: list[ReceivePdo | None] = [None] * PDOS
        self._transmit: list[TransmitPdo | None] = [None] * PDOS
        self._settings = tuple(
            PdoSettings(
                store,
                direction,
                number,
                state,
                self._toucher(PDOS * (direction is TRANSMIT) + number),
                needs_invalid=profile.mapping_needs_invalid_pdo,
            )
            for direction in (RECEIVE, TRANSMIT)
            for number in range(PDOS)
        )
        self.receive: tuple[ReceivePdo, ...] = ()
        """Valid receive PDOs."""
        self.transmit: tuple[TransmitPdo, ...] = ()
        """Valid transmit PDOs that carry something."""
        self.waits_for_sync = False
        """Whether some receive PDO is taken over at SYNC."""
        self._at_sync: tuple[TransmitPdo, ...] = ()
        self._on_change: tuple[TransmitPdo, ...] = ()
        self.touch_all()
        self.renew()

    def _toucher(self, place: int) -> Callable[[], None]:
        return lambda: self._touched.append(place)

    def touch_all(self) -> None:
        """Have every PDO made ready anew: its objects changed without hooks."""
        self._touched.extend(range(2 * PDOS))

    def renew(self) -> bool:
        """Make the touched PDOs ready; True when there were any."""
        if not self._touched:
            return False
        for place in sorted(set(self._touched)):
            settings = self._settings[place]
            if place < PDOS:
                self._receive[place] = self._receiver(settings)
            else:
                self._transmit[place - PDOS] = self._transmitter(settings)
        self._touched.clear()
        self.receive = tuple(pdo for pdo in self._receive if pdo)
        self.transmit = tuple(pdo for pdo in self._transmit if pdo)
        self.waits_for_sync = any(pdo.synchronous for pdo in self.receive)
        self._at_sync = tuple(pdo for pdo in self.transmit if pdo.synchronous)
        self._on_change = tuple(pdo for pdo in self.transmit if pdo.on_change)
        return True

    def _receiver(self, settings: PdoSettings) -> ReceivePdo | None:
        if not settings.valid or not settings.cells():
            return None
        return ReceivePdo(settings, accepts_long=self._profile.accepts_long_pdo)

    def _transmitter(self, settings: PdoSettings) -> TransmitPdo | None:
        if not settings.valid or not settings.cells():
            return None
        pdo = TransmitPdo(settings, self._profile.poll)
        if self._state() is NmtState.OPERATIONAL:
            pdo.begin(sends=self._profile.sends_on_start)
        return pdo

    def routes(
        self,
        collision: Heard,
        request: Callable[[TransmitPdo, bytes, Nanoseconds], None],
        received: Callable[[tuple[ReceivePdo, ...], bytes, Nanoseconds], None],
    ) -> dict[int, Heard]:
        """Say which identifiers count in Operational, and who hears them; PDOs may share one."""
        routes: dict[int, Heard] = {}
        for sent in self.transmit:
            routes[sent.address] = collision
            if sent.answers_remote:
                routes[sent.address | REMOTE] = partial(request, sent)
        for pdo in self.receive:
            sharing = tuple(other for other in self.receive if other.address == pdo.address)
            routes[pdo.address] = partial(received, sharing)
        return routes

    def begin(self) -> None:
        """Enter Operational."""
        self.renew()
        for pdo in self.transmit:
            pdo.begin(sends=self._profile.sends_on_start)

    def rest(self) -> None:
        """Leave Operational: nothing waits any longer."""
        for received in self.receive:
            received.forget()
        for transmitted in self.transmit:
            transmitted.rest()

    def sync(self) -> list[tuple[int, bytes]]:
        """Return what leaves at SYNC; then take over what waited for it."""
        sent = [(pdo.address, pdo.payload()) for pdo in self._at_sync]
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

    @property
    def due(self) -> Nanoseconds:
        """Return when to look for changes again even if nothing happens."""
        due = NEVER
        for pdo in self._on_change:
            due = min(due, pdo.due)
        return due
