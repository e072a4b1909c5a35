"""Emulated devices of a robot behind their control desk, with a clock of the test's own."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

from emulators.control.desk import CONTROL, Desk
from emulators.control.live import on_real_links
from emulators.devices import devices
from emulators.family import Way
from emulators.gateway import Cluster
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

CLIENT: Final = 1
LINKS: Final = {Way.BUS: CAN, Way.LINE: SERIAL}


class LiveBench:
    """A desk that is woken when it wants to be; what leaves it is kept with its instants."""

    def __init__(self, name: str) -> None:
        robot = find(name)
        emulated = devices(robot)
        self.devices: Final = emulated
        members = {name: one.node for name, one in emulated.stations.items()}
        links = {
            name: {own: one.link for own, way in one.on.items() if way in LINKS}
            for name, one in emulated.stations.items()
        }
        self.reports: Final[list[str]] = []
        self.cluster: Final = Cluster(members, emulated.physics, links=links)
        self.live: Final = on_real_links(robot, emulated, self.cluster, emulated.plant)
        self.desk: Final = Desk(self.cluster, self.live, self.reports.append)
        self.now: Nanoseconds = 0
        self.sent: Final[list[tuple[Nanoseconds, Packet]]] = []
        self._wake_at: Nanoseconds = 0

    def runs(self, milliseconds: float) -> list[Packet]:
        """Let time pass; return what has left for buses and lines."""
        begun, end = len(self.sent), self.now + round(milliseconds * MILLISECOND)
        while self._wake_at <= end:
            self.now = max(self.now, self._wake_at)
            self._wake_at = NEVER
            self._take(self.desk.wake(self.now))
        self.now = end
        return [packet for _, packet in self.sent[begun:]]

    def receives(self, link: str, address: int, payload: bytes) -> list[Packet]:
        """Take a packet from outside; return the answers of the next 5 ms."""
        begun = len(self.sent)
        self._take(self.desk.receive(Packet(link, address, payload), self.now))
        self.runs(5)
        return [packet for _, packet in self.sent[begun:]]

    def line(self, line: bytes) -> dict[str, Any]:
        """Send a line over the control port, and return the answer."""
        reaction = self.desk.receive(Packet(CONTROL, CLIENT, line), self.now)
        (answer,) = (one for one in reaction.sent if one.link == CONTROL)
        assert answer.address == CLIENT
        self._take(Reaction(tuple(one for one in reaction.sent if one.link != CONTROL), reaction.wake_at))
        answered: dict[str, Any] = json.loads(answer.payload)
        return answered

    def request(self, do: str, **keys: Any) -> dict[str, Any]:
        """Send a request and return its answer."""
        return self.line(json.dumps({"id": 5, "do": do, **keys}).encode())

    def does(self, do: str, **keys: Any) -> dict[str, Any]:
        """Do the same where it must not be refused."""
        answer = self.request(do, **keys)
        assert answer["ok"], answer
        return answer

    def refuses(self, do: str, **keys: Any) -> str:
        """Do the same where it must be refused; return the reason, which is one line."""
        answer = self.request(do, **keys)
        assert not answer["ok"]
        assert "\n" not in answer["error"]
        return str(answer["error"])

    def _take(self, reaction: Reaction) -> None:
        self._wake_at = reaction.wake_at
        self.sent.extend((self.now, packet) for packet in reaction.sent)


@contextmanager
def live(name: str) -> Iterator[LiveBench]:
    """Start a robot's devices; let go of their plant at the end."""
    bench = LiveBench(name)
    try:
        bench.runs(400)
        yield bench
    finally:
        bench.devices.plant.close()
