"""`--zero AXIS=VALUE`: where axes stand, as the user of a command reads it off the robot."""

import math
from collections.abc import Sequence

from firmware_bridge.cli.console import refusal
from firmware_bridge.intent import ConfirmZero


def zeros_of(texts: Sequence[str] | None) -> tuple[ConfirmZero, ...]:
    """Return what is said of each axis; what is no number, or said twice, ends the program."""
    said: dict[str, float] = {}
    for text in texts or ():
        axis, sign, value = text.partition("=")
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if not sign or not axis or math.isnan(number):
            raise refusal(f"--zero {text}: say AXIS=VALUE")
        if axis in said:
            raise refusal(f"--zero {text}: {axis} is said twice")
        said[axis] = number
    return tuple(ConfirmZero(axis, number) for axis, number in said.items())
