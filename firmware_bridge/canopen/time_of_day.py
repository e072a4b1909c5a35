"""Time of day as CANopen sends it in TIME: six bytes, milliseconds after midnight and days since 1984.

Source: CiA 301 v4.02, TIME_OF_DAY: 28 bits of milliseconds, 4 reserved bits, 16 bits of days since
1984-01-01. It has no time zone.
"""

from datetime import datetime, timedelta
from typing import Final

EPOCH: Final = datetime(1984, 1, 1)  # noqa: DTZ001 - the message has no time zone
LENGTH: Final = 6
_MILLISECONDS: Final = (1 << 28) - 1


def encode_time(time: datetime) -> bytes:
    """Return the payload of TIME; ValueError for a time before 1984 or after 65,535 days."""
    since = time - EPOCH
    if not 0 <= since.days < 1 << 16:
        raise ValueError(f"TIME carries 1984-01-01 to 2163-06-06, not {time:%Y-%m-%d}")
    milliseconds = since.seconds * 1000 + since.microseconds // 1000
    return milliseconds.to_bytes(4, "little") + since.days.to_bytes(2, "little")


def decode_time(payload: bytes) -> datetime | None:
    """Return the time in `payload`; None where it is shorter than six bytes."""
    if len(payload) < LENGTH:
        return None
    milliseconds = int.from_bytes(payload[:4], "little") & _MILLISECONDS
    return EPOCH + timedelta(days=int.from_bytes(payload[4:6], "little"), milliseconds=milliseconds)
