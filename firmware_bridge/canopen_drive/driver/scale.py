"""SI units behind the gear to a drive's counts and units of speed, and back; nothing above knows those.

Positive is as the robot file's `direction` makes it. Assumed: a drive counts from where it was switched on,
and the axis stood at its zero then.
"""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple, Self

from firmware_bridge.canopen_drive.settings import DriveAxis
from firmware_bridge.robot import Axis
from firmware_bridge.units import RPM_PER_RAD_S

COUNTER_SPAN: Final = 1 << 32
COUNTER_HALF: Final = 1 << 31


def wrapped(counts: int) -> int:
    """Return a position as the drive's counter of 32 bits shows it."""
    # Two's complement of 32 bits, without a limit on what comes in.
    return (counts + COUNTER_HALF) % COUNTER_SPAN - COUNTER_HALF


class Travel(NamedTuple):
    """Travel of an axis, in counts, both ends included."""

    low: int
    high: int

    def clip(self, position: int) -> int:
        """Return the nearest position within."""
        return min(max(position, self.low), self.high)


WHOLE_COUNTER: Final = Travel(-COUNTER_HALF, COUNTER_HALF - 1)
"""Of an axis that may turn on and on."""


@dataclass(frozen=True, slots=True)
class Scale:
    """One axis's factors; their sign is its direction."""

    counts_per_unit: float
    speed_per_unit_s: float
    """Units of the drive's speeds for one unit a second behind the gear."""

    @classmethod
    def of(cls, axis: Axis) -> Self:
        """Return the factors of an axis."""
        turn = DriveAxis.of(axis).counts_per_turn
        speed = axis.direction * axis.ratio * RPM_PER_RAD_S
        return cls(
            axis.direction * turn * axis.ratio / (2.0 * math.pi), speed * DriveAxis.of(axis).speed_per_rpm
        )

    def position(self, counts: int) -> float:
        """Return a position in the axis's unit."""
        return counts / self.counts_per_unit

    def counts(self, position: float) -> int:
        """Return the nearest count to a finite position."""
        return round(position * self.counts_per_unit)

    def within(self, position: float, travel: Travel) -> int:
        """Return the count within a travel that is nearest to a finite position, however far that is."""
        # Clipped as a float first: a huge number has no place in the drive's counter.
        return round(min(max(position * self.counts_per_unit, travel.low), travel.high))

    def speed(self, speed: float) -> float:
        """Return the motor's speed in the drive's unit, not rounded."""
        return speed * self.speed_per_unit_s


def travel_of(axis: Axis) -> Travel | None:
    """Return an axis's mechanical range, nearest counts; None where it has none."""
    if axis.travel is None:
        return None
    scale = Scale.of(axis)
    one, other = (scale.counts(end) for end in axis.travel)
    return Travel(min(one, other), max(one, other))


def in_units(axis: Axis, rpm: int) -> int:
    """Return whole units of the drive's speed, or acceleration, that are not above rpm, or rpm/s; never 0."""
    # Rounded down, so that a bound stays within; at 0 an axis would never move, or never stop.
    return max(1, math.floor(rpm * DriveAxis.of(axis).speed_per_rpm))


def highest_speed(axis: Axis) -> int:
    """Return the whole units of speed that neither the axis's top speed nor the drive's own limit exceeds."""
    # Rounded down, so that the whole units stay within the axis's top speed.
    return min(
        math.floor(abs(Scale.of(axis).speed(axis.top_speed))),
        in_units(axis, DriveAxis.of(axis).profile.max_velocity_rpm),
    )
