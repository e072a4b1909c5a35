"""A node with the live page's port in virtual time: a page that is open keeps what it receives."""

import json
from typing import Any, Final

from firmware_bridge.live.messages import CLOSED, LIVE, OPENED
from firmware_bridge.node import Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import SECOND, Nanoseconds

PAGE: Final = 1


class Paged:
    """The node, its clock, and its page."""

    def __init__(self, node: Node) -> None:
        self.node: Final = node
        self.now: Nanoseconds = 0
        self.page: Final[list[dict[str, Any]]] = []
        self.sent: Final[list[Packet]] = []
        """What has left for other links."""
        self._wake_at: Nanoseconds = 0

    def opens(self) -> list[dict[str, Any]]:
        """Open the page; return its first messages."""
        return self.receives(Packet(LIVE, PAGE, OPENED))

    def closes(self) -> None:
        """Close it."""
        self.receives(Packet(LIVE, PAGE, CLOSED))

    def does(self, name: str, **keys: Any) -> dict[str, Any]:
        """Send a request; return its answer."""
        received = self.receives(Packet(LIVE, PAGE, json.dumps({"id": 7, "do": name, **keys}).encode()))
        (answer,) = (one for one in received if one.get("id") == 7)
        return answer

    def receives(self, packet: Packet) -> list[dict[str, Any]]:
        """Give a packet to the node now; return what the page receives at once."""
        begun = len(self.page)
        self._take(self.node.receive(packet, self.now))
        return self.page[begun:]

    def runs(self, seconds: float) -> list[dict[str, Any]]:
        """Let time pass; return what the page receives."""
        begun, end = len(self.page), self.now + round(seconds * SECOND)
        while self._wake_at <= end:
            self.now = max(self.now, self._wake_at)
            self._take(self.node.wake(self.now))
        self.now = end
        return self.page[begun:]

    def kept(self, kind: str) -> list[dict[str, Any]]:
        """Return the page's messages of a kind."""
        return [one for one in self.page if one.get("kind") == kind]

    def _take(self, reaction: Reaction) -> None:
        self.page.extend(json.loads(one.payload) for one in reaction.sent if one.link == LIVE)
        self.sent.extend(one for one in reaction.sent if one.link != LIVE)
        self._wake_at = reaction.wake_at
