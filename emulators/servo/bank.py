"""The axes of one robot and the plant that they turn: 10 kHz current loops from one event to the next.

The only place where whole numbers meet the plant's floating point: angle to quadcounts, current to mA,
mV to V. It refuses to know the bus: it runs until an instant, or until an axis has something to say.
"""

from collections.abc import Sequence
from math import floor, tau
from typing import Final, Protocol

from emulators.servo.axis import TICK, TICKS_PER_MILLISECOND, ServoAxis
from emulators.servo.loops import AVERAGE, millisecond
from firmware_bridge.units import Nanoseconds, to_seconds

_RESTING: Final = 10
"""mrad/s below which an open winding shows no voltage."""
_LEARNING: Final = 5_000
"""mrad/s above which the back-EMF constant of an open winding is learnt."""
_LEARNING_RATE: Final = 838_861
"""0.05 Ohm in 24 places: a lower bound of the windings' resistance, so that learning does not overshoot."""
_ROUNDING: Final = 1 << 23
_FADED: Final = 1 << 5
"""An averaged current (2^-16 mA) that rounding keeps from reaching 0."""


class Doubles(Protocol):
    """An array of floating-point numbers, as ctypes and array make them."""

    def __getitem__(self, index: slice, /) -> Sequence[float]: ...
    def __setitem__(self, index: int, value: float, /) -> None: ...


class Plant(Protocol):
    """What turns voltages into motion, one tick at a time."""

    @property
    def inputs(self) -> Doubles:
        """Voltages for the next step, V."""

    @property
    def outputs(self) -> Doubles:
        """What the last step led to, SI."""

    def step(self) -> None:
        """Advance one tick."""


class ServoError(Exception):
    """The plant gave something that is no measurement."""


def plant_inputs(axes: Sequence[str]) -> tuple[str, ...]:
    """Return the plant's inputs in the order that a bank writes them."""
    return tuple(f"voltage_{axis}" for axis in axes)


def plant_outputs(axes: Sequence[str]) -> tuple[str, ...]:
    """Return the plant's outputs in the order that a bank reads them; others may follow."""
    return tuple(f"{quantity}_{axis}" for quantity in ("current", "angle", "speed") for axis in axes)


class ServoBank:
    """Axes and plant, advanced together."""

    def __init__(
        self,
        plant: Plant,
        axes: Sequence[ServoAxis],
        *,
        supply: int | None = None,
        analogue: tuple[str, float] | None = None,
    ) -> None:
        """Take a plant whose inputs and outputs begin as `plant_inputs` and `plant_outputs` say.

        `supply` is the output that holds the supply voltage in V (constant where it is None); `analogue` is
        the axis whose first analogue input sees it, and the divider before that input.
        """
        self.axes: Final = tuple(axes)
        self._plant = plant
        self._supply = supply
        self._tick = 0
        self._counts_per_radian = tuple(axis.encoder_resolution / tau for axis in axes)
        self._divided = tuple(
            analogue[1] if analogue is not None and analogue[0] == axis.name else 0.0 for axis in axes
        )
        for axis, angle, scale in zip(axes, self._angles(), self._counts_per_radian, strict=True):
            axis.encoder = floor(angle * scale)

    @property
    def now(self) -> Nanoseconds:
        """The end of the last tick."""
        return self._tick * TICK

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Run whole ticks that end at `until` or before; return how far it is, and the nodes to wake.

        Without an event that is `until` itself; with one it is the end of the tick that raised it.
        """
        last = until // TICK
        if self._tick >= last:
            return until, ()
        try:
            woken = self._run(last)
        except (ValueError, OverflowError) as error:
            # A float that is not finite has no whole part.
            instant = to_seconds(self.now)
            raise ServoError(
                f"the plant's outputs are not finite at {instant:.4f} s: check the plant"
            ) from error
        for axis in self.axes:
            axis.now = self.now
        return (self.now, woken) if woken else (until, ())

    def _angles(self) -> Sequence[float]:
        count = len(self.axes)
        return self._plant.outputs[count : 2 * count]

    def _run(self, last: int) -> tuple[str, ...]:
        """Run ticks up to number `last`. One tick: sample, regulate, write the voltages, step the plant.

        Current PI: 1/256 Ohm of gain on mA gives mV in 8 binary places (maxon's command library). The
        integrator holds while the voltage is limited, unless it leads back (ASSUME).
        """
        tick = self._tick
        inputs = self._plant.inputs
        outputs = self._plant.outputs
        step = self._plant.step
        count = len(self.axes)
        powered = [(k, axis) for k, axis in enumerate(self.axes) if axis.powered]
        unpowered = [(k, axis) for k, axis in enumerate(self.axes) if not axis.powered]
        opened = unpowered
        woken: tuple[str, ...] = ()
        while tick < last:
            currents = outputs[:count]
            if tick % TICKS_PER_MILLISECOND == 0:
                woken = self._milliseconds(currents)
                opened = [pair for pair in unpowered if self._turns(*pair)]
            for k, axis in powered:
                current = int(currents[k] * 1000.0)
                axis.current_ma = current
                average = axis.current_average
                axis.current_average = average + (((current << 16) - average) >> AVERAGE)
                error = axis.current_demand_ma - current
                integral = axis.current_integral + axis.current_i * error
                voltage = (axis.current_p * error + integral) >> 8
                limit = axis.supply_mv * axis.voltage_percent // 100
                if -limit <= voltage <= limit:
                    axis.current_integral = integral
                else:
                    voltage = limit if voltage > 0 else -limit
                    if (integral > axis.current_integral) != (voltage > 0):
                        axis.current_integral = integral
                axis.voltage_mv = voltage
                inputs[k] = voltage * 0.001
            for k, axis in opened:
                self._open(k, axis, currents[k])
            step()
            tick += 1
            self._tick = tick
            if woken:
                break
        return woken

    def _milliseconds(self, currents: Sequence[float]) -> tuple[str, ...]:
        if self._supply is not None:
            self._sample_supply(int(self._plant.outputs[self._supply : self._supply + 1][0] * 1000.0))
        woken: tuple[str, ...] = ()
        for k, angle in enumerate(self._angles()):
            axis = self.axes[k]
            axis.current_ma = int(currents[k] * 1000.0)
            if millisecond(axis, floor(angle * self._counts_per_radian[k])):
                woken = (*woken, axis.node)
        return woken

    def _sample_supply(self, supply_mv: int) -> None:
        for axis, divider in zip(self.axes, self._divided, strict=True):
            axis.supply_mv = supply_mv
            if divider:
                axis.analogue_1_mv = int(supply_mv / divider)

    def _turns(self, k: int, axis: ServoAxis) -> bool:
        """Learn an open winding's back-EMF constant; say whether its voltage must be kept up in this ms.

        An open winding carries no current, but the plant knows voltages only: so the winding gets its own
        back-EMF, speed times a constant. The constant is known, or learnt from the current that still flows.
        Both divisions round towards minus infinity.
        """
        current = axis.current_ma
        speed = self._speed(k)
        if speed > _LEARNING or speed < -_LEARNING:
            if axis.back_emf == 0:
                axis.back_emf = max(0, (axis.voltage_mv << 24) // speed)
            if current > 1 or current < -1:
                axis.back_emf = max(0, axis.back_emf + -(current * _LEARNING_RATE) // speed)
            return True
        settled = axis.voltage_mv == 0 and current == 0 and -_FADED <= axis.current_average <= _FADED
        return not (settled and -_RESTING <= speed <= _RESTING)

    def _open(self, k: int, axis: ServoAxis, current: float) -> None:
        speed = self._speed(k)
        resting = -_RESTING <= speed <= _RESTING
        voltage = 0 if resting else (axis.back_emf * speed + _ROUNDING) >> 24
        if axis.back_emf == 0 and (speed > _LEARNING or speed < -_LEARNING):
            # Switched off in mid-motion, before anything is learnt: the last voltage is near to its own.
            voltage = axis.voltage_mv
        measured = int(current * 1000.0)
        axis.current_ma = measured
        average = axis.current_average
        axis.current_average = average + (((measured << 16) - average) >> AVERAGE)
        axis.voltage_mv = voltage
        self._plant.inputs[k] = voltage * 0.001

    def _speed(self, k: int) -> int:
        """Return the plant's speed of a shaft in mrad/s."""
        at = 2 * len(self.axes) + k
        return int(self._plant.outputs[at : at + 1][0] * 1000.0)
