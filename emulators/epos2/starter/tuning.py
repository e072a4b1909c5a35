"""Gains of an EPOS2 from the data of motor and load: a start that runs, to be refined on the robot.

Current: the regulator's zero cancels the winding's pole, and the closed loop halves its error in each of its
steps of 0.1 ms. Speed: the proportional gain gives the inertia at the shaft a bandwidth of 25 rad/s, low
enough that one quadcount in a millisecond causes little current; the integral gain makes the loop's damping
the square root of 2. The feed-forwards are the inertia's torque and the viscous half of the no-load torque.
Units of the gains: those of the objects 0x60F6 and 0x60F9 of the EPOS2.
"""

import math
from typing import Final

from emulators.motors import Motor
from firmware_bridge.families.epos2.settings import Gains

CURRENT_STEP_S: Final = 1e-4
HALVED: Final = 0.5
CURRENT_GAIN_PER_OHM: Final = 256.0
"""Gain P, and gain I for each step of the current loop."""
VELOCITY_BANDWIDTH_RAD_S: Final = 25.0
INTEGRAL_SHARE: Final = 1.0 / 8.0
"""Share of proportional gain times bandwidth: s2 + w s + w2/8 has the damping of the square root of 2."""
VELOCITY_P_UNIT: Final = 16_000.0 * math.pi
"""Raw steps for each A s/rad."""
VELOCITY_I_UNIT: Final = 64.0 * math.pi
"""Raw steps for each A/rad."""
MICROAMPERES: Final = 1e6
LARGEST: Final = 0x7FFF


def velocity_gains(motor: Motor, inertia_kg_m2: float, voltage_v: float) -> Gains:
    """Return the gains of a drive that regulates speed, for all that its shaft turns.

    The position regulator keeps the drive's defaults: nothing uses it.
    """
    # The winding's pole over one step of the current loop, on which the regulator's zero is put.
    kept = math.exp(-motor.resistance_ohm * CURRENT_STEP_S / motor.inductance_h)
    gain = HALVED * motor.resistance_ohm / (1.0 - kept)
    proportional = VELOCITY_BANDWIDTH_RAD_S * inertia_kg_m2 / motor.torque_constant_nm_a
    integral = INTEGRAL_SHARE * VELOCITY_BANDWIDTH_RAD_S * proportional
    viscous = HALVED * motor.no_load_current_a / motor.no_load_speed(voltage_v)
    return Gains(
        current_p=_raw(CURRENT_GAIN_PER_OHM * gain * kept),
        current_i=_raw(CURRENT_GAIN_PER_OHM * gain * (1.0 - kept)),
        velocity_p=_raw(VELOCITY_P_UNIT * proportional),
        velocity_i=_raw(VELOCITY_I_UNIT * integral),
        velocity_feedforward=_raw(MICROAMPERES * viscous),
        acceleration_feedforward=_raw(MICROAMPERES * inertia_kg_m2 / motor.torque_constant_nm_a),
        position_p=150,
        position_i=10,
        position_d=200,
    )


def _raw(value: float) -> int:
    # 0 would switch the gain off; INT16 bounds it.
    return min(max(round(value), 1), LARGEST)
