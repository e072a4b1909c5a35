"""A winding between two milliseconds: what the current loop works on, and the voltage of an open winding.

The plant knows voltages only, so an open winding gets the one that the flyback diodes would leave there, tick
by tick. Over an off period its terminals give the winding no energy: it takes energy from the shaft, or none.
Whole numbers only, as in `emulators.servo.loops`. Divisions round towards minus infinity.
"""

from math import expm1
from typing import Final

from emulators.servo.axis import AVERAGE_PLACES, JUST_OPENED, LEAST_LEARNING, TICK, ServoAxis
from emulators.servo.loops import AVERAGE
from firmware_bridge.units import to_seconds

DIODES_MV: Final = 1_600
"""Voltage drop of two flyback diodes in a row (assumed: 0.8 V each, body diodes of the power stage).

Assumed: the source of the supply takes what comes through them at the voltage that it has. Where less is left
at the drive, by a long cable or a bad contact, the back-EMF lifts it, and only the source's voltage brakes.
"""
RESTING: Final = 10
"""mrad/s up to which a winding without voltage and current is left alone."""
LEARNING: Final = 5_000
"""Speed in mrad/s above which an unknown back-EMF constant is learnt."""
SLOWING: Final = 16
"""Limit of the shaft's relative loss of speed in a tick, above which nothing is learnt.

In a faster braking the current comes from the earlier speed, and requires too much.
"""
MOST_LEARNING: Final = 1 << 28
"""16 Ohm: an upper bound of them (assumed)."""
SETTLING_MS: Final = 1
"""Time for which the current is left to itself after the voltage has been raised for the constant ..."""
RECOVERING_MS: Final = 3
"""... and after it has been taken back, with a short for a tick: some times what windings take (L/R)."""
MOST_LEFT_MA: Final = 1 << 10
"""Largest rest of a current that brakes when a constant has been learnt."""
BACK_EMF_PLACES: Final = 24
WIDEST_BACK_EMF: Final = (1 << 32) - 1
"""256 V s/rad: far past every motor, and a product with a speed stays within 63 bits."""
RESISTANCE_PLACES: Final = 16
WIDEST_RESISTANCE: Final = (1 << 31) - 1
"""32 kOhm in those places, likewise."""
DOUBTED_MA: Final = 64
"""Overshoot of a current past 0, beside a quarter of itself, from which the winding's data are doubted."""
FADED: Final = 1 << 5
"""An averaged current (2^-16 mA) that rounding keeps from reaching 0."""
CURRENT_PLACES: Final = 8
_LONGEST_EXPONENT: Final = 100.0


class Winding:
    """The current regulator's part of an axis, taken out of the shared record while its ticks run.

    Plain slots, for they are touched ten times as often as all others.
    """

    __slots__ = ("at", "average", "axis", "current", "demand", "i", "integral", "limit", "p", "voltage")

    def __init__(self, at: int, axis: ServoAxis) -> None:
        self.at: Final = at
        self.axis: Final = axis

    def load(self) -> None:
        """Take the values from the axis."""
        axis = self.axis
        self.current = axis.current_ma
        self.average = axis.current_average
        self.demand = axis.current_demand_ma
        self.p = axis.current_p
        self.i = axis.current_i
        self.integral = axis.current_integral
        self.limit = axis.supply_mv * axis.voltage_percent // 100
        self.voltage = axis.voltage_mv

    def store(self) -> None:
        """Give the axis what the ticks have changed."""
        axis = self.axis
        axis.current_ma = self.current
        axis.current_average = self.average
        axis.current_integral = self.integral
        axis.voltage_mv = self.voltage


def set_winding(axis: ServoAxis, constant: float, resistance: float = 0.0, inductance: float = 0.0) -> None:
    """Set an axis's motor constant (V s/rad), and resistance (Ohm) and inductance (H) where known.

    Over a tick of constant voltage u the current goes from i to a i + (1 - a) (u - emf) / R with
    a = exp(-R tick / L): it ends at 0 for u = emf - `decay_resistance` i, and at -i for
    u = emf - `balance_resistance` i.
    """
    axis.back_emf = min(max(0, round(constant * (1 << BACK_EMF_PLACES))), WIDEST_BACK_EMF)
    axis.learning = 0 if axis.back_emf else LEAST_LEARNING
    axis.decay_resistance = axis.balance_resistance = 0
    if resistance > 0.0 and inductance > 0.0:
        exponent = min(resistance * to_seconds(TICK) / inductance, _LONGEST_EXPONENT)
        # x / (exp(x) - 1) is 0/0 for x = 0: its limit is 1, where the inductance alone counts.
        decay = inductance / to_seconds(TICK) * (exponent / expm1(exponent) if exponent > 0.0 else 1.0)
        axis.decay_resistance = min(round(decay * (1 << RESISTANCE_PLACES)), WIDEST_RESISTANCE)
        axis.balance_resistance = min(
            max(1, round((resistance + 2.0 * decay) * (1 << RESISTANCE_PLACES))), WIDEST_RESISTANCE
        )


def turns(axis: ServoAxis, speed: int) -> int:
    """Learn an unknown constant; return the value of `turning` in this ms: 0, 1, or still JUST_OPENED.

    The estimate begins at 0, a winding that is shorted, and rises by the voltage of the current that still
    brakes at a resistance below the winding's own: from below, so that it never drives. The resistance is
    doubled where the current has become less since, but not by half. Each time that it drove after all, twice
    as much of the current that brakes is left as it is, or voltages of whole mV would be tried for ever.
    """
    if axis.turning == JUST_OPENED:
        return JUST_OPENED
    current = axis.current_ma
    if axis.waits:
        axis.waits -= 1
    elif axis.learning and (speed > LEARNING or speed < -LEARNING):
        braking = (-current if speed > 0 else current) - axis.left
        lost = (axis.speed_before - speed) if speed > 0 else (speed - axis.speed_before)
        if braking > 0 and SLOWING * lost <= (speed if speed > 0 else -speed):
            if braking <= axis.braking < 2 * braking:
                axis.learning = min(axis.learning << 1, MOST_LEARNING)
            axis.braking = braking
            axis.raised = braking * axis.learning // (speed if speed > 0 else -speed)
            axis.back_emf = min(axis.back_emf + axis.raised, WIDEST_BACK_EMF)
            axis.waits = SETTLING_MS
        return 1
    settled = axis.voltage_mv == 0 and current == 0 and -FADED <= axis.current_average <= FADED
    return 0 if settled and -RESTING <= speed <= RESTING else 1


def opened(axis: ServoAxis, current: int, speed: int) -> int:
    """Return the voltage in mV of an open winding for a tick, at this current in mA and speed in mrad/s."""
    if axis.turning == JUST_OPENED:
        axis.turning = 1
        axis.speed_before = speed
    else:
        doubt(axis, current, speed)
    limit = max(0, axis.supply_mv, axis.source_mv) + DIODES_MV
    voltage = min(max(-limit, unfed(axis, current, speed)), limit)
    axis.speed_before = speed
    axis.current_ma = current
    average = axis.current_average
    axis.current_average = average + (((current << AVERAGE_PLACES) - average) >> AVERAGE)
    axis.voltage_mv = voltage
    return voltage


def doubt(axis: ServoAxis, current: int, speed: int) -> None:
    """Correct data that the current of the last tick has shown to be false: it exceeds the command.

    A winding that begins to drive at the learnt voltage was given too much of it. One whose current was to
    end and shoots far past 0 has another resistance or inductance than the given ones: they count no more.
    """
    before = axis.current_ma
    if axis.learning:
        if axis.voltage_mv and (
            (current > 0 and before <= 0 < speed) or (current < 0 <= before and speed < 0)
        ):
            axis.back_emf = max(0, axis.back_emf - axis.raised)
            axis.raised = min(max(2 * axis.raised, axis.back_emf >> 10), WIDEST_BACK_EMF)
            axis.learning = max(axis.learning >> 2, LEAST_LEARNING)
            axis.braking, axis.waits = 0, RECOVERING_MS
            axis.left = min(axis.left << 1, MOST_LEFT_MA)
    elif axis.balance_resistance and axis.voltage_mv:
        past = -current if before > 0 else current
        size = before if before > 0 else -before
        opposed = (axis.voltage_mv > 0) != (before > 0)
        if before and opposed and past > (size >> 2) + DOUBTED_MA:
            axis.decay_resistance = axis.balance_resistance = 0


def unfed(axis: ServoAxis, current: int, speed: int) -> int:
    """Return the voltage, not yet bounded by the supply, that ends a current without feeding it.

    That is the back-EMF where no current flows. A current decays against the supply through the diodes: the
    voltage is opposed to it, and no more than ends it with the tick. Where the back-EMF is so high that the
    same voltage would feed the current, the mean of the current is made 0, and the next tick ends what is
    left. Where resistance and inductance are unknown, a current that drives is shorted, and one that brakes
    fades.
    """
    to_come = 2 * speed - axis.speed_before
    if speed < 0:
        # Valid for a shaft that turns forwards.
        return -unfed_forwards(axis, -current, -speed, -to_come)
    return unfed_forwards(axis, current, speed, to_come)


def unfed_forwards(axis: ServoAxis, current: int, speed: int, to_come: int) -> int:
    """Return the voltage for a speed that is not below 0, and will be `to_come` after the tick: see `unfed`.

    The smaller of the two counts: at the larger one a shaft that slows down would be driven.
    """
    back_emf = (axis.back_emf * max(0, min(speed, to_come))) >> BACK_EMF_PLACES
    if current == 0:
        return back_emf
    if axis.balance_resistance == 0:
        return back_emf if current < 0 else 0
    decay_voltage = back_emf - ((axis.decay_resistance * current) >> RESISTANCE_PLACES)
    if current < 0 or decay_voltage <= 0:
        return decay_voltage
    return max(0, back_emf - ((axis.balance_resistance * current) >> RESISTANCE_PLACES))
