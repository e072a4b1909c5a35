"""The interface of RARS that can tip over: that of fmu/rars, and what it stands on."""

from typing import Final

from fmu.rars import interface as base

AXES: Final = base.AXES
INPUTS: Final = base.INPUTS

STANDING: Final[dict[str, str]] = {
    "load_rear_left": "N",
    "load_rear_right": "N",
    "load_front_left": "N",
    "load_front_right": "N",
    "zmp_margin": "m",
    "roll": "rad",
    "pitch": "rad",
    "roll_rate": "rad/s",
    "pitch_rate": "rad/s",
    "centre_height": "m",
}
"""Outputs beside those of fmu/rars; their meaning is in README.md."""

TIPPED: Final = "tipped"
"""The output that is 1 from the tip-over on, until the plant is reset."""

OUTPUTS: Final[dict[str, str]] = {**base.OUTPUTS, **STANDING, TIPPED: "1"}
