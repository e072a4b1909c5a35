"""Interface of whole numbers and the plant's floating point: sampled values, and invalid measurements.

It is independent of regulators. Reference implementation and kernel keep to the bounds here, so that no
product leaves 64 bits.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NoReturn, Protocol

from emulators.servo.axis import TICK
from emulators.servo.pins import PinWire
from firmware_bridge.units import to_seconds

WIDEST_READING: Final = 1 << 30
"""mA, mrad/s and mV beyond this are no measurement: a thousand times more than any drive stands."""
WIDEST_ANGLE: Final = 1 << 52
"""Quadcounts beyond this are no measurement: a double does not count them one by one."""
CLOSED: Final = 500
"""Thousandths of a plant's signal above which a switch is closed: halfway between its 0.0 and 1.0."""
WIDEST_STEP: Final = 1 << 31
"""Quadcounts in one ms beyond this are no measurement: the counter's 32 bits would not notice."""


class Doubles(Protocol):
    """An array of floating-point numbers, as ctypes and array make them."""

    def __getitem__(self, index: slice, /) -> Sequence[float]: ...
    def __setitem__(self, index: int, value: float, /) -> None: ...


class ServoPlant(Protocol):
    """Plant that turns voltages into motion, one tick at a time."""

    @property
    def inputs(self) -> Doubles:
        """Voltages for the next step, V."""

    @property
    def outputs(self) -> Doubles:
        """Outputs after the last step, SI."""

    def step(self) -> None:
        """Advance one tick."""


@dataclass(frozen=True, slots=True)
class Wiring:
    """Wiring of axes and plant, beside the order of the variables."""

    counts_per_radian: tuple[float, ...]
    """The mounted encoder of each axis."""
    supply: int | None
    """Index of the plant's output that is the supply voltage in V; None: it is constant."""
    dividers: tuple[float, ...]
    """Dividers before the first analog input of each axis that sees the supply; 0 where none does."""
    input_lines: tuple[PinWire, ...] = ()
    """Lines from the plant's outputs to the drives' input pins."""
    output_lines: tuple[PinWire, ...] = ()
    """Lines from the drives' output pins to the plant's inputs."""


class ServoError(Exception):
    """The plant gave an invalid measurement, or the requested kernel is missing."""


def plant_inputs(axes: Sequence[str]) -> tuple[str, ...]:
    """Return the plant's inputs in the order that a bank writes them."""
    return tuple(f"voltage_{axis}" for axis in axes)


def plant_outputs(axes: Sequence[str]) -> tuple[str, ...]:
    """Return the plant's outputs in the order that a bank reads them; others may follow."""
    return tuple(f"{quantity}_{axis}" for quantity in ("current", "angle", "speed") for axis in axes)


def no_measurement(quantity: str, axis: str, value: float, tick: int) -> NoReturn:
    """Refuse what the plant gave in place of a measurement; `value` in SI, or quadcounts for an angle."""
    problem = "out of range" if math.isfinite(value) else "not finite"
    where = f" of '{axis}'" if axis else ""
    instant = to_seconds(tick * TICK)
    raise ServoError(
        f"the plant's {quantity}{where} is {problem} at {instant:.4f} s ({value:g}): check the plant"
    )
