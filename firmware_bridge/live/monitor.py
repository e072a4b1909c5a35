"""A real bus on the live page, as `monitor` receives it: it is shown, and nothing is sent to it."""

from collections.abc import Iterable
from typing import Final

from firmware_bridge.live.bus import LiveBus, known, news
from firmware_bridge.live.messages import VERSION
from firmware_bridge.live.page_node import PageError, PageNode
from firmware_bridge.live.state import Json
from firmware_bridge.node import CAN, Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import Nanoseconds, to_seconds


class LiveMonitor(PageNode):
    """A node around one that listens, and notes each frame in the bus's picture."""

    def __init__(self, node: Node, bus: LiveBus, title: str) -> None:
        super().__init__(node)
        self._bus: Final = bus
        self._title: Final = title
        self._nodes = 0
        """So many nodes the pages know."""

    def _received(self, packet: Packet, now: Nanoseconds) -> None:
        if packet.link == CAN:
            self._bus.take(now, packet)

    def _hello(self) -> Json:
        return {
            "kind": "hello",
            "version": VERSION,
            "title": self._title,
            "mode": "bus",
            "axes": self._bus.nodes,
            "outline": [],
            "faults": [],
            "can": ["watch_frames"],
        }

    def _state(self, now: Nanoseconds) -> Json:
        return {"kind": "state", "at_s": to_seconds(now), "paused": False, "speed": 1.0, **self._bus.state()}

    def _known(self) -> Iterable[Json]:
        return (known((self._bus,)),)

    def _news(self, now: Nanoseconds) -> Iterable[Json]:
        del now
        nodes = self._bus.picture.nodes
        if len(nodes) != self._nodes:
            self._nodes = len(nodes)
            yield self._hello()
        yield from news((self._bus,))

    def _do(self, name: str, request: Json, now: Nanoseconds) -> tuple[Reaction, Json]:
        if name != "watch_frames":
            raise PageError(f"'{name:.40}': a real bus is only shown here")
        return self._node.wake(now), self._bus.watch(request)
