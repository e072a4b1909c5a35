"""A rig whose time passes as fast as a clock outside: a node that real ports can be put to.

Outside are the control port (`emulators.control.desk` stands around this node) and, where stations take the
place of the mission's operator, their datagrams. All else is as in virtual time, and one seed gives the same
run as long as nothing comes from outside.
"""

from collections.abc import Callable
from typing import Final

from emulators.rig import OPERATOR_STATION, Rig
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

PACE: Final[Nanoseconds] = 10 * MILLISECOND
"""Time between two looks at the clock: a station's command waits half of it on average."""


class OutsideOperator:
    """The place in the world of ground stations that are outside of it."""

    def __init__(self) -> None:
        self.received: list[Packet] = []
        """Datagrams of the bridge for outside."""
        self._unsent: list[Packet] = []

    def put(self, packet: Packet) -> None:
        """Take a datagram from outside; it leaves when the world wakes this node."""
        self._unsent.append(packet)

    def take(self) -> tuple[Packet, ...]:
        """Take what the bridge has sent."""
        taken, self.received = tuple(self.received), []
        return taken

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Keep a datagram of the bridge."""
        del now
        self.received.append(packet)
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send what has come from outside."""
        del now
        sent, self._unsent = tuple(self._unsent), []
        return Reaction(sent)


class PacedRig:
    """A rig that is carried by the real-time runner up to an instant of its world."""

    def __init__(
        self,
        rig: Rig,
        end: Nanoseconds,
        operator: OutsideOperator | None = None,
        progress: Callable[[Nanoseconds], None] | None = None,
    ) -> None:
        """Take the rig, its last instant, its operator where that is outside, and what shows the progress."""
        self._rig: Final = rig
        self._end = end
        self._operator: Final = operator
        self._progress: Final = progress
        self.factor = 1.0
        """Simulated time for each second of the clock."""
        self.paused = False
        self._since: Nanoseconds = 0
        self._base: Nanoseconds = 0
        """The world's instant at that of the clock, since it has this pace."""

    def paces(self, now: Nanoseconds, *, factor: float | None = None, paused: bool | None = None) -> None:
        """Change the pace from now on; with neither, go on from where the world is."""
        self._since, self._base = now, self._rig.world.now
        self.factor = self.factor if factor is None else factor
        self.paused = self.paused if paused is None else paused

    def steps(self, now: Nanoseconds, by: Nanoseconds) -> None:
        """Pause, and let so much time pass."""
        self._rig.run(min(self._rig.world.now + by, self._end))
        self.paces(now, paused=True)

    def ends_at(self, end: Nanoseconds) -> None:
        """Carry it up to this instant of its world."""
        self._end = end

    @property
    def finished(self) -> bool:
        """True at the end of its time."""
        return self._rig.world.now >= self._end

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take a station's datagram."""
        self._run(now)
        if packet.link == OPERATOR and self._operator is not None:
            self._operator.put(packet)
            self._rig.world.rouse(OPERATOR_STATION)
        return self.wake(now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Let time pass up to this instant."""
        self._run(now)
        if self._progress is not None:
            self._progress(self._rig.world.now)
        sent = () if self._operator is None else self._operator.take()
        return Reaction(sent, NEVER if self.finished else now + PACE)

    def _run(self, now: Nanoseconds) -> None:
        gone = 0 if self.paused else round((now - self._since) * self.factor)
        self._rig.run(max(self._rig.world.now, min(self._base + gone, self._end)))
