"""Comparison of a recording with its replay: sender by sender, up to the first difference.

Frames are compared in their order and at their instants. A datagram link delays, loses and overtakes, and a
recording has a message's time of arrival: so each recorded message must be among those sent before, found by
its sequence number. Each recipient has its own sequence numbers, and a recording does not state recipients: a
message of any of them will do. The link's name in the recording does not count.
"""

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final, Protocol

from emulators.replay.recordings import RESOLUTION
from emulators.replay.senders import Sent
from firmware_bridge.dissector import Carried, difference_text
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.recording import mavlink_messages, mavlink_origin
from firmware_bridge.units import MICROSECOND, NEVER, Nanoseconds

EXACT: Final[Nanoseconds] = 1
"""The resolution of instants that are recorded whole."""
_SEQUENCE_NUMBERS: Final = 256


@dataclass(frozen=True, slots=True)
class Difference:
    """A packet that should have come, and the one that came in its place; either may be missing."""

    wanted: Sent | None
    came: Carried | None

    @property
    def at(self) -> Nanoseconds:
        """The first of the two instants."""
        wanted = NEVER if self.wanted is None else self.wanted.entry.at
        return min(wanted, NEVER if self.came is None else self.came.at)


class Comparison(Protocol):
    """Comparison of the replayed packets with the expected ones."""

    compared: int
    """Number of recorded packets that have come as they should."""

    def take(self, now: Nanoseconds, sender: str, packet: Packet) -> None:
        """Compare what comes."""

    def differences(self, now: Nanoseconds) -> Iterable[Difference]:
        """Return what differs up to `now`; one for each sender at most."""


class Frames:
    """Comparison of frames, or bytes of a line, with those in `recorded` of the compared `senders`."""

    def __init__(
        self,
        recorded: Iterable[Sent],
        senders: Iterable[str],
        tolerance: Nanoseconds,
        until: Nanoseconds,
        *,
        link: str = CAN,
        resolution: Nanoseconds = RESOLUTION,
    ) -> None:
        """Compare what comes on a link, as the recording calls it, whose instants are cut to `resolution`."""
        self.compared = 0
        self._link: Final = link
        self._expected: dict[str, deque[Sent]] = {name: deque() for name in senders}
        for sent in recorded:
            self._expected[sent.sender].append(sent)
        self._slack = resolution + tolerance
        self._until = until
        self._found: dict[str, Difference] = {}

    def take(self, now: Nanoseconds, sender: str, packet: Packet) -> None:
        """Compare a frame with the next one of its sender."""
        expected = self._expected.get(sender)
        # Behind its first difference a sender is not compared: all that follows may be its consequence.
        if expected is None or sender in self._found:
            return
        came = Carried(now, self._link, sender, Packet(self._link, packet.address, packet.payload))
        if not expected:
            # Behind the end of the recording anything may come.
            if now < self._until:
                self._found[sender] = Difference(None, came)
            return
        wanted = expected.popleft()
        # Recorded instants are cut to the resolution: less than that is no difference.
        if came.packet != wanted.entry.packet or abs(now - wanted.entry.at) >= self._slack:
            self._found[sender] = Difference(wanted, came)
        else:
            self.compared += 1

    def differences(self, now: Nanoseconds) -> Iterable[Difference]:
        """Return what differs; a frame has not come when its time and the tolerance are over."""
        for sender, expected in self._expected.items():
            if expected and sender not in self._found and expected[0].entry.at + self._slack < now:
                self._found[sender] = Difference(expected[0], None)
        return self._found.values()


class Messages:
    """Comparison of the messages of one MAVLink system."""

    def __init__(self, recorded: Iterable[Sent], sender: str) -> None:
        self.compared = 0
        self._expected = deque(recorded)
        self._sender = sender
        self._sent: dict[int, list[deque[Carried]]] = {}
        """Sent messages by recipient and sequence number; the newest that may have arrived is the first."""
        self._found: Difference | None = None

    def take(self, now: Nanoseconds, sender: str, packet: Packet) -> None:
        """Keep the messages of a datagram until their arrival is due."""
        if sender == self._sender:
            for message in mavlink_messages(packet.payload):
                numbers = self._sent.setdefault(packet.address, [deque() for _ in range(_SEQUENCE_NUMBERS)])
                carried = Carried(now, OPERATOR, sender, Packet(OPERATOR, 0, message))
                numbers[mavlink_origin(message)[2]].append(carried)

    def differences(self, now: Nanoseconds) -> Iterable[Difference]:
        """Return what differs among the messages that had arrived before `now`."""
        while self._found is None and self._expected:
            wanted = self._expected[0].entry
            if wanted.at + RESOLUTION > now:
                break
            self._expected.popleft()
            sequence, before = mavlink_origin(wanted.packet.payload)[2], wanted.at + RESOLUTION
            came = [_newest(numbers[sequence], before) for numbers in self._sent.values()]
            if any(one is not None and one.packet == wanted.packet for one in came):
                self.compared += 1
            else:
                nearest = max(filter(None, came), key=lambda one: one.at, default=None)
                self._found = Difference(Sent(wanted, self._sender), nearest)
        return () if self._found is None else (self._found,)


def _newest(sent: deque[Carried], before: Nanoseconds) -> Carried | None:
    """Return the last of a recipient's messages with one number that was sent before an instant."""
    # Sequence numbers repeat after 256 messages: of those sent in time the last one counts.
    while len(sent) > 1 and sent[1].at < before:
        sent.popleft()
    return sent[0] if sent and sent[0].at < before else None


def first(comparisons: Sequence[Comparison], now: Nanoseconds) -> Difference | None:
    """Return the earliest difference up to `now`."""
    found = [one for comparison in comparisons for one in comparison.differences(now)]
    return min(found, key=lambda one: one.at, default=None)


def in_words(
    difference: Difference,
    recorded: Sequence[Sent],
    lead: Nanoseconds = 0,
    kinds: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """Return the place in the recording, the packets before it there, and both packets as texts.

    Instants count from `lead`, the begin of the recording; `kinds` as for `Dissector`.
    """
    wanted, came = difference.wanted, difference.came
    if wanted is not None:
        place = recorded.index(wanted)
        head = f"{wanted.entry.where} is the first that differs"
    else:
        place = next((i for i, one in enumerate(recorded) if one.entry.at > difference.at), len(recorded))
        head = "what came is not in the recording; "
        head += (
            f"it belongs before {recorded[place].entry.where}" if place < len(recorded) else "it is the last"
        )
    before = [_carried(one, lead) for one in recorded[:place]]
    expected = None if wanted is None else _carried(wanted, lead)
    lines = difference_text(
        head, before, expected, None if came is None else replace(came, at=came.at - lead), kinds
    )
    if wanted is not None and came is not None and wanted.entry.packet == came.packet:
        late = (came.at - wanted.entry.at) / MICROSECOND
        lines += f"\nthe same, but {abs(late):g} us {'later' if late > 0 else 'earlier'}"
    return lines


def _carried(sent: Sent, lead: Nanoseconds) -> Carried:
    entry = sent.entry
    return Carried(entry.at - lead, entry.packet.link, sent.sender, entry.packet)
