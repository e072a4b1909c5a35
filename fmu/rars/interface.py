"""The interface of every plant of RARS: required names and units, for an FMU from any tool."""

from typing import Final

AXES: Final = ("left", "right", "steer", "lift")

INPUTS: Final[dict[str, str]] = {f"voltage_{axis}": "V" for axis in AXES}
"""Motor voltages; positive drives forwards, to the left, up."""

OUTPUTS: Final[dict[str, str]] = {
    **{f"current_{axis}": "A" for axis in AXES},
    **{f"angle_{axis}": "rad" for axis in AXES},
    **{f"speed_{axis}": "rad/s" for axis in AXES},
    "x": "m",
    "y": "m",
    "heading": "rad",
    "speed": "m/s",
    "yaw_rate": "rad/s",
    "rack": "m",
    "steer_left": "rad",
    "steer_right": "rad",
    "steer": "rad",
    "lift_height": "m",
    "battery_voltage": "V",
}
"""Motor shafts first, then the platform; the meaning of each is in fmu/rars/README.md."""

UNITS: Final[dict[str, str]] = INPUTS | OUTPUTS
