"""SI units behind the gear to a drive's quadcounts and rpm, and back; nothing above the drivers knows those.

Positive is as the robot file's `direction` makes it. Assumed: a drive counts from where it was switched on,
and the axis stood at its zero then.
"""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple, Self

from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.robot import Axis
from firmware_bridge.units import RPM_PER_RAD_S

COUNTER_SPAN: Final = 1 << 32
COUNTER_HALF: Final = 1 << 31


def wrapped(quadcounts: int) -> int:
    """Return a position as the drive's counter of 32 bits shows it."""
    # Two's complement of 32 bits, without a limit on what comes in.
    return (quadcounts + COUNTER_HALF) % COUNTER_SPAN - COUNTER_HALF


class Travel(NamedTuple):
    """Travel of an axis, in quadcounts, both ends included."""

    low_qc: int
    high_qc: int

    def clip(self, position_qc: int) -> int:
        """Return the nearest position within."""
        return min(max(position_qc, self.low_qc), self.high_qc)


WHOLE_COUNTER: Final = Travel(-COUNTER_HALF, COUNTER_HALF - 1)
"""Of an axis that may turn on and on."""


@dataclass(frozen=True, slots=True)
class Scale:
    """One axis's factors; their sign is its direction."""

    quadcounts_per_unit: float
    rpm_per_unit_s: float

    @classmethod
    def of(cls, axis: Axis) -> Self:
        """Return the factors of an axis."""
        turn = Epos2Axis.of(axis).quadcounts_per_turn
        return cls(
            axis.direction * turn * axis.ratio / (2.0 * math.pi), axis.direction * axis.ratio * RPM_PER_RAD_S
        )

    def position(self, quadcounts: int) -> float:
        """Return a position in the axis's unit."""
        return quadcounts / self.quadcounts_per_unit

    def quadcounts(self, position: float) -> int:
        """Return the nearest quadcount to a finite position."""
        return round(position * self.quadcounts_per_unit)

    def within(self, position: float, travel: Travel) -> int:
        """Return the quadcount within a travel that is nearest to a finite position, however far that is."""
        # Clipped as a float first: a huge number has no place in the drive's counter.
        return round(min(max(position * self.quadcounts_per_unit, travel.low_qc), travel.high_qc))

    def rpm(self, speed: float) -> float:
        """Return the motor's speed, not rounded."""
        return speed * self.rpm_per_unit_s


def travel_of(axis: Axis) -> Travel | None:
    """Return an axis's mechanical range, nearest quadcounts; None where it has none."""
    if axis.travel is None:
        return None
    scale = Scale.of(axis)
    one, other = (scale.quadcounts(end) for end in axis.travel)
    return Travel(min(one, other), max(one, other))


def highest_rpm(axis: Axis) -> int:
    """Return the whole rpm that neither the axis's top speed nor the drive's own limit exceeds."""
    # Rounded down, so that the whole rpm stay within the axis' top speed.
    return min(
        math.floor(abs(Scale.of(axis).rpm(axis.top_speed))), Epos2Axis.of(axis).profile.max_velocity_rpm
    )
