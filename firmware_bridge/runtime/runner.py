"""The runner of a node on real ports in real time, up to an end in good order, whatever ends it.

The node's type is not known here. On a signal, an exception in the node or elsewhere, a lost port, the end of
its time, or when a finite node has finished, it commands the node to stop, carries on until the node reports
that it is done, and closes the ports. A failure while it stops does not end that. A node that still holds the
robot then is carried on, and commanded again at a signal.
"""

import os
import signal
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

from firmware_bridge.node import Finite, Node, Stoppable, Unhurried, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.runtime.bell import Bell, ringing
from firmware_bridge.runtime.clock import STALL, Clock
from firmware_bridge.runtime.ports.port import LostPort, Port
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds

STOP_WITHIN: Final = 15 * SECOND
"""Longest end that a bridge needs: every stop stage tried in vain, on the slowest line."""
LATE: Final = 5 * MILLISECOND
"""A machine that is busy longer than this may have put something between the ports and the clock."""
AGAIN: Final = 50 * MILLISECOND
"""A node that has failed is woken again so much later."""

IN_ORDER: Final = "the node was stopped in good order before the ports were closed"


@dataclass(frozen=True, slots=True)
class Ending:
    """The end of a run."""

    reason: str
    in_order: bool
    """True where the node reported that it was done, rather than being cut off."""
    latest_wake: Nanoseconds
    """Worst delay of the node's wake-up; much more than a cycle means that the machine is too slow."""
    verdict: str
    """Text about the stopping."""


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
    whatever was raised. A second signal ends the stopping at once, unless the node is holding something, or
    is not cut short.
    """
    carrier = _Carrier(node, ports, stop_within)
    clock.restart()
    try:
        with ringing() as bell:
            _carry(carrier, clock, bell, until)
    finally:
        carrier.close()
    if carrier.cause is not None:
        carrier.cause.add_note(carrier.verdict())
        raise carrier.cause
    return Ending(carrier.reason, carrier.in_order, carrier.latest_wake, carrier.verdict())


def _carry(carrier: "_Carrier", clock: Clock, bell: Bell, until: Nanoseconds) -> None:
    ready: Sequence[int] = ()
    now: Nanoseconds = 0
    while not carrier.over(now):
        try:
            # First of all: on a busy machine the node's next wake is due by now, too.
            for number in bell.rung() if bell.fileno in ready else b"":
                carrier.requested_by(signal.Signals(number).name, now)
            carrier.turn(ready, now)
            if now >= until:
                until = NEVER
                carrier.ends("the time is over", now)
            if carrier.finished:
                carrier.ends("finished", now)
            if carrier.over(now):
                return
            ready, now = _waited(carrier, clock, bell, until)
        except LostPort as lost:
            ready, now = (), clock.now()
            carrier.loses(lost, now)
        except BaseException as failure:  # noqa: BLE001 - the devices must be stopped first; it is raised then
            ready, now = (), clock.now()
            carrier.fails(failure, now)


def _waited(
    carrier: "_Carrier", clock: Clock, bell: Bell, until: Nanoseconds
) -> tuple[Sequence[int], Nanoseconds]:
    """Wait for what comes or is due; return the files that can be read, and the instant."""
    files, due = [bell.fileno, *carrier.filenos], min(carrier.next_at(), until)
    begun = clock.now()
    try:
        ready = clock.wait(files, due)
        now = clock.now()
        if now - due > LATE:  # packets that have arrived by now go before anything that is due by now
            ready = clock.wait(files, now)
            carrier.stood_still(now - max(due, begun))
    except (OSError, ValueError) as error:
        carrier.find_closed(error)
        raise
    return ready, now


class _Carrier:
    """The state of one run: the ports that still work, the node's next wake, and how far it has stopped."""

    def __init__(self, node: Node, ports: Mapping[str, Port], stop_within: Nanoseconds) -> None:
        self.cause: BaseException | None = None
        self.reason = ""
        self.in_order = False
        self.latest_wake: Nanoseconds = 0
        self.filenos = [port.fileno() for port in ports.values()]
        self._node = node
        self._stoppable = node if isinstance(node, Stoppable) else None
        self._unhurried = node if isinstance(node, Unhurried) else None
        self._finite = node if isinstance(node, Finite) else None
        self._ports = dict(ports)
        self._opened = len(ports)
        self._links = {port.fileno(): link for link, port in ports.items()}
        self._stop_within = stop_within
        self._wake_at: Nanoseconds = 0
        self._cut_off_at: Nanoseconds = NEVER
        self._stopping = False
        self._unheard = False
        """True after the node failed in its stop: the next call stops it again."""
        self._done = False
        self._ended = False

    def turn(self, ready: Sequence[int], now: Nanoseconds) -> None:
        """Carry what has arrived to the node, wake it where that is due, and carry what it sends."""
        self._receive(ready, now)
        if now >= self._wake_at and not (self._ended or self._done):
            self.latest_wake = max(self.latest_wake, now - self._wake_at)
            # A call that fails below is tried again then; one that does not fail sets its own time.
            self._wake_at = now + AGAIN
            self._take(self._stop_again(now) if self._unheard else self._node.wake(now), now)
        for port in tuple(self._ports.values()):
            if now >= port.retry_at:
                port.flush(now)

    @property
    def finished(self) -> bool:
        """True where the node has just finished, and was not yet commanded to stop."""
        return self._finite is not None and not self._stopping and self._finite.finished

    def ends(self, reason: str, now: Nanoseconds) -> None:
        """Begin to stop, where that has not begun."""
        if not self._stopping:
            self.reason = reason
            self._stop(now)

    def requested_by(self, signal_: str, now: Nanoseconds) -> None:
        """Begin to stop; at a second command end at once, unless the node holds or is not cut short."""
        if self._stopping and not self._holding:
            self._ended = self._unhurried is None or self._unhurried.may_leave(now)
            return
        self.reason = self.reason or signal_
        self._stop(now)

    @property
    def _holding(self) -> bool:
        """True where the node holds the robot after a command to stop; over a lost port it cannot."""
        return self._stopping and holds(self._node) and len(self._ports) == self._opened

    def next_at(self) -> Nanoseconds:
        """Return when there is something to do, if nothing arrives before."""
        retry_at = min((port.retry_at for port in self._ports.values()), default=NEVER)
        return min(self._wake_at, self._cut_off_at, retry_at)

    def over(self, now: Nanoseconds) -> bool:
        """Return whether the run has ended: the node is done and all is sent, or its time to stop is over."""
        with suppress(BaseException):  # a node that cannot say that it holds something holds nothing
            if self._holding:
                # A node that keeps the robot on a slope is not cut off: that would let the robot roll.
                self._cut_off_at = now + self._stop_within
        if self._done and all(port.retry_at == NEVER for port in self._ports.values()):
            self.in_order = self._ended = True
        return self._ended or now >= self._cut_off_at

    def verdict(self) -> str:
        """Say how the stopping went."""
        if self.in_order:
            return IN_ORDER
        left = "" if self._unhurried is None else self._unhurried.unattended
        return "; ".join(filter(None, ("it did not stop in good order", left)))

    def close(self) -> None:
        """Close the ports that are still open."""
        for port in self._ports.values():
            port.close()

    def _receive(self, ready: Sequence[int], now: Nanoseconds) -> None:
        for fileno in ready:
            link = self._links.get(fileno)
            if link is None or self._done:
                continue
            for address, payload in self._ports[link].read(now):
                try:
                    self._take(self._node.receive(Packet(link, address, payload), now), now)
                except LostPort:
                    raise
                except Exception as failure:  # noqa: BLE001 - other received packets are still handled
                    self.fails(failure, now)

    def _take(self, reaction: Reaction, now: Nanoseconds) -> None:
        # No one is late for an instant that had passed when it was named: "at once" may be any of those.
        self._wake_at = max(min(reaction.wake_at, now + AGAIN) if self._unheard else reaction.wake_at, now)
        self._done = self._stopping and not self._unheard and reaction.wake_at == NEVER
        lost: LostPort | None = None
        for packet in reaction.sent:
            port = self._ports.get(packet.link)
            if port is None or (lost is not None and port is lost.port):
                continue
            try:
                port.write(packet.address, packet.payload, now)
            except LostPort as error:  # what goes to the others leaves first
                lost = lost or error
        if lost is not None:
            raise lost

    def stood_still(self, late: Nanoseconds) -> None:
        """Give the node as much longer to stop as the process was suspended; a busy machine is not."""
        if late > STALL and self._cut_off_at != NEVER:
            self._cut_off_at += late

    def find_closed(self, error: Exception) -> None:
        """Raise LostPort for a port whose file is closed, which no one can wait for."""
        for port in self._ports.values():
            try:
                os.fstat(port.fileno())
            except (OSError, ValueError):
                raise LostPort(port, str(error)) from error

    def loses(self, lost: LostPort, now: Nanoseconds) -> None:
        """Go on without a port, and begin to stop."""
        for link, port in tuple(self._ports.items()):
            if port is lost.port:
                del self._ports[link]
                self._links = {fileno: name for fileno, name in self._links.items() if name != link}
                self.filenos = list(self._links)
                with suppress(OSError):  # what is lost may not let itself be closed
                    port.close()
        self.fails(lost, now)

    def fails(self, failure: BaseException, now: Nanoseconds) -> None:
        """Begin to stop because of a failure; what fails while it stops does not end that."""
        self.cause = self.cause or failure
        self._wake_at = min(self._wake_at, now + AGAIN)
        if not self._stopping:
            self._stop(now)

    def _stop(self, now: Nanoseconds) -> None:
        self._stopping = True
        # Every further command to stop gives the whole time again.
        self._cut_off_at = now + self._stop_within
        try:
            self._take(self._stop_again(now), now)
        except LostPort as lost:
            self.loses(lost, now)
        except BaseException as failure:  # noqa: BLE001 - it is commanded again
            self.fails(failure, now)

    def _stop_again(self, now: Nanoseconds) -> Reaction:
        """Ask the node to stop until it has taken it."""
        # Set before the call: if it raises, the next wake-up commands the stop again.
        self._unheard = True
        reaction = Reaction() if self._stoppable is None else self._stoppable.stop(now)
        self._unheard = False
        return reaction
