"""Motors' data as the catalog has them, for every plant that has one and for tuning; assumed, unchecked."""

from typing import Final, TypedDict


class MotorSheet(TypedDict):
    """Values of a data sheet for `fmu.parts.rows.motor_rows`; SI."""

    resistance: float
    inductance: float
    torque_constant: float
    rotor_inertia: float
    no_load_current: float


RE25: Final[MotorSheet] = {
    "resistance": 2.32,
    "inductance": 0.238e-3,
    "torque_constant": 23.4e-3,
    "rotor_inertia": 10.5e-7,
    "no_load_current": 0.037,
}
"""maxon RE25, 20 W, 24 V."""
RE40: Final[MotorSheet] = {
    "resistance": 0.299,
    "inductance": 0.082e-3,
    "torque_constant": 30.2e-3,
    "rotor_inertia": 142e-7,
    "no_load_current": 0.137,
}
"""maxon RE40, 150 W, 24 V, 148867."""
RE50: Final[MotorSheet] = {
    "resistance": 0.103,
    "inductance": 0.072e-3,
    "torque_constant": 38.5e-3,
    "rotor_inertia": 536e-7,
    "no_load_current": 0.236,
}
"""maxon RE50, 200 W, 24 V, 370354."""
