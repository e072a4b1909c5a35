"""A serial line as the bridge's link: one drive is on it, and passes commands on to the others over CAN.

Each drive watches somebody who falls silent with the bridge. Those behind the gateway hear the bridge's own
heartbeat, which the gateway puts on the bus. The gateway itself does not hear what it sends; it watches the
answers of another drive to node guarding, which come only as long as the bridge has them asked for.
"""

from collections.abc import Iterable
from typing import Final

from firmware_bridge.drivers.serial.epos import EposSerial
from firmware_bridge.drivers.serial.errands import Errand, Exchange, Rank, Result
from firmware_bridge.drivers.serial.rows import IN_EVERY_CYCLE, IN_TURN
from firmware_bridge.node import MAXON
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Robot
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.can import MAX_PAYLOAD
from firmware_bridge.wire.canopen import NmtState
from firmware_bridge.wire.maxon.messages import Request, RequestCanFrame, SendCanFrame

LOST: Final = "the serial line to the drives is gone"


def heartbeat(robot: Robot) -> SendCanFrame:
    """Return the command that puts the bridge's heartbeat on the bus."""
    beat = canopen.encode_heartbeat(NmtState.OPERATIONAL)
    own = canopen.ERROR_CONTROL + robot.bus.bridge_node
    return SendCanFrame(own, len(beat), beat.ljust(MAX_PAYLOAD, b"\0"))


def guarding(robot: Robot) -> RequestCanFrame:
    """Return the command that has the guardian say what the gateway watches."""
    return RequestCanFrame(canopen.ERROR_CONTROL + robot.guardian, 1)


class SerialLink:
    """A `firmware_bridge.drivers.link.Link`."""

    __slots__ = (
        "_began_at",
        "_calm",
        "_cycle",
        "_drives",
        "_exchange",
        "_guardian",
        "_guarding",
        "_heartbeat",
        "_in_turn",
        "_newest",
        "_samples",
        "answers_within",
        "late",
        "longest_cycle",
        "name",
    )

    def __init__(
        self,
        drives: Iterable[EposSerial],
        exchange: Exchange,
        robot: Robot,
        answers_within: Nanoseconds,
    ) -> None:
        self.name = MAXON
        self.answers_within = answers_within
        self.late = 0
        self.longest_cycle: Nanoseconds = 0
        """From the begin of a cycle to the end of its last command, where no drive had tasks to do."""
        self._drives = tuple(drives)
        self._exchange = exchange
        self._heartbeat = heartbeat(robot)
        self._guarding = guarding(robot)
        self._guardian = next(drive for drive in self._drives if drive.axis.node == robot.guardian)
        self._newest: list[Errand] = []
        """The newest beats."""
        self._samples: list[Errand] = []
        self._in_turn: list[Errand] = []
        self._cycle = 0
        self._began_at: Nanoseconds = 0
        self._calm = False
        """Whether this cycle began without tasks; those take what time the line has left."""

    @property
    def lost(self) -> str | None:
        """Why no drive can be reached."""
        return LOST if self._exchange.gone else None

    @property
    def wake_at(self) -> Nanoseconds:
        """When a command is overdue."""
        return self._exchange.wake_at

    def sample(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask all drives that answer for what is due in this cycle, unless the last one is not through."""
        self._exchange.clock = now
        if not all(errand.over for errand in self._samples):
            self.late += 1
            return self._exchange.go_on()
        if self._calm:
            self.longest_cycle = max(self.longest_cycle, self._exchange.idle_at - self._began_at)
        self._calm = not any(drive.busy for drive in self._drives)
        self._began_at = now
        present = [(place, drive) for place, drive in enumerate(self._drives) if drive.present]
        for drive in self._drives:
            drive.synchronised(now)
        self._samples = [drive.read(row, Rank.SAMPLE) for row in IN_EVERY_CYCLE for _, drive in present]
        if all(errand.over for errand in self._in_turn):
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
        if any(drive.listens for drive in self._drives):
            return self._exchange.go_on()
        if all(errand.over for errand in self._newest):
            requests: list[Request] = [self._heartbeat]
            if self._guardian.guarded:
                requests.append(self._guarding)
            self._newest = [Errand(Rank.BEAT, self, (request,)) for request in requests]
            for errand in self._newest:
                self._exchange.put(errand)
        return self._exchange.go_on()

    def ended(self, _errand: Errand, _request: Request, _result: Result, _now: Nanoseconds) -> None:
        """Do nothing: who misses a beat says so itself."""

    def hear(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take what became of a command, or of the line."""
        gone = self._exchange.gone
        sent = self._exchange.hear(packet, now)
        if self._exchange.gone and not gone:
            for drive in self._drives:
                drive.lose(now)
        return sent + self._looked(now)

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
        return self._exchange.wake(now) + self._looked(now)

    def _looked(self, now: Nanoseconds) -> tuple[Packet, ...]:
        sent: tuple[Packet, ...] = ()
        for drive in self._drives:
            if drive.busy:
                sent += drive.look(now)
        return sent
