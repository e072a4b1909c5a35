"""`monitor --ask`: the PDO settings of each node read by SDO, one request of a node at a time."""

from collections import deque
from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import SDO_REQUEST, SDO_RESPONSE
from firmware_bridge.canopen.pdo import (
    MAX_ENTRIES,
    RECEIVE_MAPPING,
    RECEIVE_PARAMETER,
    TRANSMIT_MAPPING,
    TRANSMIT_PARAMETER,
)
from firmware_bridge.canopen.sdo import UploadResponse, decode_response, encode_upload
from firmware_bridge.node import CAN, Node, Stoppable
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, Nanoseconds

if TYPE_CHECKING:
    from firmware_bridge.dissector.bus_picture import BusPicture

PDOS: Final = 4
"""The predefined ones of each direction (CiA 301)."""
PATIENCE: Final[Nanoseconds] = 500 * MILLISECOND
"""Time for an answer; then the next object is read."""


def _settings() -> Iterator[Address]:
    """Yield where a PDO's identifier stands, and the number of its objects."""
    for place in range(PDOS):
        for parameter, mapping in (
            (RECEIVE_PARAMETER, RECEIVE_MAPPING),
            (TRANSMIT_PARAMETER, TRANSMIT_MAPPING),
        ):
            yield Address(parameter + place, 1)
            yield Address(mapping + place, 0)


class MappingReader:
    """A node around one that listens: it reads, and writes nothing."""

    def __init__(self, listening: Node, picture: "BusPicture") -> None:
        self._listening: Final = listening
        self._picture: Final = picture
        self._left: Final[dict[int, deque[Address]]] = {}
        self._requested_at: Final[dict[int, Nanoseconds]] = {}
        """Time of the request of each node that is not answered."""

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take a frame; after an answer the next object of its node is read."""
        reaction = self._listening.receive(packet, now)
        node = packet.address - SDO_RESPONSE
        if node not in self._requested_at:
            return reaction
        answer = decode_response(packet.payload)
        if isinstance(answer, UploadResponse) and answer.raw and answer.address.subindex == 0:
            count = min(answer.raw[0], MAX_ENTRIES)
            entries = (Address(answer.address.index, place) for place in range(1, count + 1))
            self._left[node].extendleft(entries)
        del self._requested_at[node]
        return Reaction(self._next(now), reaction.wake_at)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Begin with nodes that are new, and go on where no answer came."""
        reaction = self._listening.wake(now)
        for seen in self._picture.nodes:
            self._left.setdefault(seen.node, deque(_settings()))
        for node in [node for node, at in self._requested_at.items() if now - at >= PATIENCE]:
            del self._requested_at[node]
        return Reaction(self._next(now), reaction.wake_at)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Stop the one that listens, and read nothing any more."""
        return self._listening.stop(now) if isinstance(self._listening, Stoppable) else Reaction()

    def _next(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Return the next request of each node that has none under way."""
        sent = []
        for node, left in self._left.items():
            if left and node not in self._requested_at:
                self._requested_at[node] = now
                sent.append(Packet(CAN, SDO_REQUEST + node, encode_upload(left.popleft())))
        for request in sent:
            # Our own frames do not come back; the picture has to see them.
            self._picture.note(now, request)
        return tuple(sent)
