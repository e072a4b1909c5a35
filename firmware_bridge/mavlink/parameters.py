"""The parameter protocol: rows with a value each, in an order that never changes.

Every value is REAL32, so that both ways of carrying integers agree. Source: mavlink.io, "Parameter Protocol".
"""

import math
import struct
from dataclasses import dataclass
from typing import Final

from firmware_bridge.mavlink.frames import Message, dialect, text_of
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

GAP: Final[Nanoseconds] = 10 * MILLISECOND
"""Gap between two parameters of a list, where the link's bandwidth is not given."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """One row: its name on the link, its first value, and how far it may be set."""

    name: str
    first: float
    unit: str
    writable: tuple[float, float] | None = None
    """Smallest and largest value that a station may set; None for a read-only row."""
    stream: int | None = None
    """The message whose rate in Hz this row is."""


class Store:
    """The values of one bridge, in the rows' order, which never changes while it runs."""

    def __init__(self, rows: tuple[Parameter, ...], gap: Nanoseconds = GAP) -> None:
        """Take the rows, and the time between two of them where all are listed."""
        self.rows: Final = rows
        self._gap: Final = gap
        self._listed = len(rows)
        self.list_due: Nanoseconds = NEVER
        """Time of the next one of a list; `NEVER` where none is under way."""
        self._values = [_as_float32(row.first) for row in rows]
        self._index = {row.name: index for index, row in enumerate(rows)}

    def begin_list(self, now: Nanoseconds) -> None:
        """Send all of them from now on, one after the other."""
        self._listed, self.list_due = 0, now

    def due(self, now: Nanoseconds) -> list[Message]:
        """Return those of the list that are due now."""
        messages: list[Message] = []
        while self.list_due <= now:
            messages.append(self.message(self._listed))
            self._listed += 1
            last = self._listed >= len(self.rows)
            self.list_due = NEVER if last else self.list_due + self._gap
        return messages

    def find(self, index: int, name: bytes | str) -> int | None:
        """Return the index that a message means: by name where `index` is -1."""
        # The parameter protocol: -1 means that the name counts.
        if index == -1:
            return self._index.get(text_of(name))
        return index if 0 <= index < len(self.rows) else None

    def change(self, index: int, value: float) -> str | None:
        """Set a value, or return the reason for which the old one stays."""
        row = self.rows[index]
        if row.writable is None:
            return f"{row.name} is read-only; it comes from the robot file"
        low, high = row.writable
        if not (math.isfinite(value) and low <= value <= high):
            return f"{row.name} takes {low:g} to {high:g} {row.unit}".rstrip()
        # Rounded to what the link carries: the answer and the bridge's own value are then equal.
        self._values[index] = _as_float32(value)
        return None

    def rate(self, index: int) -> tuple[int | None, float]:
        """Return the message whose rate this parameter is, and the rate in Hz."""
        return self.rows[index].stream, self._values[index]

    def value(self, index: int) -> float:
        """Return a value as the link carries it."""
        return self._values[index]

    def message(self, index: int) -> Message:
        """Return the PARAM_VALUE of a row."""
        name = self.rows[index].name.encode("ascii")
        kind = dialect.MAV_PARAM_TYPE_REAL32
        return dialect.MAVLink_param_value_message(name, self._values[index], kind, len(self.rows), index)


def _as_float32(value: float) -> float:
    narrow: float = struct.unpack("<f", struct.pack("<f", value))[0]
    return narrow
