"""A node around a node, with the live page's port: what every page has, whatever it shows."""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from contextlib import suppress
from typing import Final

from firmware_bridge.json_line import JsonLineError, read_object
from firmware_bridge.live.messages import (
    ALL_PAGES,
    CLOSED,
    LIVE,
    MOST_EVENTS,
    OPENED,
    SHOWN_EVERY,
    encoded,
)
from firmware_bridge.live.state import Json
from firmware_bridge.node import Finite, Node, Stoppable, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import Nanoseconds, to_seconds


class PageError(Exception):
    """A request of the page that cannot be carried out: why."""


class PageNode(ABC):
    """What is not the page's passes to the node; a page that is opened sees it at most 20 times a second."""

    def __init__(self, node: Node) -> None:
        """Take the node as it is carried."""
        self._node: Final = node
        self._pages: Final[set[int]] = set()
        self._events: Final[list[Json]] = []
        self._new: list[Json] = []
        self._shown_at: Nanoseconds = -SHOWN_EVERY

    @property
    def holding(self) -> bool:
        """True while the node keeps a robot from moving after a command to end."""
        return holds(self._node)

    @property
    def finished(self) -> bool:
        """True once the node's own time is over."""
        return isinstance(self._node, Finite) and self._node.finished

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take what a page has sent; pass on everything else."""
        if packet.link != LIVE:
            reaction = self._node.receive(packet, now)
            self._received(packet, now)
            return self._shown(reaction, now)
        if packet.payload == OPENED:
            # To the others; this one is introduced first.
            reaction = self._shown(self._node.wake(now), now)
            self._pages.add(packet.address)
            events = {"kind": "events", "events": self._events}
            messages = (self._hello(), events, *self._known(), self._state(now))
            sent = tuple(Packet(LIVE, packet.address, encoded(one)) for one in messages)
            return Reaction((*reaction.sent, *sent), reaction.wake_at)
        if packet.payload == CLOSED:
            self._pages.discard(packet.address)
            if not self._pages:
                self._left()
            return self._shown(self._node.wake(now), now)
        return self._requested(packet, now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the node, and show it."""
        return self._shown(self._node.wake(now), now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Stop the node, where it can be stopped."""
        reaction = self._node.stop(now) if isinstance(self._node, Stoppable) else Reaction()
        return self._shown(reaction, now)

    def event(self, text: str, level: str, now: Nanoseconds) -> None:
        """Show an event."""
        event = {"at_s": to_seconds(now), "text": text, "level": level}
        self._events.append(event)
        self._new.append(event)
        del self._events[:-MOST_EVENTS]
        del self._new[:-MOST_EVENTS]

    # What differs

    @abstractmethod
    def _hello(self) -> Json:
        """Return the page's first message."""

    @abstractmethod
    def _state(self, now: Nanoseconds) -> Json:
        """Return everything at this instant."""

    @abstractmethod
    def _do(self, name: str, request: Json, now: Nanoseconds) -> tuple[Reaction, Json | None]:
        """Carry out a request; return what leaves, and the answer beside `id` and `ok`; None for none.

        PageError.
        """

    def _known(self) -> Iterable[Json]:
        """Return what a page that is opened has to know beside events and state."""
        return ()

    def _news(self, now: Nanoseconds) -> Iterable[Json]:
        """Return what is new beside events and state, for all pages."""
        del now
        return ()

    def _left(self) -> None:  # noqa: B027 - most need nothing
        """Take note that the last page is closed."""

    def _received(self, packet: Packet, now: Nanoseconds) -> None:
        """Look at a packet that has come for the node."""
        del packet, now

    def _leaves(self, packet: Packet, now: Nanoseconds) -> bool:
        """Look at a packet that the node sends; return whether it leaves."""
        del packet, now
        return True

    def _requested(self, packet: Packet, now: Nanoseconds) -> Reaction:
        request: Json = {}
        # What cannot be read is refused as a request without a name.
        with suppress(JsonLineError):
            request = read_object(packet.payload)
        # The node comes to this instant first.
        before = self._node.wake(now)
        answer: Json | None
        try:
            reaction, answer = self._do(str(request.get("do", "")), request, now)
        except PageError as error:
            reaction, answer = self._node.wake(now), {"ok": False, "error": str(error)}
        shown = self._shown(Reaction((*before.sent, *reaction.sent), reaction.wake_at), now)
        if answer is None:
            return shown
        answered = encoded({"id": request.get("id"), "ok": True, **answer})
        return Reaction((*shown.sent, Packet(LIVE, packet.address, answered)), shown.wake_at)

    def _shown(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        """Look at what leaves, and add what the pages have not seen yet, where it is time."""
        sent = [packet for packet in reaction.sent if self._leaves(packet, now)]
        if now - self._shown_at >= SHOWN_EVERY:
            self._shown_at = now
            news = list(self._news(now))
            new, self._new = self._new, []
            if self._pages:
                events = [{"kind": "events", "events": new}] if new else []
                messages = (self._state(now), *events, *news)
                sent += [Packet(LIVE, ALL_PAGES, encoded(one)) for one in messages]
        return Reaction(tuple(sent), reaction.wake_at)
