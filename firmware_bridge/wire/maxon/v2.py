"""V2 on USB, what both ends share: frames that begin with DLE STX, at any point, and double each DLE after.

Source: EPOS2 Application Notes Collection, April 2013, p. 11-164; EPOS4 Communication Guide (same link layer,
by analogy). Where they are silent:

* A DLE before anything else ends the frame, and so does a length above 143 words: both hunt for DLE STX.
* The time-out runs from DLE STX to the last byte of the frame. What it ends is not answered.
* A frame cut off just behind a DLE swallows the next one, which begins with a DLE; the time-out parts them.
* Bytes that arrive while the device works on a command wait, up to `ROOM` of them, and count afterwards.
"""

from enum import Enum, auto
from typing import Final

from firmware_bridge.wire.maxon import crc
from firmware_bridge.wire.maxon.frame import DLE, MOST_WORDS, STX, Frame

ROOM: Final = 1024
_HEAD: Final = 2


class Damaged(Enum):
    """A whole frame whose check sum is wrong."""

    DAMAGED = auto()


class Reader:
    """Finds frames among bytes, whatever stands between them."""

    def __init__(self) -> None:
        self.begun = 0
        """How many frames have begun so far."""
        self._escaped = False
        self._open = False
        self._taken = bytearray()

    @property
    def inside(self) -> bool:
        """Whether a frame has begun and not ended."""
        return self._open

    def reset(self) -> None:
        """Forget a frame that has begun."""
        self._escaped = self._open = False

    def take(self, byte: int) -> Frame | Damaged | None:
        """Take a byte; return the frame that it completes."""
        if self._escaped:
            if byte == STX:
                self._escaped, self._open = False, True
                self._taken.clear()
                self.begun += 1
                return None
            if byte != DLE:
                self.reset()
                return None
            if not self._open:
                return None  # outside a frame the second DLE may begin one
            self._escaped = False
        elif byte == DLE:
            self._escaped = True
            return None
        return self._append(byte) if self._open else None

    def _append(self, byte: int) -> Frame | Damaged | None:
        taken = self._taken
        taken.append(byte)
        if len(taken) < _HEAD:
            return None
        if taken[1] > MOST_WORDS:
            self.reset()
            return None
        if len(taken) < _HEAD + 2 * taken[1] + crc.SIZE:
            return None
        self.reset()
        body = bytes(taken[_HEAD : -crc.SIZE])
        told = int.from_bytes(taken[-crc.SIZE :], "little")
        if crc.checksum(taken[1] << 8 | taken[0], body) != told:
            return Damaged.DAMAGED
        return Frame(taken[0], body)
