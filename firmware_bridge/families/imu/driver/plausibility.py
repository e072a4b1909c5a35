"""Plausibility of an IMU's frames: a sensor that lies is silent, with a reason.

Limits are assumed. A real sensor has noise in all six values, so that they repeat to the bit only where it is
stuck; the length of the specific force is 1 g at rest, and a robot that brakes, climbs or falls over on its
wheels does not get beyond half and double of it for long.
"""

from typing import Final

from firmware_bridge.families.imu.wire import COUNTS_PER_G, ImuFrame, Status

STUCK: Final = 10
"""Frames with the same six values, 100 ms, from which on the sensor is stuck."""
SHORTEST_G: Final = 0.5
LONGEST_G: Final = 2.0
BEYOND_MS: Final = 200
"""So long the length may be outside of these."""
_SHORTEST: Final = (SHORTEST_G * COUNTS_PER_G) ** 2
_LONGEST: Final = (LONGEST_G * COUNTS_PER_G) ** 2


class Plausibility:
    """Judge of one sensor's frames, one after the other."""

    def __init__(self) -> None:
        self._before: tuple[int, ...] = ()
        self._same = 0
        """Number of frames with the newest six values."""
        self._beyond_ms = 0
        """For how long the length has been outside its limits."""

    def problem(self, frame: ImuFrame, elapsed_ms: int) -> str:
        """Return why a frame does not count, `elapsed_ms` after the one before; empty where it does."""
        values = (*frame.force, *frame.rate)
        self._same = self._same + 1 if values == self._before else 1
        self._before = values
        x, y, z = frame.force
        squared = x * x + y * y + z * z
        inside = _SHORTEST <= squared <= _LONGEST
        self._beyond_ms = 0 if inside else self._beyond_ms + elapsed_ms
        if frame.status & Status.FAILED:
            return "its self-test has failed"
        if self._same >= STUCK:
            return f"all six values are the same in {STUCK} frames: the sensor is stuck"
        if self._beyond_ms > BEYOND_MS:
            g = float(squared) ** 0.5 / COUNTS_PER_G
            return f"{g:.2f} g for {BEYOND_MS} ms, between {SHORTEST_G:g} and {LONGEST_G:g} g is possible"
        if frame.status & Status.RATE_CLIPPED:
            return "a rate was beyond its range"
        return ""
