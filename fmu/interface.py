"""The interface of every plant to the drives: names and units, for an FMU from any tool."""

from collections.abc import Iterable, Mapping
from typing import Final

AXIS_INPUTS: Final[Mapping[str, str]] = {"voltage": "V"}
"""Quantity and unit of the inputs `QUANTITY_AXIS`; a positive voltage drives forwards."""

AXIS_OUTPUTS: Final[Mapping[str, str]] = {"current": "A", "angle": "rad", "speed": "rad/s"}
"""The same of the outputs: the motor's current and the motor's own shaft."""

PLANAR: Final[Mapping[str, str]] = {
    "x": "m",
    "y": "m",
    "heading": "rad",
    "speed": "m/s",
    "yaw_rate": "rad/s",
    "battery_voltage": "V",
}
"""Outputs of a robot on a floor beside its axes; a positive heading is counter-clockwise from x."""

HELD: Final[Mapping[str, str]] = {"held": "N.m"}
"""An input that a plant may have: something rubs at an axis's output, and may hold it; never negative."""


def inputs(axes: Iterable[str]) -> dict[str, str]:
    """Return the inputs that the drives of these axes set, with their units."""
    return {f"{quantity}_{axis}": unit for axis in axes for quantity, unit in AXIS_INPUTS.items()}


def outputs(axes: Iterable[str]) -> dict[str, str]:
    """Return the outputs that the drives of these axes measure, with their units."""
    return {f"{quantity}_{axis}": unit for axis in axes for quantity, unit in AXIS_OUTPUTS.items()}


def units(axes: Iterable[str]) -> dict[str, str]:
    """Return the units of all that a master may ask of a robot with these axes."""
    names = tuple(axes)
    may_have = {f"{quantity}_{axis}": unit for axis in names for quantity, unit in HELD.items()}
    return {**PLANAR, **inputs(names), **outputs(names), **may_have}
