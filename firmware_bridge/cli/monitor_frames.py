"""`monitor --lines` and `--changes`: frames in words, one line each, of the chosen services and nodes."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from firmware_bridge.cli.console import refusal, say
from firmware_bridge.cli.monitor_grid import printable
from firmware_bridge.cli.monitor_table import address_text, instant
from firmware_bridge.cli.node_numbers import numbers
from firmware_bridge.dissector.canopen import SERVICE_NAMES, service_name
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.can import identifier

if TYPE_CHECKING:
    from firmware_bridge.dissector.bus_picture import BusPicture

HIGHEST: Final = 0x1FFF_FFFF


@dataclass(frozen=True, slots=True)
class Chosen:
    """The frames that are shown."""

    services: frozenset[str] = frozenset()
    identifiers: tuple[range, ...] = ()
    """With `services`: either; both empty: all."""
    nodes: frozenset[int] = frozenset()
    """Sender or receiver; empty: all."""

    def has(self, picture: "BusPicture", packet: Packet) -> bool:
        """Return whether a frame is shown; one to all nodes is of each node."""
        if self.services or self.identifiers:
            number = identifier(packet.address)
            named = service_name(packet) in self.services
            if not named and not any(number in one for one in self.identifiers):
                return False
        return self.of_node(picture, packet)

    def of_node(self, picture: "BusPicture", packet: Packet) -> bool:
        """Return whether a frame is of a chosen node, or of all nodes."""
        return not self.nodes or picture.node_of(packet) in {None, *self.nodes}


def chosen(filters: str | None, nodes: str | None) -> Chosen:
    """Read --filter and --node; an error ends the program with a message."""
    services, identifiers = set[str](), list[range]()
    for word in filters.split(",") if filters else ():
        if word in SERVICE_NAMES:
            services.add(word)
        else:
            identifiers.append(_identifiers(word))
    picked = frozenset(numbers(nodes)) if nodes else frozenset()
    return Chosen(frozenset(services), tuple(identifiers), picked)


def _identifiers(word: str) -> range:
    """Return the identifiers that a word names, as 181 or 0x180-0x1FF."""
    first, _, last = word.partition("-")
    try:
        begin, end = int(first, 16), int(last or first, 16)
    except ValueError:
        begin, end = 1, 0
    if not 0 <= begin <= end <= HIGHEST:
        known = ", ".join(SERVICE_NAMES)
        raise refusal(f"--filter {word}: give {known}, or identifiers as 181 or 180-1FF")
    return range(begin, end + 1)


@dataclass(frozen=True, slots=True)
class FrameLines:
    """Frames as lines, in their order."""

    picture: "BusPicture"
    chosen: Chosen
    changes: bool = False
    """Only those that differ from the one before with their identifier."""
    _last: dict[int, bytes] = field(default_factory=dict)

    def note(self, now: Nanoseconds, packet: Packet) -> None:
        """Take a frame; print it where it is to be shown, and what has changed with it."""
        # A heartbeat that is overdue is another node's event than this frame.
        changed = self.late(now)
        texts = self.picture.note(now, packet)
        if self.chosen.of_node(self.picture, packet):
            changed += texts
        before = self._last.get(packet.address)
        self._last[packet.address] = packet.payload
        if self.changes:
            for text in changed:
                say(f"{instant(self.picture, now):>12}       {printable(text)}")
            if before == packet.payload:
                return
        if self.chosen.has(self.picture, packet):
            at, name = instant(self.picture, now), address_text(packet.address)
            say(f"{at:>12}  {name:>4} {printable(self.picture.text_of(packet))}")

    def late(self, now: Nanoseconds) -> tuple[str, ...]:
        """Take note that it is `now`; return a text for each chosen node whose heartbeat is overdue now."""
        late = self.picture.overdue(now)
        return tuple(text for node, text in late if not self.chosen.nodes or node in self.chosen.nodes)
