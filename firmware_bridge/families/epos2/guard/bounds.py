"""An axis's travel and top speed in the units of its EPOS2, by arithmetic of the guard's own.

It shares no code with the bridge's conversion: a sign error there must not move the bounds, too.
"""

import math
from typing import Final

from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.robot import Axis, CommandForm
from firmware_bridge.safety.guard.wire_rules import ROUNDING

_EDGES_PER_LINE: Final = 4
"""Of an encoder with two channels."""
_SECONDS_PER_MINUTE: Final = 60.0


def rpm_per_unit(axis: Axis) -> float:
    """Return the motor's speed in rpm at one unit a second behind the gear, negative for a mirrored axis."""
    return axis.direction * axis.ratio * _SECONDS_PER_MINUTE / math.tau


def highest_rpm(axis: Axis) -> int:
    """Return the largest whole number of rpm that is not beyond the axis's top speed."""
    return math.floor(axis.top_speed * abs(rpm_per_unit(axis)) * (1.0 + ROUNDING))


def qc_per_unit(axis: Axis) -> float:
    """Return the motor's quadcounts for one unit behind the gear, negative for a mirrored axis."""
    return axis.direction * axis.ratio * _EDGES_PER_LINE * Epos2Axis.of(axis).encoder_lines / math.tau


def ends_qc(axis: Axis) -> tuple[int, int]:
    """Return the lowest and the highest position in quadcounts, each nearest to an end of the axis's travel.

    The drive counts from where the axis's position is 0. An axis without travel may go nowhere.
    """
    per_unit = qc_per_unit(axis)
    # Sorted, as a mirrored axis has its ends the other way round in quadcounts.
    low, high = sorted(round(end * per_unit) for end in axis.travel or (0, 0))
    return low, high


def targets(axis: Axis) -> range:
    """Return all targets that the axis may be sent: rpm, or quadcounts where it is commanded by position."""
    if axis.command is CommandForm.POSITION:
        low, high = ends_qc(axis)
    else:
        high = highest_rpm(axis)
        low = -high
    return range(low, high + 1)
