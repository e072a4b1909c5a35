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


def turns(axis: ServoAxis, speed: int) -> bool:
    """Learn an open winding's back-EMF constant; say whether its voltage must be kept up in this ms.

    An open winding carries no current, but the plant knows voltages only: so the winding gets its own
    back-EMF, speed (mrad/s) times a constant. The constant is known, or learnt from the current that flows.
    """
    current = axis.current_ma
    if speed > LEARNING or speed < -LEARNING:
        constant = axis.back_emf
        if constant == 0:
            constant = max(0, (axis.voltage_mv << BACK_EMF_PLACES) // speed)
        if current > 1 or current < -1:
            constant = max(0, constant + -(current * LEARNING_RATE) // speed)
        axis.back_emf = min(constant, WIDEST_BACK_EMF)
        return True
    settled = axis.voltage_mv == 0 and current == 0 and -FADED <= axis.current_average <= FADED
    return not (settled and -RESTING <= speed <= RESTING)


def opened(axis: ServoAxis, current: int, speed: int) -> int:
    """Return the voltage in mV that an open winding shows at this speed in mrad/s."""
    if -RESTING <= speed <= RESTING:
        voltage = 0
    elif axis.back_emf:
        voltage = (axis.back_emf * speed + (1 << BACK_EMF_PLACES >> 1)) >> BACK_EMF_PLACES
    else:
        # Switched off in mid-motion, before anything is learnt: the last voltage is the nearest to its own.
        voltage = axis.voltage_mv
    axis.current_ma = current
    average = axis.current_average
    axis.current_average = average + (((current << AVERAGE_PLACES) - average) >> AVERAGE)
    axis.voltage_mv = voltage
    return voltage
