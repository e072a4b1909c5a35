"""Output of a picture of a bus: a line on the whole, a table of nodes, a table of messages."""

from functools import lru_cache

from rich.console import Group
from rich.text import Text

from firmware_bridge.cli.monitor_grid import Grid
from firmware_bridge.dissector.bus_picture import BusPicture, NodeSeen
from firmware_bridge.units import MILLISECOND, to_seconds
from firmware_bridge.wire.can import EXTENDED, EXTENDED_MASK, REMOTE, identifier


def drawn(picture: BusPicture) -> Group:
    """Return what is known, to be printed. Instants count from the first frame."""
    return Group(Text(_head(picture)), Text(_error(picture)), _nodes(picture), _messages(picture))


def instant(picture: BusPicture, at: int) -> str:
    """Return an instant for people."""
    return f"{to_seconds(at - (picture.first_at or 0)):.3f} s"


def _head(picture: BusPicture) -> str:
    if picture.first_at is None:
        return "nothing received yet"
    return (
        f"{picture.frames} frames in {to_seconds(picture.elapsed):.3f} s; load at "
        f"{picture.bit_rate // 1000} kbit/s: {picture.load_percent:.1f} % in the last second, "
        f"{picture.mean_percent:.1f} % in all, {picture.peak_percent:.1f} % in the busiest 100 ms"
    )


def _error(picture: BusPicture) -> str:
    error = picture.error
    return "last error: none" if error is None else f"last error: {instant(picture, error.at)}, {error.text}"


def _nodes(picture: BusPicture) -> Grid:
    rows = []
    for one in picture.nodes:
        name = f"{one.node} {one.title}".rstrip()
        network = "unknown" if one.network is None else one.network.title
        emergencies = f"{one.emergencies}: {one.emergency}" if one.emergency else "none"
        rows.append((name, network, _beat(one), one.status or "not received", emergencies))
    return Grid("nodes", ("node", "network", "heartbeat", "statusword", "emergencies"), rows)


def _beat(one: NodeSeen) -> str:
    if one.missing:
        return "MISSING"
    return "not received" if one.period is None else f"{one.period / MILLISECOND:.0f} ms"


def _messages(picture: BusPicture) -> Grid:
    rows = [
        (address_text(address), title, f"{count:6}", f"{rate:4.0f}", text)
        for address, title, text, count, rate in picture.messages()
    ]
    return Grid("messages", ("id", "what", "frames", "1/s", "the last one"), rows)


@lru_cache(maxsize=4096)
def address_text(address: int) -> str:
    """Return an identifier as candump shows it; a remote request is marked."""
    # 11 bits in three digits, 29 bits in eight, as candump shows them.
    digits = 8 if address & EXTENDED else 3
    return f"{identifier(address) & EXTENDED_MASK:0{digits}X}{' R' if address & REMOTE else ''}"
