"""A winding between two milliseconds: what the current loop works on, and the voltage of an open winding.

Whole numbers only, as in `emulators.servo.loops`. Both divisions round towards minus infinity.
"""

from typing import Final

from emulators.servo.axis import AVERAGE_PLACES, ServoAxis
from emulators.servo.loops import AVERAGE

RESTING: Final = 10
"""mrad/s below which an open winding shows no voltage."""
LEARNING: Final = 5_000
"""mrad/s above which the back-EMF constant of an open winding is learnt."""
LEARNING_RATE: Final = 838_861
"""0.05 Ohm in 24 places: a lower bound of the windings' resistance, so that learning does not overshoot."""
HIGHEST_RESISTANCE: Final = 16
"""Ohm: an upper bound, for what the current may have added to the last voltage (ASSUME)."""
BACK_EMF_PLACES: Final = 24
WIDEST_BACK_EMF: Final = (1 << 32) - 1
"""256 V s/rad: far past every motor, and a product with a speed stays within 63 bits."""
FADED: Final = 1 << 5
"""An averaged current (2^-16 mA) that rounding keeps from reaching 0."""
CURRENT_PLACES: Final = 8


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


def first_guess(axis: ServoAxis, current: int, speed: int) -> int:
    """Return a back-EMF constant from the voltage at power-off.

    It is no more than the motor's own where the current has settled; of one that hunts the voltage tells
    nothing.
    The voltage is resistance times current plus constant times speed. A current that brakes makes it smaller
    than the back-EMF. One that drives makes it larger, by a resistance that nobody has told: the largest is
    taken off. What is left may be nothing; an estimate that is too small only brakes, one that is too large
    would drive the shaft.
    """
    voltage = axis.voltage_mv
    if current > 0 < speed or current < 0 > speed:
        voltage -= HIGHEST_RESISTANCE * current
    return min(max(0, (voltage << BACK_EMF_PLACES) // speed), WIDEST_BACK_EMF)


def turns(axis: ServoAxis, speed: int) -> bool:
    """Learn an open winding's back-EMF constant; say whether its voltage must be kept up in this ms.

    An open winding carries no current, but the plant knows voltages only: so the winding gets its own
    back-EMF, speed (mrad/s) times a constant. The constant is known, or learnt from the current that flows.
    """
    current = axis.current_ma
    if speed > LEARNING or speed < -LEARNING:
        constant = axis.back_emf
        if constant == 0 and axis.voltage_mv:
            constant = first_guess(axis, current, speed)
        elif current > 1 or current < -1:
            constant = max(0, constant + -(current * LEARNING_RATE) // speed)
        axis.back_emf = min(constant, WIDEST_BACK_EMF)
        return True
    settled = axis.voltage_mv == 0 and current == 0 and -FADED <= axis.current_average <= FADED
    return not (settled and -RESTING <= speed <= RESTING)


def opened(axis: ServoAxis, current: int, speed: int) -> int:
    """Return the voltage in mV that an open winding shows at this speed in mrad/s.

    Switched off in mid-motion with an unknown constant it shows what `first_guess` makes of the last voltage;
    where that cannot be told, none.
    """
    if axis.back_emf == 0 and axis.voltage_mv and (speed > LEARNING or speed < -LEARNING):
        axis.back_emf = first_guess(axis, current, speed)
    voltage = 0
    if axis.back_emf and (speed > RESTING or speed < -RESTING):
        voltage = (axis.back_emf * speed + (1 << BACK_EMF_PLACES >> 1)) >> BACK_EMF_PLACES
    axis.current_ma = current
    average = axis.current_average
    axis.current_average = average + (((current << AVERAGE_PLACES) - average) >> AVERAGE)
    axis.voltage_mv = voltage
    return voltage
