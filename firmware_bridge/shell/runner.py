"""Carries a node's packets over real ports in real time, and ends in good order, whatever ends it.

It refuses to know what the node is. On SIGINT, SIGTERM, an exception in the node, a lost port, the end of
its time, or when a finite node has finished, it asks the node to stop, carries on until the node says that it
is done, and closes the ports. A node that holds something then is carried on, and asked again at a signal.
"""

import signal
import socket
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from types import FrameType
from typing import Final

from firmware_bridge.node import Finite, Node, Stoppable, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.shell.clock import Clock
from firmware_bridge.shell.ports.port import LostPort, Port
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds, to_seconds

STOP_WITHIN: Final = 15 * SECOND
"""The longest end that a bridge asks for: every step of a stop tried in vain, on the slowest line."""
LATE: Final = 5 * MILLISECOND
"""A machine that is busy longer than this may have put something between the ports and the clock."""
_SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)


@dataclass(frozen=True, slots=True)
class Ending:
    """How a run ended."""

    reason: str
    in_order: bool
    """Whether the node said that it was done, rather than being cut off."""
    latest_wake: Nanoseconds
    """How late the node was woken at worst; much more than a cycle says that the machine is too slow."""


def run(
    node: Node,
    ports: Mapping[str, Port],
    clock: Clock,
    *,
    until: Nanoseconds = NEVER,
    stop_within: Nanoseconds = STOP_WITHIN,
) -> Ending:
    """Run a node on its ports until a signal comes, the time is over or it has finished; close the ports.

    The clock restarts at zero. What ended the run by force is raised when the node has stopped: LostPort, or
    the node's own exception. A second signal ends the stopping at once, unless the node is holding something.
    """
    carrier = _Carrier(node, ports, stop_within)
    clock.restart()
    try:
        with _signals() as bell:
            _carry(carrier, clock, bell, until)
    finally:
        carrier.close()
    if carrier.cause is not None:
        carrier.cause.add_note(carrier.verdict())
        raise carrier.cause
    return Ending(carrier.reason, carrier.in_order, carrier.latest_wake)


def _carry(carrier: "_Carrier", clock: Clock, bell: "_Bell", until: Nanoseconds) -> None:
    ready: Sequence[int] = ()
    now: Nanoseconds = 0
    while True:
        # First of all: on a busy machine the node's next wake is due by now, too.
        for number in bell.rung(ready):
            carrier.asked_to_stop(signal.Signals(number).name, now)
        carrier.turn(ready, now)
        if now >= until:
            until = NEVER
            carrier.asked_to_stop("the time is over", now)
        if carrier.finished:
            carrier.asked_to_stop("finished", now)
        if carrier.over(now):
            return
        files, due = [bell.fileno, *carrier.filenos], min(carrier.next_at(), until)
        ready = clock.wait(files, due)
        now = clock.now()
        if now - due > LATE:  # what has arrived by now is heard before anything that is due by now
            ready = clock.wait(files, now)


class _Carrier:
    """The state of one run: the ports that still work, the node's next wake, and how far it has stopped."""

    def __init__(self, node: Node, ports: Mapping[str, Port], stop_within: Nanoseconds) -> None:
        self.cause: Exception | None = None
        self.reason = ""
        self.in_order = False
        self.latest_wake: Nanoseconds = 0
        self.filenos = [port.fileno() for port in ports.values()]
        self._node = node
        self._finite = node if isinstance(node, Finite) else None
        self._ports = dict(ports)
        self._opened = len(ports)
        self._links = {port.fileno(): link for link, port in ports.items()}
        self._stop_within = stop_within
        self._wake_at: Nanoseconds = 0
        self._cut_off_at: Nanoseconds = NEVER
        self._stopping = False
        self._done = False
        self._ended = False

    def turn(self, ready: Sequence[int], now: Nanoseconds) -> None:
        """Carry what has arrived to the node, wake it where that is due, and carry what it sends."""
        try:
            self._hear(ready, now)
            if now >= self._wake_at and not (self._ended or self._done):
                self.latest_wake = max(self.latest_wake, now - self._wake_at)
                self._take(self._node.wake(now), now)
            for port in tuple(self._ports.values()):
                if now >= port.retry_at:
                    port.flush(now)
        except LostPort as lost:
            self._lose(lost, now)
        except Exception as failure:  # noqa: BLE001 - the drives must be stopped first; it is raised then
            self._fail(failure, now)

    @property
    def finished(self) -> bool:
        """Whether the node has just finished, so that it has not been asked to stop yet."""
        return self._finite is not None and not self._stopping and self._finite.finished

    def asked_to_stop(self, reason: str, now: Nanoseconds) -> None:
        """Begin to stop; asked twice, end at once, or ask a node that is holding something once more."""
        if self._stopping and not self._holding:
            self._ended = True
            return
        self.reason = self.reason or reason
        self._stop(now)

    @property
    def _holding(self) -> bool:
        """Whether the node, asked to stop, holds something; over a port that is lost it cannot."""
        return self._stopping and holds(self._node) and len(self._ports) == self._opened

    def next_at(self) -> Nanoseconds:
        """Return when there is something to do, if nothing arrives before."""
        retry_at = min((port.retry_at for port in self._ports.values()), default=NEVER)
        return min(self._wake_at, self._cut_off_at, retry_at)

    def over(self, now: Nanoseconds) -> bool:
        """Tell whether the run has ended: the node is done and all is sent, or its time to stop is over."""
        if self._holding:
            self._cut_off_at = now + self._stop_within
        if self._done and all(port.retry_at == NEVER for port in self._ports.values()):
            self.in_order = self._ended = True
        return self._ended or now >= self._cut_off_at

    def verdict(self) -> str:
        """Say how the stopping went."""
        if self.in_order:
            return "the node was stopped in good order before the ports were closed"
        limit = to_seconds(self._stop_within)
        return f"the node did not stop in good order within {limit:g} s; the drives' own watch must do it"

    def close(self) -> None:
        """Close the ports that are still open."""
        for port in self._ports.values():
            port.close()

    def _hear(self, ready: Sequence[int], now: Nanoseconds) -> None:
        for fileno in ready:
            link = self._links.get(fileno)
            if link is None or self._done:
                continue
            for address, payload in self._ports[link].read(now):
                self._take(self._node.receive(Packet(link, address, payload), now), now)

    def _take(self, reaction: Reaction, now: Nanoseconds) -> None:
        # Nobody is late for an instant that had passed when it was named: "at once" may be any of those.
        self._wake_at = max(reaction.wake_at, now)
        self._done = self._stopping and reaction.wake_at == NEVER
        for packet in reaction.sent:
            port = self._ports.get(packet.link)
            if port is not None:
                port.write(packet.address, packet.payload, now)

    def _lose(self, lost: LostPort, now: Nanoseconds) -> None:
        for link, port in tuple(self._ports.items()):
            if port is lost.port:
                del self._ports[link]
                del self._links[port.fileno()]
                self.filenos.remove(port.fileno())
                port.close()
        self.cause = self.cause or lost
        if not self._stopping:
            self._stop(now)

    def _fail(self, failure: Exception, now: Nanoseconds) -> None:
        self.cause = self.cause or failure
        if self._stopping:
            self._ended = True
        else:
            self._stop(now)

    def _stop(self, now: Nanoseconds) -> None:
        self._stopping = True
        self._cut_off_at = now + self._stop_within
        if not isinstance(self._node, Stoppable):
            self._done = True
            return
        try:
            self._take(self._node.stop(now), now)
        except LostPort as lost:
            self._lose(lost, now)
        except Exception as failure:  # noqa: BLE001 - as above; nothing more can be tried
            self._fail(failure, now)


class _Bell:
    """Signals as a file that can be waited for."""

    def __init__(self, reader: socket.socket) -> None:
        self._reader = reader
        self.fileno = reader.fileno()

    def rung(self, ready: Sequence[int]) -> bytes:
        """Return the numbers of the signals that came, in order."""
        if self.fileno not in ready:
            return b""
        with suppress(BlockingIOError):
            return self._reader.recv(64)
        return b""


@contextmanager
def _signals() -> Iterator[_Bell]:
    """Catch SIGINT and SIGTERM while this runs; only the main thread can, elsewhere nothing rings."""
    reader, writer = socket.socketpair()
    with reader, writer:
        reader.settimeout(0)
        writer.settimeout(0)
        if threading.current_thread() is not threading.main_thread():
            yield _Bell(reader)
            return
        wakeup = signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
        before = {number: signal.signal(number, _heard) for number in _SIGNALS}
        try:
            yield _Bell(reader)
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
            signal.set_wakeup_fd(wakeup)


def _heard(_number: int, _frame: FrameType | None) -> None:
    """Do nothing: the number was written to the bell before this is called."""
