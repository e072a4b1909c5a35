"""Gains of an EPOS2 from the data of motor and load: a start that runs, to be refined on the robot.

The feed-forward of speed is the viscous half of the no-load torque. Units of the gains: those of the objects
0x60F6 and 0x60F9 of the EPOS2.
"""

from typing import Final

from emulators.motors import Motor
from emulators.servo.tuning import MICROAMPERES, raw, tuned
from firmware_bridge.families.epos2.settings import Gains

VISCOUS_SHARE: Final = 0.5


def velocity_gains(motor: Motor, inertia_kg_m2: float, voltage_v: float) -> Gains:
    """Return the gains of a drive that regulates speed, for all that its shaft turns.

    The position regulator keeps the drive's defaults: nothing uses it.
    """
    made = tuned(
        inertia_kg_m2,
        torque_constant=motor.torque_constant_nm_a,
        resistance=motor.resistance_ohm,
        inductance=motor.inductance_h,
    )
    viscous = VISCOUS_SHARE * motor.no_load_current_a / motor.no_load_speed(voltage_v)
    return Gains(
        current_p=made.current_p,
        current_i=made.current_i,
        velocity_p=made.velocity_p,
        velocity_i=made.velocity_i,
        velocity_feedforward=raw(MICROAMPERES * viscous),
        acceleration_feedforward=made.velocity_acceleration_forward,
        position_p=150,
        position_i=10,
        position_d=200,
    )
