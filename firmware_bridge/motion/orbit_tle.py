"""An orbit by a two-line element set, as NORAD gives it: where the body is, by the library sgp4.

Source: F. R. Hoots, R. L. Roehrich, Spacetrack Report No. 3, 1980; D. A. Vallado et al., Revisiting
Spacetrack Report #3, AIAA 2006-6753. Its elements are mean ones, which no other way of propagation may take.
Axes are those of TEME; one DU is the Earth's radius and mu is 1, both of WGS-72, as the sets are made.
"""

import math
from typing import Final

from firmware_bridge.motion.orbit import OrbitState, state

LINE: Final = 69
"""Characters of either line."""
MISSING: Final = (
    "a two-line element set is read by sgp4, which is not installed: pip install 'firmware-bridge[orbit]'"
)


def state_of_tle(first: str, second: str, minutes: float = 0.0) -> OrbitState:
    """Return place and speed in DU and DU/TU, so many minutes after the set's epoch.

    ValueError where the lines are no such set, where the body is not in orbit then, or sgp4 is not installed.
    """
    _check(first, "1")
    _check(second, "2")
    try:
        # An extra: no other orbit needs it.
        from sgp4.api import SGP4_ERRORS, Satrec  # noqa: PLC0415 - see above
    except ModuleNotFoundError:
        raise ValueError(MISSING) from None
    body = Satrec.twoline2rv(first, second)
    error, place_km, speed_km_s = body.sgp4_tsince(minutes)
    if error:
        raise ValueError(f"the orbit of the set cannot be computed then: {SGP4_ERRORS[error]}")
    unit_km = float(body.radiusearthkm)
    unit_s = math.sqrt(unit_km**3 / float(body.mu))
    x, y, z = (float(it) / unit_km for it in place_km)
    u, v, w = (float(it) * unit_s / unit_km for it in speed_km_s)
    return state((x, y, z), (u, v, w))


def _check(line: str, number: str) -> None:
    """Look at a line's length, its number, and its last digit, the sum of the others; a minus counts as 1."""
    summed = sum(int(it) if it.isdigit() else it == "-" for it in line[: LINE - 1]) % 10
    if len(line) != LINE or not line.startswith(f"{number} ") or line[-1] != str(summed):
        raise ValueError(
            f"line {number} of a two-line element set has {LINE} characters, begins with '{number} ' and "
            f"ends with the sum of its digits: {line!r}"
        )
