"""An axis's travel and top speed in the units of its drive, by arithmetic of the guard's own.

It shares no code with the bridge's conversion: a sign error there must not move the bounds, too.
"""

import math
from typing import Final, NamedTuple

from firmware_bridge.robot import Axis, CommandForm
from firmware_bridge.safety.guard.wire_rules import ROUNDING

_SECONDS_PER_MINUTE: Final = 60.0


class Units(NamedTuple):
    """What a drive counts in."""

    counts: int
    """In one turn of the motor's shaft."""
    speed_per_rpm: float = 1.0
    """Units of speed, or acceleration, for 1 rpm, or 1 rpm/s."""
    speed_name: str = "rpm"
    count_name: str = "qc"

    def speed(self, rpm: int) -> int:
        """Return whole units that are not above rpm, or rpm/s; 1 in any case."""
        return max(1, math.floor(rpm * self.speed_per_rpm))

    def name(self, command: CommandForm) -> str:
        """Return the unit of a target."""
        return self.speed_name if command is CommandForm.SPEED else self.count_name


def speed_per_unit(axis: Axis, units: Units) -> float:
    """Return the motor's speed at one unit a second behind the gear, negative for a mirrored axis."""
    return axis.direction * axis.ratio * units.speed_per_rpm * _SECONDS_PER_MINUTE / math.tau


def highest_speed(axis: Axis, units: Units) -> int:
    """Return the largest whole number of units of speed that is not beyond the axis's top speed."""
    return math.floor(axis.top_speed * abs(speed_per_unit(axis, units)) * (1.0 + ROUNDING))


def counts_per_unit(axis: Axis, units: Units) -> float:
    """Return the motor's counts for one unit behind the gear, negative for a mirrored axis."""
    return axis.direction * axis.ratio * units.counts / math.tau


def ends(axis: Axis, units: Units) -> tuple[int, int]:
    """Return the lowest and the highest position in counts, each nearest to an end of the axis's travel.

    The drive counts from where the axis's position is 0. An axis without travel may go nowhere.
    """
    per_unit = counts_per_unit(axis, units)
    # Sorted, as a mirrored axis has its ends the other way round in counts.
    low, high = sorted(round(end * per_unit) for end in axis.travel or (0, 0))
    return low, high


def targets(axis: Axis, units: Units) -> range:
    """Return all targets that the axis may be sent: speeds, or counts where it is commanded by position."""
    if axis.command is CommandForm.POSITION:
        low, high = ends(axis, units)
    else:
        high = highest_speed(axis, units)
        low = -high
    return range(low, high + 1)
