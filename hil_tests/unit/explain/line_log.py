"""A recording of a serial line that a test writes, line by line."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from firmware_bridge.explain.explainer import Explained, Setup
from firmware_bridge.explain.line_explainer import Lines, explain_lines
from firmware_bridge.explain.line_source import chunks
from firmware_bridge.packet import Packet
from firmware_bridge.recording import Direction, chunk_line
from firmware_bridge.units import MILLISECOND

LINK = "board"


@dataclass
class LineLog:
    """Requests and answers in the order of time; instants in milliseconds."""

    now: int = 0
    lines: list[str] = field(default_factory=list)

    def wait(self, milliseconds: int) -> Self:
        self.now += milliseconds
        return self

    def sent(self, payload: bytes, link: str = LINK) -> Self:
        return self._line(Direction.SENT, payload, link)

    def received(self, payload: bytes, link: str = LINK) -> Self:
        return self._line(Direction.RECEIVED, payload, link)

    def exchanges(self, request: bytes, answer: bytes = b"", within: int = 5, cycle: int = 50) -> Self:
        """Send a request, and receive its answer, if it has one; then the rest of the cycle."""
        self.sent(request).wait(within)
        if answer:
            self.received(answer)
        return self.wait(cycle - within)

    def _line(self, direction: Direction, payload: bytes, link: str) -> Self:
        self.lines.append(chunk_line(self.now * MILLISECOND, link, direction, Packet(link, 0, payload)))
        return self

    def save(self, path: Path) -> Path:
        path.write_text("\n".join(self.lines) + "\n")
        return path

    def explained(self, folder: Path, protocol: str) -> Explained:
        notes: list[str] = []
        log = chunks(self.save(folder / "serial.log"), notes.append)
        found = explain_lines(log, Lines({LINK: protocol} if protocol else {}, Setup()))
        assert notes == []
        return found


def kinds_of(found: Explained) -> list[str]:
    """Names of the incidents' kinds, in the order of time."""
    return [one.kind.name for one in found.incidents]
