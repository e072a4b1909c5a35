"""Analog set-points, one millisecond at a time: the voltage at an input instead of a set value.

Source: EPOS2 EDS (0x2301 to 0x2303). Not known here: which object is which; `emulators.epos2.modes` does.
"""

from typing import Final

from emulators.servo.axis import CURRENT, FASTEST_RPM, VELOCITY, ServoAxis

WIDEST_VOLTAGE: Final = 0x7FFF
"""mV: the inputs' range ends far below, but the object holds no more."""
WIDEST_SETPOINT: Final = (1 << 31) - 1
MILLISECONDS_PER_MINUTE: Final = 60_000


def scaled(millivolts: int, numerator: int, denominator: int, offset: int) -> int:
    """Return the set-point that a voltage stands for: mA, rpm or qc."""
    millivolts = max(-WIDEST_VOLTAGE, min(WIDEST_VOLTAGE, millivolts))
    value = millivolts * numerator // denominator + offset
    return max(-WIDEST_SETPOINT, min(WIDEST_SETPOINT, value))


def take(axis: ServoAxis) -> None:
    """Give the regulator the input's value, within its limits."""
    millivolts = axis.analogue_1_mv if axis.analogue_input == 1 else axis.analogue_2_mv
    value = scaled(millivolts, axis.analogue_numerator, axis.analogue_denominator, axis.analogue_offset)
    if axis.regulator == CURRENT:
        axis.current_setting_ma = value
    elif axis.regulator == VELOCITY:
        rpm = max(-FASTEST_RPM, min(FASTEST_RPM, value))
        # To nearest in integers, halves up, as `emulators.servo.scaling.nearest`.
        units = (2 * rpm * axis.resolution << axis.fraction) + MILLISECONDS_PER_MINUTE
        speed = units // (2 * MILLISECONDS_PER_MINUTE)
        axis.velocity_demand = axis.target_velocity = max(-axis.cruise, min(axis.cruise, speed))
    else:
        demand = max(axis.lowest, min(axis.highest, value << axis.fraction))
        axis.position_demand = axis.target_position = demand
        axis.velocity_demand = 0
