"""The serial protocol "imu-serial", which is this project's own: frames of 22 bytes, sent 100 times a second.

The device sends by itself and takes no command. 8N1, 115,200 Bd by default; numbers are little-endian:

| byte | type | content |
|---|---|---|
| 0 | 2 bytes | sync, A5 5A |
| 2 | uint8 | sequence counter; the next frame has one more, 0 follows 255 |
| 3 | uint8 | status: `Status` |
| 4 | uint32 | device's clock at the sample, ms; it begins at 0 and wraps |
| 8 | 3 int16 | specific force along x, y, z: 8192 for 1 g, range 4 g |
| 14 | 3 int16 | rate about x, y, z, right-handed: 65.5 for 1 deg/s, range 500 deg/s |
| 20 | uint16 | CRC-16/IBM-3740 (polynomial 0x1021, begin 0xFFFF, not reflected) of bytes 2 to 19 |

At rest the axis that points upwards has +1 g. Scales are those of the MPU-6050 (RM-MPU-6000A-00, AFS_SEL 1,
FS_SEL 1).

Golden frame, level and at rest, sequence 7, 1,000 ms: `A5 5A 07 00 E8 03 00 00 00 00 00 00 00 20 00 00 00 00
00 00 65 EB`.
"""

import math
import struct
from binascii import crc_hqx
from collections.abc import Iterator
from enum import IntFlag
from typing import Final, NamedTuple

from firmware_bridge.units import STANDARD_GRAVITY

SYNC: Final = b"\xa5\x5a"
LENGTH: Final = 22
RATE_HZ: Final = 100
COUNTS_PER_G: Final = 8192.0
COUNTS_PER_DEG_S: Final = 65.5
METRES: Final = STANDARD_GRAVITY / COUNTS_PER_G
"""One count of a specific force, m/s2."""
RADIANS: Final = math.radians(1.0) / COUNTS_PER_DEG_S
"""One count of a rate, rad/s."""
WRAP_MS: Final = 1 << 32
SEQUENCES: Final = 256
_BODY: Final = struct.Struct("<BBI6h")
_CRC: Final = struct.Struct("<H")
_BEGIN: Final = 0xFFFF
_END: Final = LENGTH - _CRC.size

Counts = tuple[int, int, int]


class Status(IntFlag):
    """Bits of the status byte; the others are 0."""

    FAILED = 1
    """Its self-test has failed: no value counts."""
    FORCE_CLIPPED = 2
    """A specific force was beyond its range."""
    RATE_CLIPPED = 4
    """A rate was beyond its range."""


class ImuFrame(NamedTuple):
    """One frame."""

    sequence: int
    status: int
    stamp_ms: int
    force: Counts
    """Specific force along x, y, z, in counts."""
    rate: Counts
    """Rate about x, y, z, in counts."""


def crc(data: bytes) -> int:
    """Return the CRC-16/IBM-3740 of some bytes."""
    return crc_hqx(data, _BEGIN)


def encoded(frame: ImuFrame) -> bytes:
    """Return a frame as its bytes; struct.error for a number out of its type's range."""
    body = _BODY.pack(frame.sequence, frame.status, frame.stamp_ms, *frame.force, *frame.rate)
    return SYNC + body + _CRC.pack(crc(body))


def decoded(data: bytes) -> ImuFrame | None:
    """Return the frame in `LENGTH` bytes; None where sync or CRC is wrong."""
    if not data.startswith(SYNC) or _CRC.unpack_from(data, _END)[0] != crc(data[len(SYNC) : _END]):
        return None
    sequence, status, stamp_ms, ax, ay, az, gx, gy, gz = _BODY.unpack_from(data, len(SYNC))
    return ImuFrame(sequence, status, stamp_ms, (ax, ay, az), (gx, gy, gz))


class FrameReader:
    """A reader that finds frames in the bytes of a line, however they are cut."""

    def __init__(self) -> None:
        self._waiting = b""
        self.refused = 0
        """Frames with a wrong CRC."""
        self.skipped = 0
        """Bytes outside frames."""

    def receive(self, chunk: bytes) -> Iterator[ImuFrame]:
        """Take bytes; yield the frames that they complete."""
        data, at = self._waiting + chunk, 0
        while True:
            found = data.find(SYNC, at)
            if found < 0:
                # The last byte may be the first half of a sync.
                found = len(data) - 1 if data.endswith(SYNC[:1]) else len(data)
            found = max(found, at)
            self.skipped += found - at
            at = found
            if len(data) - at < LENGTH:
                break
            frame = decoded(data[at : at + LENGTH])
            if frame is not None:
                at += LENGTH
                # Before the frame is handed on: its taker may stop here.
                self._waiting = data[at:]
                yield frame
            else:
                # The sync may have been a value's bytes: the next one is looked for behind its first byte.
                self.refused += 1
                self.skipped += 1
                at += 1
        self._waiting = data[at:]

    def flush(self) -> None:
        """Forget half a frame."""
        self._waiting = b""
