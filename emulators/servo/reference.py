"""The servo's reference implementation: what the kernel in C does between two events, in Python.

Both run in the tests and agree bit for bit; without a kernel the reference serves. Not known here: the bus.
"""

from collections.abc import Sequence
from math import floor
from typing import Final

from emulators.servo import winding
from emulators.servo.axis import AVERAGE_PLACES, TICK, TICKS_PER_MILLISECOND, ServoAxis
from emulators.servo.loops import AVERAGE, millisecond
from emulators.servo.recorder import record
from emulators.servo.seam import (
    CLOSED,
    WIDEST_ANGLE,
    WIDEST_READING,
    WIDEST_STEP,
    ServoPlant,
    Wiring,
    no_measurement,
)
from emulators.servo.sensor_lines import ANALOGUE_1, MASTER
from emulators.servo.winding import CURRENT_PLACES, Winding


class ReferenceServo:
    """Axes and plant, tick by tick. One tick: sample, regulate, write the voltages, step the plant."""

    def __init__(self, plant: ServoPlant, axes: Sequence[ServoAxis], wiring: Wiring) -> None:
        self.tick = 0
        """Number of ticks that have been run."""
        self._plant: Final = plant
        self._axes: Final = tuple(axes)
        self._wiring: Final = wiring
        self._windings: Final = tuple(Winding(at, axis) for at, axis in enumerate(axes))

    def run(self, last: int) -> bool:
        """Run ticks up to number `last`, or to the end of the first one with an event; say which."""
        event = False
        while self.tick < last and not event:
            phase = self.tick % TICKS_PER_MILLISECOND
            if phase == 0:
                event = self._millisecond()
            # An event ends the run with this tick: the drive acts before the next one.
            ticks = 1 if event else min(last - self.tick, TICKS_PER_MILLISECOND - phase)
            self._current_loops(ticks)
        for axis in self._axes:
            axis.now = self.tick * TICK
        return event

    def _millisecond(self) -> bool:
        """Sample the plant and run every axis' millisecond; say whether one of them raised an event."""
        self._sample_supply()
        self._sample_pins()
        count = len(self._axes)
        event = False
        currents = self._plant.outputs[:count]
        angles = self._plant.outputs[count : 2 * count]
        for k, axis in enumerate(self._axes):
            axis.current_ma = self._reading("current", axis, currents[k])
            raised = millisecond(axis, self._count(k, axis, angles[k]))
            axis.event = raised
            event = event or raised
            if not axis.powered:
                axis.turning = winding.turns(axis, self._speed(k))
        return event

    def _current_loops(self, ticks: int) -> None:
        """Run the ticks up to the next ms: current loops, open windings, plant."""
        outputs, step, count = self._plant.outputs, self._plant.step, len(self._axes)
        powered = [loop for loop in self._windings if loop.axis.powered]
        opened = [loop for loop in self._windings if not loop.axis.powered and loop.axis.turning]
        recorded = [loop for loop in self._windings if loop.axis.recording]
        for loop in powered:
            loop.load()
        try:
            for _ in range(ticks):
                currents = outputs[:count]
                self._regulate(powered, currents)
                if opened:
                    self._keep_up(opened, currents)
                for loop in recorded:
                    self._record(loop)
                step()
                self.tick += 1
        finally:
            for loop in powered:
                loop.store()

    def _regulate(self, powered: Sequence[Winding], currents: Sequence[float]) -> None:
        """Run one tick of the current loops.

        PI: 1/256 Ohm of gain on mA gives mV in 8 binary places (maxon's command library). The integrator
        holds while the voltage is limited, unless it leads back (assumed).
        """
        inputs = self._plant.inputs
        for loop in powered:
            at = loop.at
            milliamperes = currents[at] * 1000.0
            if not -WIDEST_READING <= milliamperes <= WIDEST_READING:
                no_measurement("current", loop.axis.name, currents[at], self.tick)
            current = int(milliamperes)
            loop.current = current
            average = loop.average
            loop.average = average + (((current << AVERAGE_PLACES) - average) >> AVERAGE)
            error = loop.demand - current
            integral = loop.integral + loop.i * error
            voltage = (loop.p * error + integral) >> CURRENT_PLACES
            limit = loop.limit
            if -limit <= voltage <= limit:
                loop.integral = integral
            else:
                voltage = limit if voltage > 0 else -limit
                if (integral > loop.integral) != (voltage > 0):
                    loop.integral = integral
            loop.voltage = voltage
            # Multiplied as in C: a division by 1000 may differ in the last bit.
            inputs[at] = voltage * 0.001

    def _keep_up(self, opened: Sequence[Winding], currents: Sequence[float]) -> None:
        """Give the open windings that turn their own voltage."""
        for loop in opened:
            current = self._reading("current", loop.axis, currents[loop.at])
            voltage = winding.opened(loop.axis, current, self._speed(loop.at))
            self._plant.inputs[loop.at] = voltage * 0.001

    def _record(self, loop: Winding) -> None:
        """Record a tick of an axis, if its recording has not ended meanwhile."""
        if loop.axis.recording:
            if loop.axis.powered:
                loop.store()
            record(loop.axis, loop.axis.recorder)

    def _sample_supply(self) -> None:
        supply = self._wiring.supply
        if supply is None:
            return
        volts = self._plant.outputs[supply : supply + 1][0]
        supply_mv = self._reading("supply voltage", None, volts)
        for axis, divider in zip(self._axes, self._wiring.dividers, strict=True):
            axis.source_mv = supply_mv
            axis.supply_mv = axis.forced_supply_mv or supply_mv
            if divider:
                axis.analogue_1_mv = int(axis.supply_mv / divider)

    def _sample_pins(self) -> None:
        """Read the input pins, and write the output pins, that are wired to the plant."""
        axes, outputs, inputs = self._axes, self._plant.outputs, self._plant.inputs
        for line in self._wiring.input_lines:
            axis, value = axes[line.axis], outputs[line.variable : line.variable + 1][0]
            if line.mask >= MASTER:
                self._sample_sensor(axis, line.mask, value)
                continue
            signal = self._reading("pin", axis, value)
            axis.pins = axis.pins | line.mask if signal > CLOSED else axis.pins & ~line.mask
        for line in self._wiring.output_lines:
            inputs[line.variable] = 1.0 if axes[line.axis].outputs & line.mask else 0.0

    def _sample_sensor(self, axis: ServoAxis, mask: int, value: float) -> None:
        if mask == MASTER:
            if not -WIDEST_ANGLE <= value <= WIDEST_ANGLE:
                no_measurement("sensor", axis.name, value, self.tick)
            axis.master = floor(value)
        elif mask == ANALOGUE_1:
            axis.analogue_1_mv = self._reading("sensor", axis, value)
        else:
            axis.analogue_2_mv = self._reading("sensor", axis, value)

    def _count(self, k: int, axis: ServoAxis, angle: float) -> int:
        counts = angle * self._wiring.counts_per_radian[k]
        if not -WIDEST_ANGLE <= counts <= WIDEST_ANGLE:
            no_measurement("angle", axis.name, angle, self.tick)
        count = floor(counts)
        if not -WIDEST_STEP <= count - axis.encoder <= WIDEST_STEP:
            no_measurement("angle", axis.name, angle, self.tick)
        return count

    def _speed(self, k: int) -> int:
        """Return the plant's speed of a shaft in mrad/s."""
        at = 2 * len(self._axes) + k
        return self._reading("speed", self._axes[k], self._plant.outputs[at : at + 1][0])

    def _reading(self, quantity: str, axis: ServoAxis | None, value: float) -> int:
        """Return thousandths of what the plant gives, towards zero."""
        thousandths = value * 1000.0
        if not -WIDEST_READING <= thousandths <= WIDEST_READING:
            no_measurement(quantity, axis.name if axis is not None else "", value, self.tick)
        # int() rounds towards zero, as the cast in C does.
        return int(thousandths)
