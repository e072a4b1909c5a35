"""Poses in MAVLink: VISION_POSITION_ESTIMATE and ODOMETRY, read without the rest of the dialect.

Source: MAVLink's serialization guide (frames of version 1 and 2, X.25 check sum with an extra byte for each
message, zeros cut at the end of version 2) and common.xml. Position and attitude arrive in axes x ahead, y to
the right, z downwards, and leave as x ahead, y to the left, z upwards. Signatures are not checked here.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from struct import Struct
from typing import Final

V1: Final = 0xFE
V2: Final = 0xFD
_HEAD_V1: Final = 6
_HEAD_V2: Final = 10
_CHECK: Final = 2
_SIGNED: Final = 0x01
_SIGNATURE: Final = 13
_FAILED: Final = -1
"""The quality of an estimate that its sender does not believe."""
LOCAL_NED: Final = 1
LOCAL_FRD: Final = 20
VISION_NED: Final = 16
MOCAP_NED: Final = 14
FRAMES: Final = frozenset({LOCAL_NED, LOCAL_FRD, VISION_NED, MOCAP_NED})
"""Frames of ODOMETRY whose origin stays, with x ahead, or to the north, and z downwards."""


@dataclass(frozen=True, slots=True)
class MavlinkPose:
    """One pose: m, and x, y, z, w."""

    stamp_us: int
    position: tuple[float, float, float]
    attitude: tuple[float, float, float, float]
    resets: int
    """Count of the estimate's jumps, wrapping from 255 to 0."""
    failed: bool
    """True where the sender reports that the estimate is lost."""
    deviation_m: float
    """The sender's estimate of its error; 0 where none is given."""


_VISION: Final = Struct("<Q6f21fB")
_ODOMETRY: Final = Struct("<Q3f4f6f21f21fBBBBb")


def _vision(payload: bytes) -> MavlinkPose | None:
    stamp, x, y, z, roll, pitch, yaw, variance, *rest = _VISION.unpack(payload)
    # From x, y, z = ahead, right, down to ahead, left, up: y and z change sign, and so do pitch and yaw.
    attitude = _from_angles(roll, -pitch, -yaw)
    return MavlinkPose(stamp, (x, -y, -z), attitude, int(rest[-1]), failed=False, deviation_m=_root(variance))


def _odometry(payload: bytes) -> MavlinkPose | None:
    stamp, x, y, z, qw, qx, qy, qz, *rest = _ODOMETRY.unpack(payload)
    frame, _child, resets, _estimator, quality = rest[-5:]
    if frame not in FRAMES:
        return None
    return MavlinkPose(
        stamp,
        (x, -y, -z),
        # The same half turn about x: of the vector part y and z change sign. MAVLink sends w first.
        (qx, -qy, -qz, qw),
        int(resets),
        failed=quality == _FAILED,
        deviation_m=_root(rest[6]),
    )


@dataclass(frozen=True, slots=True)
class _Row:
    """One message: the byte that its check sum has beside, its length, and how it is read."""

    extra: int
    length: int
    read: Callable[[bytes], MavlinkPose | None]


ROWS: Final[Mapping[int, _Row]] = {
    102: _Row(158, _VISION.size, _vision),
    331: _Row(91, _ODOMETRY.size, _odometry),
}
"""Decoders by the message's number."""


def poses(datagram: bytes) -> Iterator[MavlinkPose]:
    """Yield the poses in a datagram, in order; what is none, or damaged, is passed over."""
    at = 0
    while at < len(datagram):
        size = _frame(datagram, at)
        if size == 0:
            at += 1
            continue
        pose = _pose(datagram[at : at + size])
        at += size
        if pose is not None:
            yield pose


def _frame(datagram: bytes, at: int) -> int:
    """Return the length of the frame that begins here; 0 where none does."""
    if len(datagram) - at < _HEAD_V1 + _CHECK or datagram[at] not in (V1, V2):
        return 0
    if datagram[at] == V1:
        size = _HEAD_V1 + datagram[at + 1] + _CHECK
    else:
        # Bit 0 of the incompatibility flags: a signature of 13 bytes follows the check sum.
        signed = datagram[at + 2] & _SIGNED
        size = _HEAD_V2 + datagram[at + 1] + _CHECK + (_SIGNATURE if signed else 0)
    return size if at + size <= len(datagram) else 0


def _pose(frame: bytes) -> MavlinkPose | None:
    v1 = frame[0] == V1
    head = _HEAD_V1 if v1 else _HEAD_V2
    # Version 1 has one byte for the message, version 2 has 24 bits with the low byte first.
    number = frame[5] if v1 else int.from_bytes(frame[7:10], "little")
    row = ROWS.get(number)
    end = head + frame[1]
    if row is None or frame[1] > row.length:
        return None
    # The extra byte stands for the message's definition: sender and reader must have the same fields.
    if check_sum(frame[1:end] + bytes((row.extra,))) != int.from_bytes(frame[end : end + _CHECK], "little"):
        return None
    # Version 2 cuts the zeros at a payload's end; they are put back.
    return row.read(frame[head:end].ljust(row.length, b"\0"))


def check_sum(data: bytes) -> int:
    """Return X.25's check sum as MAVLink has it."""
    crc = 0xFFFF
    for byte in data:
        low = (byte ^ crc) & 0xFF
        # CRC-16 with polynomial 0x1021, reflected, a byte at a time and without a table; no final xor.
        low = (low ^ low << 4) & 0xFF
        crc = (crc >> 8) ^ (low << 8) ^ (low << 3) ^ (low >> 4)
    return crc & 0xFFFF


def _from_angles(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Return the quaternion of yaw, then pitch, then roll, in rad; NaN for what is no number."""
    if not all(map(math.isfinite, (roll, pitch, yaw))):
        return (math.nan,) * 4
    cr, sr = math.cos(roll / 2.0), math.sin(roll / 2.0)
    cp, sp = math.cos(pitch / 2.0), math.sin(pitch / 2.0)
    cy, sy = math.cos(yaw / 2.0), math.sin(yaw / 2.0)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def _root(variance: float) -> float:
    return math.sqrt(variance) if 0.0 <= variance < math.inf else 0.0
