"""Error control: heartbeat producer, heartbeat consumers, node guarding.

Source: CiA 301 v4.02, error control. Where it is silent: the first heartbeat leaves as soon as the period is
written; a boot-up message is no heartbeat; a watch that ended in silence begins again with the next
heartbeat; a time that is written once more as it stands changes nothing: it ends no watch, and shifts no
heartbeat.
"""

from functools import partial
from typing import Final

from emulators.canopen.object_store import ObjectStore
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import LAST_NODE, TOGGLE, NmtState, decode_heartbeat
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

GUARD_TIME: Final = Address(0x100C)
LIFE_TIME_FACTOR: Final = Address(0x100D)
CONSUMERS: Final = 0x1016
TIME_MASK: Final = 0xFFFF


class Producer:
    """Heartbeat producer of the device."""

    def __init__(self, *, toggles: bool) -> None:
        self._toggles = toggles
        self._flip = 0
        self._period: Nanoseconds = 0
        self.due: Nanoseconds = NEVER

    @property
    def active(self) -> bool:
        """True if heartbeats are produced; node guarding rests meanwhile."""
        return self._period > 0

    def configure(self, period_ms: int) -> None:
        """Take 0x1017; the first heartbeat is due at once."""
        self._period = period_ms * MILLISECOND
        self.due = 0 if period_ms else NEVER

    def begin(self, now: Nanoseconds) -> None:
        """Start to count at the boot-up message."""
        self._flip = 0
        self.due = now + self._period if self._period else NEVER

    def produce(self, state: NmtState, now: Nanoseconds) -> bytes:
        """Return the payload that is due, and move on to the next instant of the same grid."""
        # A late wake-up must not shift the grid; `due` 0 is "at once", and starts a grid now.
        since = now - self.due if self.due else 0
        self.due = now - since % self._period + self._period
        word = state | self._flip
        if self._toggles:
            self._flip ^= TOGGLE
        return bytes((word,))


class Consumer:
    """Heartbeat consumer for one other node."""

    def __init__(self) -> None:
        self.node = 0
        self._time: Nanoseconds = 0
        self.due: Nanoseconds = NEVER

    def configure(self, word: int) -> None:
        """Take 0x1016: node << 16 | time in ms; without either nothing is watched."""
        time_ms = word & TIME_MASK
        self.node = word >> 16 & 0x7F if time_ms else 0
        self._time = time_ms * MILLISECOND
        self.due = NEVER

    def receive(self, payload: bytes, now: Nanoseconds) -> None:
        """Take a heartbeat; the first one starts the watch."""
        if decode_heartbeat(payload) not in (None, NmtState.BOOT_UP):
            self.due = now + self._time


class Guard:
    """Node guarding: it answers the master's requests, and supervises that they come."""

    def __init__(self) -> None:
        self._flip = 0
        self._life: Nanoseconds = 0
        self.due: Nanoseconds = NEVER

    def configure(self, guard_time_ms: int, factor: int) -> None:
        """Take 0x100C and 0x100D; the watch starts with the next request."""
        self._life = guard_time_ms * factor * MILLISECOND
        self.due = NEVER

    def begin(self) -> None:
        """Start with toggle 0 after a reset."""
        self._flip = 0
        self.due = NEVER

    def answer(self, state: NmtState, now: Nanoseconds) -> bytes:
        """Return the state with the toggle bit."""
        word = state | self._flip
        self._flip ^= TOGGLE
        if self._life:
            self.due = now + self._life
        return bytes((word,))


class ErrorControl:
    """All of it, tied to its objects."""

    def __init__(self, store: ObjectStore, *, toggles: bool) -> None:
        self._store = store
        self.producer = Producer(toggles=toggles)
        self.guard = Guard()
        self._watches: Final = {address: Consumer() for address in store.objects.entries(CONSUMERS)}
        self.consumers: Final[tuple[Consumer, ...]] = tuple(self._watches.values())
        self._touched = False
        store.on_write(od.PRODUCER_HEARTBEAT, self._take_period)
        for address in (GUARD_TIME, LIFE_TIME_FACTOR):
            store.on_write(address, partial(self._take_guarding, address))
        for address in self._watches:
            store.on_write(address, partial(self._take_consumer, address))

    def begin(self, now: Nanoseconds) -> None:
        """Start again after boot-up with what the objects hold."""
        store = self._store
        self.producer.configure(store.get(od.PRODUCER_HEARTBEAT))
        self.producer.begin(now)
        # Node guarding is optional (CiA 301): a device may have neither object.
        if GUARD_TIME in store.objects:
            self.guard.configure(store.get(GUARD_TIME), store.get(LIFE_TIME_FACTOR))
        self.guard.begin()
        for address, consumer in self._watches.items():
            consumer.configure(store.get(address))
        self._touched = True

    def rest(self) -> None:
        """Fall silent until the next boot-up."""
        self.producer.due = self.guard.due = NEVER
        for consumer in self.consumers:
            consumer.due = NEVER

    @property
    def due(self) -> Nanoseconds:
        """Return the next instant at which something is due."""
        due = min(self.producer.due, self.guard.due)
        for consumer in self.consumers:
            due = min(due, consumer.due)
        return due

    @property
    def watched(self) -> frozenset[int]:
        """Return the nodes whose heartbeats count."""
        return frozenset(consumer.node for consumer in self.consumers if consumer.node)

    def renew(self) -> bool:
        """Return whether `watched` may have changed since the last question."""
        touched, self._touched = self._touched, False
        return touched

    def receive(self, node: int, payload: bytes, now: Nanoseconds) -> None:
        """Take another node's heartbeat."""
        for consumer in self.consumers:
            if consumer.node == node:
                consumer.receive(payload, now)

    def lost(self, now: Nanoseconds) -> bool:
        """Return True if a supervision has just timed out; each timeout is reported once."""
        if self.due > now:
            return False
        watches: tuple[Consumer | Guard, ...] = (*self.consumers, self.guard)
        silent = [watch for watch in watches if watch.due <= now]
        for watch in silent:
            watch.due = NEVER
        return bool(silent)

    def _take_guarding(self, address: Address, value: int) -> None:
        # A hook runs before the store takes its value: only the other object is read from there.
        time_ms, factor = (
            value if each == address else self._store.get(each) for each in (GUARD_TIME, LIFE_TIME_FACTOR)
        )
        if value != self._store.get(address):
            self.guard.configure(time_ms, factor)

    def _take_period(self, period_ms: int) -> None:
        if period_ms == self._store.get(od.PRODUCER_HEARTBEAT):
            return
        self.producer.configure(period_ms)
        if self.producer.active:
            # Heartbeat has priority: guarding is disabled with it.
            self.guard.begin()

    def _take_consumer(self, address: Address, word: int) -> None:
        node = word >> 16
        if node > LAST_NODE:
            raise SdoAbort(AbortCode.RANGE, address)
        others = [self._store.get(each) for each in self._watches if each != address]
        # CiA 301: two monitors for one node are refused with 0x06040043.
        if node and word & TIME_MASK and any(it & TIME_MASK and node == it >> 16 for it in others):
            raise SdoAbort(AbortCode.PARAMETER_CLASH, address)
        # Written once more as it is, it must not end a monitor that waits.
        if word != self._store.get(address):
            self._watches[address].configure(word)
            self._touched = True
