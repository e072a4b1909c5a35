"""The common part of the limits of all robots: one number within its bounds, and the text about it."""

from typing import Final

ROUNDING: Final = 1e-6
"""Share of a bound: a command that came as a 32-bit float is not above a bound by its rounding. It is clipped
all the same, only not reported."""


def bounded(
    value: float, high: float, unit: str, *, low: float | None = None, scale: float = 1.0
) -> tuple[float, str | None]:
    """Return the value within `low` (None: minus `high`) and `high`, and the reason where it was not.

    `unit` is that of the text, `scale` the factor into it.
    """
    allowed = min(max(value, -high if low is None else low), high)
    if abs(value - allowed) <= ROUNDING * high:
        return allowed, None
    return allowed, f"requested {value * scale:.2f} {unit}, allowed is {allowed * scale:.2f} {unit}"
