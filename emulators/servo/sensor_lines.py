"""Wiring of a plant's outputs to a drive's second encoder and analog inputs: optional, as its pins.

The names: `master_AXIS` is the count of the digital position input (a second encoder's quadcounts, or steps),
`analogue_1_AXIS` and `analogue_2_AXIS` are volts. All are sampled every ms.
"""

from collections.abc import Sequence
from types import MappingProxyType
from typing import Final

from emulators.servo.pins import PinWire

MASTER: Final = 1 << 16
"""Mark in the place of a pin's mask: the line carries a count."""
ANALOGUE_1: Final = 1 << 17
"""Mark in the place of a pin's mask: the line carries volts for input 1."""
ANALOGUE_2: Final = 1 << 18
SENSORS: Final = MappingProxyType({"master": MASTER, "analogue_1": ANALOGUE_1, "analogue_2": ANALOGUE_2})


def sensor_outputs(axes: Sequence[str]) -> tuple[str, ...]:
    """Return the plant's outputs that are read as sensors where it has them."""
    return tuple(f"{sensor}_{axis}" for axis in axes for sensor in SENSORS)


def sensor_lines(outputs: Sequence[str], axes: Sequence[str]) -> tuple[PinWire, ...]:
    """Return the wires from a plant with these outputs to the sensors' inputs of the axes."""
    return tuple(
        # One table with the pins: the kernel in C distinguishes sensors by marks above the pins' bits.
        PinWire(number, mask, outputs.index(f"{sensor}_{axis}"))
        for number, axis in enumerate(axes)
        for sensor, mask in SENSORS.items()
        if f"{sensor}_{axis}" in outputs
    )
