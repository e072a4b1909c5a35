"""STATUSTEXT: long texts cut into chunks and put together again."""

from dataclasses import dataclass
from typing import Final

from firmware_bridge.safety.row import Severity
from firmware_bridge.teleop.mavlink import Message, dialect, text_of
from firmware_bridge.units import SECOND, Nanoseconds

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


class Speaker:
    """Makes STATUSTEXT messages, numbers the long ones, and says the same refusal only every two seconds."""

    QUIET: Final[Nanoseconds] = 2 * SECOND

    def __init__(self) -> None:
        self._number = 0
        self._said_at: dict[str, Nanoseconds] = {}

    def say(self, severity: Severity, text: str) -> list[Message]:
        """Return the text as one message, or as several with one number."""
        cuts = chunks(text)
        number = 0
        if len(cuts) > 1:
            number = self._number = self._number % _LAST_ID + 1
        return [dialect.MAVLink_statustext_message(severity, cut, number, at) for at, cut in enumerate(cuts)]

    def say_sometimes(self, key: str, text: str, now: Nanoseconds) -> list[Message]:
        """Return a warning, or nothing where one with this key was said less than two seconds ago."""
        said_at = self._said_at.get(key)
        if said_at is not None and now - said_at < self.QUIET:
            return []
        self._said_at[key] = now
        return self.say(Severity.WARNING, text)


@dataclass(frozen=True, slots=True)
class Heard:
    """A whole text, as its receiver reads it."""

    severity: int
    text: str


class Listener:
    """Puts the chunks of one sender's texts together; a text that lacks a chunk is told as far as it came."""

    def __init__(self) -> None:
        self._number = 0
        self._severity = 0
        self._cuts: list[str] = []

    def hear(self, message: Message) -> list[Heard]:
        """Take one STATUSTEXT; return the texts that are now whole, or will never be."""
        text = text_of(message.text)
        told: list[Heard] = []
        if self._number and (message.id != self._number or message.chunk_seq != len(self._cuts)):
            told += self._tell("...")
        if message.id == 0:
            return [*told, Heard(message.severity, text)]
        self._number, self._severity = message.id, message.severity
        self._cuts.append(text)
        return told + self._tell("") if len(text) < CHUNK else told

    def _tell(self, ending: str) -> list[Heard]:
        heard = Heard(self._severity, ("".join(self._cuts) + ending).rstrip())
        self._number = 0
        self._cuts = []
        return [heard]
