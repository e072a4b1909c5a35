"""Units and constants that every layer shares: integer nanoseconds, rpm, quadcounts."""

import math
from typing import Final, TypeAlias

Nanoseconds: TypeAlias = int
"""An instant or a duration. Instants count from the start of the run; never a float."""

MICROSECOND: Final[Nanoseconds] = 1_000
MILLISECOND: Final[Nanoseconds] = 1_000_000
SECOND: Final[Nanoseconds] = 1_000_000_000
NEVER: Final[Nanoseconds] = 2**62 - 1
"""An instant that does not come: 146 years on."""

STANDARD_GRAVITY: Final = 9.81
"""m/s2, the value that the robots' sources use throughout."""

RPM_PER_RAD_S: Final = 60.0 / (2.0 * math.pi)
QUADCOUNTS_PER_LINE: Final = 4
"""Edges of two encoder channels for each line of the disc."""


def from_seconds(seconds: float) -> Nanoseconds:
    """Return the nearest whole number of nanoseconds."""
    return round(seconds * SECOND)


def to_seconds(duration: Nanoseconds) -> float:
    """Return a duration in seconds, for people and for formulas; never to be added up."""
    return duration / SECOND
