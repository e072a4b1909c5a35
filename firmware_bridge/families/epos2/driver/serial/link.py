"""A serial line as the bridge's link: one drive is on it, and passes commands on to the others over CAN.

Each drive watches a node that falls silent with the bridge. Those behind the gateway receive the bridge's own
heartbeat, which the gateway puts on the bus. The gateway itself does not receive its own frames; it watches
the answers of another drive to node guarding, which come only as long as the bridge requests them.
"""

from collections.abc import Iterable, Sequence
from typing import Final

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.drivers.plain_link import PlainLink
from firmware_bridge.families.epos2.driver.serial.drive import Epos2OnSerial
from firmware_bridge.families.epos2.driver.serial.exchange import Job, LineExchange, Rank, Result
from firmware_bridge.families.epos2.driver.serial.feedback import IN_EVERY_CYCLE, IN_TURN
from firmware_bridge.families.epos2.maxon.messages import Request, RequestCanFrame, SendCanFrame
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Link
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.can import MAX_PAYLOAD

LOST: Final = "the serial line to the drives is gone"


def heartbeat(link: Epos2Link) -> SendCanFrame:
    """Return the command that puts the bridge's heartbeat on the bus."""
    beat = cia301.encode_heartbeat(NmtState.OPERATIONAL)
    own = cia301.ERROR_CONTROL + link.bridge_node
    return SendCanFrame(own, len(beat), beat.ljust(MAX_PAYLOAD, b"\0"))


def guarding(link: Epos2Link, nodes: Sequence[int]) -> RequestCanFrame:
    """Return the command that has the guardian say what the gateway watches."""
    return RequestCanFrame(cia301.ERROR_CONTROL + link.guardian(nodes), 1)


class SerialLink(PlainLink):
    """A `firmware_bridge.drivers.link_drivers.DeviceLink`."""

    def __init__(
        self,
        name: str,
        drives: Iterable[Epos2OnSerial],
        exchange: LineExchange,
        table: Epos2Link,
        answers_within: Nanoseconds,
    ) -> None:
        # Frames of a second controller on the bus behind the gateway do not come to this end of the line.
        super().__init__(name, answers_within, table.bridge_heartbeat_ms * MILLISECOND)
        self._drives = tuple(drives)
        self._exchange = exchange
        nodes = tuple(Epos2Axis.of(drive.axis).node for drive in self._drives)
        self._heartbeat = heartbeat(table)
        self._guarding = guarding(table, nodes)
        self._guardian = self._drives[nodes.index(table.guardian(nodes))]
        self._newest: list[Job] = []
        """The newest beats."""
        self._samples: list[Job] = []
        self._in_turn: list[Job] = []
        self._cycle = 0
        self._began_at: Nanoseconds = 0
        self._calm = False
        """True where this cycle began without tasks; those take the time that the line has left."""

    @property
    def lost(self) -> str | None:
        """The reason why no drive can be reached."""
        return LOST if self._exchange.gone else None

    @property
    def wake_at(self) -> Nanoseconds:
        """Time when a command is overdue."""
        return self._exchange.wake_at

    def sample(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask all drives that answer for what is due in this cycle, unless the last one is not through."""
        self._exchange.clock = now
        # A cycle that has not ended is not followed by another one: the backlog would only grow.
        if not all(job.over for job in self._samples):
            self.late += 1
            return self._exchange.go_on()
        if self._calm:
            self.longest_cycle = max(self.longest_cycle, self._exchange.idle_at - self._began_at)
        self._calm = not any(drive.busy for drive in self._drives)
        self._began_at = now
        present = [(place, drive) for place, drive in enumerate(self._drives) if drive.present]
        for drive in self._drives:
            drive.synchronized(now)
        self._samples = [drive.read(row, Rank.SAMPLE) for row in IN_EVERY_CYCLE for _, drive in present]
        if all(job.over for job in self._in_turn):
            self._in_turn = [
                drive.read(row, Rank.ROTATING)
                for row in IN_TURN
                for place, drive in present
                if row.due(self._cycle, place)
            ]
        self._cycle += 1
        return self._exchange.go_on()

    def beat(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Send the bridge's heartbeat, and ask for what the gateway watches."""
        self._exchange.clock = now
        # During the proof nothing may show the drives that the bridge is alive.
        if any(drive.listens for drive in self._drives):
            return self._exchange.go_on()
        # A late beat is not doubled: the drives count silence, not frames.
        if all(job.over for job in self._newest):
            requests: list[Request] = [self._heartbeat]
            if self._guardian.guarded:
                requests.append(self._guarding)
            self._newest = [Job(Rank.BEAT, self, (request,)) for request in requests]
            for job in self._newest:
                self._exchange.put(job)
        return self._exchange.go_on()

    def ended(self, _job: Job, _request: Request, _result: Result, _now: Nanoseconds) -> None:
        """Do nothing: a drive that misses a heartbeat reports it itself."""

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take what became of a command, or of the line."""
        gone = self._exchange.gone
        sent = self._exchange.receive(packet, now)
        if self._exchange.gone and not gone:
            for drive in self._drives:
                drive.lose(now)
        return sent + self._proceeded(now)

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
        return self._exchange.wake(now) + self._proceeded(now)

    def _proceeded(self, now: Nanoseconds) -> tuple[Packet, ...]:
        sent: tuple[Packet, ...] = ()
        for drive in self._drives:
            if drive.busy:
                sent += drive.proceed(now)
        return sent
