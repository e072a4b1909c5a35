"""An IMU's line, decoded: one text for each frame."""

from collections.abc import Iterator
from math import degrees
from typing import Final

from firmware_bridge.dissector.lines import UNREAD, BoardLine
from firmware_bridge.families.imu.wire import COUNTS_PER_G, RADIANS, FrameReader, ImuFrame, Status


class ImuLine(BoardLine):
    """A reader of the bytes of one line."""

    def __init__(self) -> None:
        self._frames: Final = FrameReader()
        self._skipped = 0

    def to_board(self, chunk: bytes) -> Iterator[str]:
        """Yield that no command is known: the device takes none."""
        yield f"{UNREAD}: {len(chunk)} bytes"

    def from_board(self, chunk: bytes) -> Iterator[str]:
        """Yield the frames that these bytes complete."""
        for frame in self._frames.receive(chunk):
            yield _text(frame)
        if self._frames.skipped != self._skipped:
            yield f"{self._frames.skipped - self._skipped} bytes outside frames"
            self._skipped = self._frames.skipped


def _text(frame: ImuFrame) -> str:
    """Return a frame as text: number, clock, specific force in g, rates in deg/s, and its flags."""
    force = " ".join(f"{value / COUNTS_PER_G:+.3f}" for value in frame.force)
    rate = " ".join(f"{degrees(value * RADIANS):+.2f}" for value in frame.rate)
    flags = "".join(f", {flag.name.lower()}" for flag in Status if flag.name and frame.status & flag)
    return f"frame {frame.sequence} at {frame.stamp_ms} ms: {force} g, {rate} deg/s{flags.replace('_', ' ')}"
