"""Texts of a robot on a link that changes their order: chunks are put together by their numbers."""

from typing import Any, Final

from firmware_bridge.mavlink.frames import text_of
from firmware_bridge.mavlink.texts import CHUNK
from firmware_bridge.units import MILLISECOND, Nanoseconds

PATIENCE: Final[Nanoseconds] = 500 * MILLISECOND
"""Time for the chunks of a text; then it is shown as far as it came."""

TOGETHER: Final[Nanoseconds] = 200 * MILLISECOND
"""A text that comes again so soon is that to another station."""


class OrderedTexts:
    """Texts of STATUSTEXT messages, each once."""

    def __init__(self) -> None:
        self._open: dict[int, tuple[Nanoseconds, int, dict[int, str]]] = {}
        """Begin, severity and chunks of each text that is not whole, by its number."""
        self._whole: list[tuple[int, str]] = []
        self._recent: dict[tuple[int, str], Nanoseconds] = {}
        """Time of each text of the last instants."""

    def receive(self, message: Any, now: Nanoseconds) -> None:
        """Take one STATUSTEXT."""
        text = text_of(message.text)
        if message.id == 0:
            self._add(message.severity, text, now)
            return
        _, severity, cuts = self._open.setdefault(message.id, (now, message.severity, {}))
        cuts[message.chunk_seq] = text
        last = max(cuts)
        if len(cuts[last]) < CHUNK and len(cuts) == last + 1:
            del self._open[message.id]
            self._add(severity, "".join(cuts[number] for number in range(last + 1)), now)

    def take(self, now: Nanoseconds) -> list[tuple[int, str]]:
        """Return severity and text of what is whole, or waits for too long, since the last call."""
        for number, (begun, severity, cuts) in tuple(self._open.items()):
            if now - begun >= PATIENCE:
                del self._open[number]
                self._add(severity, "".join(f"{cuts[place]}..." for place in sorted(cuts)), now)
        taken, self._whole = self._whole, []
        return taken

    def _add(self, severity: int, text: str, now: Nanoseconds) -> None:
        found = (severity, text.rstrip())
        self._recent = {one: at for one, at in self._recent.items() if now - at < TOGETHER}
        # What goes to several stations comes several times.
        if found not in self._recent:
            self._whole.append(found)
        self._recent[found] = now
