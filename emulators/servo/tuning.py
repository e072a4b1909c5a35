"""Gains of a drive from the data of motor and load: a start that runs, as a maker's tool finds it.

Current: the regulator's zero cancels the winding's pole, and the closed loop halves its error in each of its
steps of 0.1 ms. Speed and position: the inertia at the shaft gets a bandwidth low enough for one count in a
millisecond to cause little current; the feed-forward is the inertia's torque.
"""

import math
from typing import Final

from emulators.servo.scaling import Settings

CURRENT_STEP_S: Final = 1e-4
HALVED: Final = 0.5
CURRENT_GAIN_PER_OHM: Final = 256.0
"""Gain P, and gain I for each step of the current loop."""
BANDWIDTH_RAD_S: Final = 25.0
INTEGRAL_SHARE: Final = 1.0 / 8.0
"""Share of proportional gain times bandwidth."""
VELOCITY_P: Final = 16_000.0 * math.pi
"""Raw steps for each A s/rad; those below likewise, by `emulators.servo.scaling`."""
VELOCITY_I: Final = 64.0 * math.pi
POSITION_P: Final = 32.0 * math.pi
POSITION_I: Final = 4.096 * math.pi
POSITION_D: Final = 4_000.0 * math.pi
MICROAMPERES: Final = 1e6
LARGEST: Final = 0x7FFF


def tuned(
    inertia_kg_m2: float, *, torque_constant: float, resistance: float = 0.0, inductance: float = 0.0
) -> Settings:
    """Return the settings of a drive for all that its shaft turns; N m/A, Ohm and H, 0 where unknown."""
    made = Settings()
    per_acceleration = inertia_kg_m2 / torque_constant
    if resistance > 0.0 and inductance > 0.0:
        # The winding's pole over one step of the current loop, on which the regulator's zero is put.
        kept = math.exp(-resistance * CURRENT_STEP_S / inductance)
        gain = HALVED * resistance / (1.0 - kept)
        made.current_p = raw(CURRENT_GAIN_PER_OHM * gain * kept)
        made.current_i = raw(CURRENT_GAIN_PER_OHM * gain * (1.0 - kept))
    band = BANDWIDTH_RAD_S
    made.velocity_p = raw(VELOCITY_P * band * per_acceleration)
    made.velocity_i = raw(VELOCITY_I * INTEGRAL_SHARE * band**2 * per_acceleration)
    # Critically damped: s2 + 2 w s + w2, and an integral part far below.
    made.position_p = raw(POSITION_P * band**2 * per_acceleration)
    made.position_d = raw(POSITION_D * 2.0 * band * per_acceleration)
    made.position_i = raw(POSITION_I * INTEGRAL_SHARE * band**3 * per_acceleration)
    forward = raw(MICROAMPERES * per_acceleration)
    made.velocity_acceleration_forward = made.position_acceleration_forward = forward
    return made


def raw(value: float) -> int:
    """Return a gain as its object holds it."""
    # 0 would switch the gain off; INT16 bounds it.
    return min(max(round(value), 1), LARGEST)
