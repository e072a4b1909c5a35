"""The axes of one robot and the plant that they turn, advanced together from one event to the next.

The bus is not known here, nor what happens on a tick: that is the kernel's in C, or its reference
implementation's in Python.
"""

from collections.abc import Sequence
from math import floor, tau
from typing import Final, Protocol

from emulators.servo.axis import TICK, ServoAxis
from emulators.servo.kernel import Kernel, KernelLibrary, NativePlant, choose
from emulators.servo.pins import PinWire
from emulators.servo.reference import ReferenceServo
from emulators.servo.seam import (
    WIDEST_ANGLE,
    ServoError,
    ServoPlant,
    Wiring,
    no_measurement,
    plant_inputs,
    plant_outputs,
)
from firmware_bridge.units import Nanoseconds

__all__ = ["ServoBank", "ServoError", "ServoPlant", "plant_inputs", "plant_outputs"]


class Engine(Protocol):
    """Engine that runs the ticks."""

    @property
    def tick(self) -> int:
        """Number of ticks that have been run."""

    def run(self, last: int) -> bool:
        """Run ticks up to number `last`, or to the end of the first one with an event; say which."""


class ServoBank:
    """Axes and plant, advanced together."""

    def __init__(
        self,
        plant: ServoPlant,
        axes: Sequence[ServoAxis],
        *,
        supply: int | None = None,
        analogue: tuple[str, float] | None = None,
        input_lines: Sequence[PinWire] = (),
        output_lines: Sequence[PinWire] = (),
        servo: KernelLibrary | None = None,
    ) -> None:
        """Take a plant whose inputs and outputs begin as in `plant_inputs` and `plant_outputs`.

        `supply` is the output that holds the supply voltage in V (constant where it is None); `analogue` is
        the axis whose first analog input sees it, and the divider before that input. The lines wire pins to
        further outputs and inputs of the plant: see `emulators.servo.pins`. `servo` is the kernel to use, or
        none; without it `emulators.servo.kernel.choose` decides. Raises ServoError where a requested kernel
        is missing, or where the plant gives no angle.
        """
        self.axes: Final = tuple(axes)
        self.plant: Final = plant
        count = len(self.axes)
        scales = [axis.encoder_resolution / tau for axis in axes]
        dividers = [
            analogue[1] if analogue is not None and analogue[0] == axis.name else 0.0 for axis in axes
        ]
        for axis, angle, scale in zip(axes, plant.outputs[count : 2 * count], scales, strict=True):
            if not -WIDEST_ANGLE <= angle * scale <= WIDEST_ANGLE:
                no_measurement("angle", axis.name, angle, 0)
            # Not int(): rounding towards zero would make the count around 0 twice as wide.
            axis.encoder = floor(angle * scale)
        wiring = Wiring(tuple(scales), supply, tuple(dividers), tuple(input_lines), tuple(output_lines))
        found = choose() if servo is None else servo
        self._engine: Final[Engine] = (
            Kernel(found.library, plant, axes, wiring)
            if found.library is not None and isinstance(plant, NativePlant)
            else ReferenceServo(plant, axes, wiring)
        )
        self._next: Nanoseconds = (self._engine.tick + 1) * TICK
        """The end of the tick that has not been run."""
        self.why_not_native: Final = (
            found.reason if found.library is None else "the plant has no FMI functions"
        )
        """Reason why the reference implementation serves, where it does."""

    @property
    def native(self) -> bool:
        """True if the kernel in C runs the ticks."""
        return isinstance(self._engine, Kernel)

    @property
    def now(self) -> Nanoseconds:
        """The end of the last tick."""
        return self._engine.tick * TICK

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Run whole ticks that end at `until` or before; return how far it is, and the nodes to wake.

        Without an event that is `until` itself; with one it is the end of the tick that raised it. Raises
        ServoError for an output that is no measurement, and what the plant raises where it fails.
        """
        if until < self._next:
            return until, ()
        last = until // TICK
        if not self._engine.run(last):
            self._next = (last + 1) * TICK
            return until, ()
        now = self.now
        self._next = now + TICK
        return now, tuple([axis.node for axis in self.axes if axis.event])
