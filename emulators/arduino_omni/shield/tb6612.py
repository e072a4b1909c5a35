"""The half bridges TB6612FNG: three levels make a motor driven, braked or free; their losses.

Source: Toshiba, TB6612FNG data sheet: the function table, 0.5 Ohm from both transistors together, 1.2 A mean
and 3.2 A peak a channel, a motor supply of 2.5 to 13.5 V, and that a low voltage is detected. Low PWM with a
direction is a short brake (slow decay).

Where it is silent:
* with both inputs low PWM does not matter.
* thermal shutdown is at 175 degrees C, and ends at 155.
* the outputs are off below 2.5 V of motor supply, the least that it names to work, and on again
  from 2.8 V: the sheet has detection of a low voltage, but neither its threshold nor its hysteresis.
* below 5 V, where it gives 0.5 Ohm, the resistance grows as the supply falls.
* the chip warms by 130 K for each watt, with a time constant of 10 s, from 25 degrees C.
"""

import math
from dataclasses import dataclass
from enum import Enum
from typing import Final

from firmware_bridge.units import Nanoseconds, to_seconds

ON_RESISTANCE: Final = 0.5
"""Ohm, upper and lower transistor together, at 5 V and more."""
FULLY_ON_V: Final = 5.0
LOCKED_V: Final = 2.5
"""V of motor supply below which the outputs are off. Assumed, see above."""
UNLOCKED_V: Final = 2.8
"""V of motor supply from which they are on again. Assumed, see above."""
PEAK_CURRENT: Final = 3.2
"""A, a channel, for 20 ms."""
SHUTDOWN_C: Final = 175.0
BACK_C: Final = 155.0
AMBIENT_C: Final = 25.0
KELVIN_PER_WATT: Final = 130.0
WARMS_IN_S: Final = 10.0
COUNTS: Final = 4_096


class Bridge(Enum):
    """State of the two outputs of a channel."""

    CW = "O1 high, O2 low"
    CCW = "O1 low, O2 high"
    BRAKE = "both low"
    OPEN = "both off"


def bridge(*, in1: bool, in2: bool, pwm: bool, standby: bool = False) -> Bridge:
    """Return a channel's outputs by the function table; `standby` is a low STBY."""
    if standby or not (in1 or in2):
        return Bridge.OPEN
    if not pwm or (in1 and in2):
        return Bridge.BRAKE
    return Bridge.CW if in1 else Bridge.CCW


@dataclass(frozen=True, slots=True)
class BridgeDuty:
    """Shares of a PWM period of 4096 counts; the four add up to it."""

    cw: int = 0
    ccw: int = 0
    brake: int = 0
    open: int = 0

    def volts(self, supply: float, current: float, resistance: float = ON_RESISTANCE) -> float:
        """Return the mean voltage at the motor's terminals in V, for a steady current in A, counted as CW.

        `resistance` is the half bridge's, Ohm.

        None of it holds while all is open: then the motor has its own voltage, and no current.
        """
        # Slow decay: in a short brake the current flows through both transistors, too.
        conducts = self.cw + self.ccw + self.brake
        return ((self.cw - self.ccw) * supply - conducts * current * resistance) / COUNTS


COAST: Final = BridgeDuty(open=COUNTS)


def limited(output: BridgeDuty, current: float, peak: float = PEAK_CURRENT) -> BridgeDuty:
    """Return what is left of an output where the current has reached the peak, in A: a fault to be chosen.

    The side that would make it larger is cut to a brake (assumed: a chip that limits does it so; the data
    sheet gives the 3.2 A as a rating).
    """
    if abs(current) < peak:
        return output
    if current > 0:
        return BridgeDuty(0, output.ccw, output.brake + output.cw, output.open)
    return BridgeDuty(output.cw, 0, output.brake + output.ccw, output.open)


def on_resistance(supply: float) -> float:
    """Return what a half bridge has in Ohm at a motor supply in V."""
    return ON_RESISTANCE * max(1.0, FULLY_ON_V / max(supply, LOCKED_V))


def locked(supply: float, *, was: bool) -> bool:
    """Return whether a motor supply in V is too low for the outputs, where it `was` before or not."""
    return supply < (UNLOCKED_V if was else LOCKED_V)


class Thermal:
    """One chip's temperature, of its two channels together; above the limit it is off until it has cooled."""

    def __init__(self) -> None:
        self.begin(0)

    def begin(self, now: Nanoseconds) -> None:
        """Begin at the ambient temperature."""
        self.celsius = AMBIENT_C
        self.shut_down = False
        self._at: Nanoseconds = now

    def advance(self, currents: tuple[float, ...], now: Nanoseconds) -> None:
        """Advance to `now` with these currents, in A, since the last call."""
        watts = sum(ON_RESISTANCE * current * current for current in currents)
        settled = AMBIENT_C + KELVIN_PER_WATT * watts
        # Exact for a constant power, whatever the time since the last call.
        left = math.exp(-to_seconds(now - self._at) / WARMS_IN_S)
        self.celsius = settled + (self.celsius - settled) * left
        self._at = now
        self.shut_down = self.celsius >= (BACK_C if self.shut_down else SHUTDOWN_C)

    def passes(self, output: BridgeDuty) -> BridgeDuty:
        """Return what a channel of this chip does."""
        return COAST if self.shut_down else output
