"""Lines of text on a serial line, found in its bytes."""

from collections.abc import Iterator
from typing import Final

LINE_END: Final = b"\r\n"
"""As `Serial.println` of an Arduino ends a line."""
LONGEST_LINE: Final = 64
"""Longest line of a board in bytes, for a collector of lines."""


class LineReader:
    """A reader that splits bytes into lines; one too long is dropped. By default the host's end."""

    def __init__(self, end: bytes = LINE_END, longest: int = LONGEST_LINE) -> None:
        self._end: Final = end
        self._longest: Final = longest
        self._waiting = bytearray()
        self._dropped = False
        """True while a line has begun that is too long already."""

    @property
    def waiting(self) -> bytes:
        """The part received of a line that has no end yet."""
        return bytes(self._waiting)

    def receive(self, chunk: bytes) -> Iterator[bytes]:
        """Take bytes; yield lines without their ends."""
        for byte in chunk:
            self._waiting.append(byte)
            if self._waiting.endswith(self._end):
                line, dropped = bytes(self._waiting[: -len(self._end)]), self._dropped
                self.flush()
                if len(line) <= self._longest and not dropped:
                    yield line
            elif len(self._waiting) > self._longest + len(self._end):
                # A board that never ends its line must not fill the memory: only its end is waited for.
                self._dropped = True
                del self._waiting[: -len(self._end)]

    def flush(self) -> None:
        """Forget half a line, as the driver does before each command."""
        self._waiting.clear()
        self._dropped = False
