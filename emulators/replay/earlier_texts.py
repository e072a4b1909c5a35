"""A recording in the words of the release before: all of it is compared but STATUSTEXT and one status.

A text of another length is another number of messages, so sequence numbers are not compared either: each
recorded message must be among those that were sent before, as often as its sender has sent it. The status in
HEARTBEAT follows from the active interlocks now, and is not compared, nor the health in SYS_STATUS.
"""

import warnings
from collections import defaultdict, deque
from collections.abc import Iterable, Sequence
from typing import Final

from emulators.replay.comparison import Comparison, Difference, Messages
from emulators.replay.recordings import RESOLUTION
from emulators.replay.senders import Sent
from firmware_bridge.packet import Packet
from firmware_bridge.recording import MAVLINK_2, mavlink_messages
from firmware_bridge.renamed import RenamedWarning
from firmware_bridge.units import Nanoseconds

OLD_WORDS: Final = b"released: "
"""Begin of a text that an interlock event was over; it is "cleared: " now."""
NOT_COMPARED: Final = (
    "the recording's texts are of the release before: all is compared but STATUSTEXT and HEARTBEAT's status"
)
_STATUSTEXT: Final = 253
_CHANGED: Final = {0: slice(7, 8), 1: slice(8, 12)}
"""What is not compared of HEARTBEAT, its system_status, and of SYS_STATUS, its sensors' health: places in the
payload (common.xml, in the order on the wire)."""
_V1_NUMBER: Final = slice(5, 6)
_V1_HEAD: Final = 6
_V2_NUMBER: Final = slice(7, 10)
_V2_HEAD: Final = 10


def answers_of(recorded: Iterable[Sent], sender: str) -> Comparison:
    """Return what compares the messages of one MAVLink system with those recorded of it."""
    own = [one for one in recorded if one.sender == sender]
    texts = (one.entry.packet.payload for one in own)
    if any(_content(text)[0] == _STATUSTEXT and OLD_WORDS in text for text in texts):
        warnings.warn(NOT_COMPARED, RenamedWarning, stacklevel=2)
        return AllButTexts(own, sender)
    return Messages(own, sender)


class AllButTexts:
    """Compares the messages of one MAVLink system by their contents, texts left out."""

    def __init__(self, recorded: Sequence[Sent], sender: str) -> None:
        self.compared = 0
        self._expected = deque(one for one in recorded if not _is_text(one.entry.packet.payload))
        self._sender = sender
        self._sent: defaultdict[tuple[int, bytes], deque[Nanoseconds]] = defaultdict(deque)
        """The instants at which each content was sent, but for those that were recorded."""
        self._matched: set[bytes] = set()
        """Recorded messages that have come; a link may double a datagram, and the recording has it twice."""
        self._found: Difference | None = None

    def take(self, now: Nanoseconds, sender: str, packet: Packet) -> None:
        """Keep the messages of a datagram until their arrival is due."""
        if sender == self._sender:
            for message in mavlink_messages(packet.payload):
                self._sent[_content(message)].append(now)

    def differences(self, now: Nanoseconds) -> Iterable[Difference]:
        """Return the first message that was not sent before it had arrived."""
        while self._found is None and self._expected:
            wanted = self._expected[0].entry
            if wanted.at + RESOLUTION > now:
                break
            message = wanted.packet.payload
            sent = self._sent[_content(message)]
            if message not in self._matched:
                if not sent or sent[0] >= wanted.at + RESOLUTION:
                    self._found = Difference(self._expected[0], None)
                    break
                sent.popleft()
                self._matched.add(message)
            self._expected.popleft()
            self.compared += 1
        return () if self._found is None else (self._found,)


def _is_text(message: bytes) -> bool:
    return _content(message)[0] == _STATUSTEXT


def _content(message: bytes) -> tuple[int, bytes]:
    """Return a message's number and what of its payload is compared; no sequence number, no checksum."""
    place, head = (_V2_NUMBER, _V2_HEAD) if message[0] == MAVLINK_2 else (_V1_NUMBER, _V1_HEAD)
    # Byte 1 is the payload's length in both versions of MAVLink.
    number, payload = int.from_bytes(message[place], "little"), message[head : head + message[1]]
    changed = _CHANGED.get(number, slice(0, 0))
    return number, payload[: changed.start] + payload[changed.stop :]
