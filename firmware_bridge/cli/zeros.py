"""`--zero AXIS=VALUE`, `--home AXIS`: where axes stand, as read off the robot, or which shall find out."""

import math
from collections.abc import Sequence

from firmware_bridge.cli.console import refusal
from firmware_bridge.intent import ConfirmPosition


def zeros_of(texts: Sequence[str] | None, homed: Sequence[str] | None = None) -> tuple[ConfirmPosition, ...]:
    """Return the confirmation of each axis; one that is no number, or given twice, ends the program.

    First those confirmed by sight, then those that are `homed`, in their order.
    """
    positions: dict[str, float] = {}
    for text in texts or ():
        axis, sign, value = text.partition("=")
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if not sign or not axis or math.isnan(number):
            raise refusal(f"--zero {text}: give AXIS=VALUE")
        if axis in positions:
            raise refusal(f"--zero {text}: {axis} is given twice")
        positions[axis] = number
    for axis in homed or ():
        if axis in positions:
            raise refusal(f"--home {axis}: {axis} is given twice")
        # NaN in the place of a position is a homing, as in MAV_CMD_USER_1.
        positions[axis] = math.nan
    return tuple(ConfirmPosition(axis, number) for axis, number in positions.items())
