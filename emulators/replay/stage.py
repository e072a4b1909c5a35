"""Interface of a replay's target to the player; and the common parts of all such worlds."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, TypeAlias

from emulators.replay.comparison import Comparison
from emulators.replay.order import ReplayOrder
from emulators.replay.recordings import RESOLUTION
from emulators.replay.senders import Sent
from emulators.world import World
from firmware_bridge.bridge import Bridge
from firmware_bridge.dissector.canopen import service_name
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, Nanoseconds

RECORDING: Final = "recording"
"""The station that plays what was recorded."""
Duration: TypeAlias = Callable[[Packet], Nanoseconds]
"""Duration of a packet on its link."""


@dataclass(frozen=True, slots=True)
class ReplayStage:
    """A world at its start, what is compared in it, and how to move it on."""

    run: Callable[[Nanoseconds], None]
    comparisons: tuple[Comparison, ...]
    recorded: Sequence[Sent]
    """All recorded packets, in order, to show those before a difference."""
    played: int
    end: Nanoseconds
    lead: Nanoseconds = 0
    """The instant at which the recording begins."""
    finish: Callable[[], None] = lambda: None
    bridge: Bridge | None = None
    """The bridge on all links; None where the drives or the bench are."""
    kinds: Mapping[str, str] = field(default_factory=dict)
    """The kinds of links that are called otherwise, as `dissector.Dissector` takes them."""


def not_after(order: ReplayOrder, sent: Sequence[Sent], lead: Nanoseconds = 0) -> list[Sent]:
    """Return the packets recorded up to the requested end."""
    until = NEVER if order.until is None else order.until + lead
    return [one for one in sent if one.entry.at <= until]


def end_of(order: ReplayOrder, *links: Sequence[Sent]) -> Nanoseconds:
    """Return the instant by which the last packet has come, or is missing."""
    # One more: what is missing counts only strictly behind its time.
    return max(sent[-1].entry.at for sent in links if sent) + order.tolerance + RESOLUTION + 1


def to_compare(order: ReplayOrder, frames: Sequence[Sent], senders: Collection[str]) -> list[Sent]:
    """Return the frames of these senders, but for services that are left out."""
    return [
        one for one in frames if one.sender in senders and service_name(one.entry.packet) not in order.without
    ]


def first_of(sent: Sequence[Sent], sender: str) -> Sent | None:
    """Return the first packet of a sender; None where there is none."""
    return next((one for one in sent if one.sender == sender), None)


def begin_of(sent: Sent, duration: Duration) -> Nanoseconds:
    """Return when a packet began; what stands in a recording is when it had wholly arrived."""
    return sent.entry.at - duration(sent.entry.packet)


def script_of(sent: Sequence[Sent], duration: Duration) -> list[tuple[Nanoseconds, Packet]]:
    """Return when each packet is to begin."""
    begin, script = 0, []
    for one in sent:
        # Not before the packet in front of it, whatever the recording's resolution has cut.
        begin = max(begin, begin_of(one, duration))
        script.append((begin, one.entry.packet))
    return script


def call_at(world: World, at: Nanoseconds, call: Callable[[], object]) -> None:
    """Call a function at an instant."""
    if at <= 0:
        call()
    else:

        def do(_: object) -> None:
            call()

        world.call_at(at, do)
