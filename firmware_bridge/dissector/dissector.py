"""Chooses who reads a packet, by the kind of its link, and writes one carried packet as a line.

A dissector follows what goes by, as a protocol analyser does: it is given every packet of a link in order.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Final

from firmware_bridge.dissector.canopen import Canopen
from firmware_bridge.dissector.mavlink import Mavlink
from firmware_bridge.dissector.protocols import Protocols, Reader
from firmware_bridge.family import families
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.recording import candump_frame
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import SECOND, Nanoseconds

COMMON: Final[Mapping[str, Protocols]] = MappingProxyType(
    {CAN: Protocols(Canopen, candump_frame), OPERATOR: Protocols(Mavlink)}
)
"""The kinds of links that are no family's own."""


@cache
def kinds() -> Mapping[str, Protocols]:
    """Return every kind of link: CAN, the operator's, and the installed families' own."""
    found = dict(COMMON)
    for family in families():
        found |= family.protocols
    return found


def kinds_of(robot: AnyRobot) -> dict[str, str]:
    """Return the kind of each of a robot's links, by its name, as it is on the wire."""
    return {name: link.kind for name, link in robot.links.items()}


class _Unread:
    """A reader for a link of unknown protocol."""

    def read(self, _sender: str, _packet: Packet) -> str:
        """Return the note that it is unknown."""
        return "on a link of unknown kind"


_UNKNOWN: Final = Protocols(_Unread)


@dataclass(frozen=True, slots=True)
class Carried:
    """A packet that a link has carried, wholly arrived at `at`, in nanoseconds from the start of the run."""

    at: Nanoseconds
    link: str
    sender: str
    packet: Packet


def _one_line(text: str) -> str:
    """Return a text without what would break its line, or command a terminal: it may be a third party's."""
    if text.isprintable():
        return text
    return "".join(one if one.isprintable() else repr(one)[1:-1] for one in text)


class Dissector:
    """A dissector of several links' packets; `kinds` gives a link's kind where it is not its name."""

    def __init__(self, kinds: Mapping[str, str] = MappingProxyType({})) -> None:
        self._kinds = kinds
        self._readers: dict[str, Reader] = {}

    def read(self, carried: Carried) -> str:
        """Return a carried packet as a line: when, where, who, the bytes, and what they say."""
        link, packet = carried.link, carried.packet
        protocols = kinds().get(self._kinds.get(link, link), _UNKNOWN)
        reader = self._readers.get(link)
        if reader is None:
            reader = self._readers[link] = protocols.reader()
        seconds, rest = divmod(carried.at, SECOND)
        line = _one_line(reader.read(carried.sender, packet))
        return f"{seconds}.{rest:09d} s  {link}  {carried.sender}  {protocols.written(packet)}  {line}"
