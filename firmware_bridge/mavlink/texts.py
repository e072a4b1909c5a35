"""STATUSTEXT: long texts cut into chunks and put together again."""

from dataclasses import dataclass
from typing import Final

from firmware_bridge.mavlink.frames import Message, dialect, text_of
from firmware_bridge.units import SECOND, Nanoseconds

_WARNING: Final = dialect.MAV_SEVERITY_WARNING
CHUNK: Final = 50
"""Characters in one STATUSTEXT; a chunk with fewer is the last (common.xml, STATUSTEXT)."""

_LAST_ID: Final = 0xFFFF
_PLAIN: Final = str.maketrans({"\u00b0": " deg", "\u00b2": "2", "\u2013": "-", "\u2212": "-", "\n": " "})


def chunks(text: str) -> list[bytes]:
    """Cut a text into chunks of which only the last is shorter than 50 characters, and none is empty."""
    plain = text.translate(_PLAIN).encode("ascii", "replace").replace(b"\0", b" ") or b"-"
    if len(plain) > CHUNK and len(plain) % CHUNK == 0:
        plain += b" "  # a full last chunk would leave its receiver waiting for more
    return [plain[at : at + CHUNK] for at in range(0, len(plain), CHUNK)]


@dataclass(slots=True)
class _Repeat:
    """A text that may come again."""

    at: Nanoseconds
    quiet: Nanoseconds
    """For so long it does not."""
    kept_back: int = 0


class Speaker:
    """A maker of STATUSTEXT messages that numbers the long ones and limits repeated warnings.

    The same refusal is sent only every two seconds, and ever more seldom while a stream of messages causes
    it.
    """

    QUIET: Final[Nanoseconds] = 2 * SECOND
    QUIETEST: Final[Nanoseconds] = 32 * SECOND
    STREAM: Final = 10
    """So often in one quiet time no one presses a button."""
    MOST: Final = 64
    """Kinds of texts that are remembered."""

    def __init__(self) -> None:
        self._number = 0
        self._repeats: Final[dict[str, _Repeat]] = {}

    def say(self, severity: int, text: str) -> list[Message]:
        """Return the text as one message, or as several with one number."""
        cuts = chunks(text)
        number = 0
        if len(cuts) > 1:
            # 0 stands for a text in one piece, so that long ones count from 1 (STATUSTEXT, id).
            number = self._number = self._number % _LAST_ID + 1
        return [dialect.MAVLink_statustext_message(severity, cut, number, at) for at, cut in enumerate(cuts)]

    def say_sometimes(self, key: str, text: str, now: Nanoseconds) -> list[Message]:
        """Return a warning, or nothing where one with this key was sent less than two seconds ago."""
        earlier = self._repeats.pop(key, None)
        quiet = self.QUIET
        if earlier is not None:
            if now - earlier.at < earlier.quiet:
                earlier.kept_back += 1
                self._repeats[key] = earlier
                return []
            # A key that is pressed again is a person; ten in one quiet time is a program.
            streams = earlier.kept_back >= self.STREAM and now - earlier.at < 2 * earlier.quiet
            quiet = min(2 * earlier.quiet, self.QUIETEST) if streams else self.QUIET
        while len(self._repeats) >= self.MOST:
            del self._repeats[next(iter(self._repeats))]
        self._repeats[key] = _Repeat(now, quiet)
        return self.say(_WARNING, text)


@dataclass(frozen=True, slots=True)
class Received:
    """A whole text, as its receiver reads it."""

    severity: int
    text: str


class TextCollector:
    """A collector of one sender's texts; one that lacks a chunk is returned as far as it came."""

    def __init__(self) -> None:
        self._number = 0
        self._severity = 0
        self._cuts: list[str] = []

    def receive(self, message: Message) -> list[Received]:
        """Take one STATUSTEXT; return the texts that are now whole, or will never be."""
        text = text_of(message.text)
        due: list[Received] = []
        # A chunk is missing: what came so far is shown, and the next text begins.
        if self._number and (message.id != self._number or message.chunk_seq != len(self._cuts)):
            due += self._whole("...")
        if message.id == 0:
            return [*due, Received(message.severity, text)]
        self._number, self._severity = message.id, message.severity
        self._cuts.append(text)
        return due + self._whole("") if len(text) < CHUNK else due

    def _whole(self, ending: str) -> list[Received]:
        received = Received(self._severity, ("".join(self._cuts) + ending).rstrip())
        self._number = 0
        self._cuts = []
        return [received]
