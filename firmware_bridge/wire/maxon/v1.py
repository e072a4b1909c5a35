"""V1 on RS232: what both ends share: the bytes of the handshake, and a frame as it comes in.

Source: EPOS2 Application Notes Collection, April 2013, p. 11-166; EPOS Communication Guide, October 2006.
A command goes `opcode`, then `O` or `F` comes back; the rest goes, and again `O` or `F` comes; the answer's
opcode 0 comes, and the host says `O`; its rest comes, and the host says `O` or `F`. Where they are silent:

* Bytes that arrive while the device works on a command wait, up to `ROOM` of them, and count afterwards.
* Whatever the host says instead of `O` is dropped together with the answer; its last `F` repeats nothing.
* A device's phase lasts from its own last byte to the last byte that it wants from the host.
"""

from typing import Final

from firmware_bridge.units import MILLISECOND
from firmware_bridge.wire.maxon import crc
from firmware_bridge.wire.maxon.frame import Frame

OKAY: Final = 0x4F
FAILED: Final = 0x46
FRAME_TIMEOUT: Final = 500 * MILLISECOND
"""Default of 0x2005; a host that failed is silent for so long, and the device is idle again."""
ROOM: Final = 1024
_HEAD: Final = 2


class Rest:
    """A frame behind its opcode as it comes in: length, data, check sum."""

    def __init__(self, opcode: int) -> None:
        self._taken = bytearray((opcode,))

    def take(self, byte: int) -> bool:
        """Take a byte; True when the frame is whole."""
        self._taken.append(byte)
        return len(self._taken) == _HEAD + 2 * (self._taken[1] + 1) + crc.SIZE

    def frame(self) -> Frame | None:
        """Return the whole frame; None where the check sum is wrong."""
        taken = bytes(self._taken)
        body = taken[_HEAD : -crc.SIZE]
        told = int.from_bytes(taken[-crc.SIZE :], "little")
        return Frame(taken[0], body) if crc.checksum(taken[0] << 8 | taken[1], body) == told else None
