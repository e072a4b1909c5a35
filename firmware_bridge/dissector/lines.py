"""Traffic on a serial line to a board, decoded both ways; a class for each protocol is its family's.

The end named bridge sends requests; any other is the board. However the line is cut into chunks, each command
is shown once, with the chunk that ends it.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from typing import Final

from firmware_bridge.packet import Packet
from firmware_bridge.wire.lines import LineReader

BRIDGE: Final = "bridge"
"""Name of the end that sends requests."""
UNREAD: Final = "no command that is known"


def called(name: str, what: str) -> str:
    """Return a command's name, and its values where it has any."""
    return f"{name}: {what}" if what else name


class BoardLine(ABC):
    """A reader of the bytes of one line."""

    def read(self, sender: str, packet: Packet) -> str:
        """Return the text of the commands that the bytes complete, or a note of an unfinished one."""
        texts = self.to_board(packet.payload) if sender == BRIDGE else self.from_board(packet.payload)
        return "; ".join(texts) or "part of a line"

    @abstractmethod
    def to_board(self, chunk: bytes) -> Iterator[str]:
        """Yield the commands that these bytes of the bridge complete."""

    @abstractmethod
    def from_board(self, chunk: bytes) -> Iterator[str]:
        """Yield the answers that these bytes of the board complete."""


class TextLine(BoardLine):
    """A reader of lines of text; `answer` decodes one of the board's, without its end."""

    def __init__(self, answer: Callable[[bytes], str], end: bytes = b"\n") -> None:
        self._answer: Final = answer
        self._requests: Final = LineReader(end)
        self._answers: Final = LineReader(end)

    def to_board(self, chunk: bytes) -> Iterator[str]:
        """Yield the requests as they are."""
        yield from (line.decode("latin-1") for line in self._requests.receive(chunk))

    def from_board(self, chunk: bytes) -> Iterator[str]:
        """Yield the answers, decoded."""
        yield from map(self._answer, self._answers.receive(chunk))
