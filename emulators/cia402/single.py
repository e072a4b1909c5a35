"""Servos without a robot, each with a motor and a load of its own."""

from collections.abc import Sequence

from emulators.cia402.servo import Servo
from emulators.cia402.variations import PLAIN, Traits
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import SUPPLY_MV, DcMotor, DcMotors
from emulators.servo.winding import set_winding


def servos(
    nodes: Sequence[int],
    motor: DcMotor,
    traits: Traits = PLAIN,
    *,
    counts: int,
    supply_mv: int = SUPPLY_MV,
    bus_rate: int | None = None,
) -> tuple[dict[str, Servo], ServoBank]:
    """Build the servos by their names, and what moves them: motors with encoders of so many counts a turn."""
    axes = [ServoAxis(f"servo{node}", counts, supply_mv=supply_mv) for node in nodes]
    for axis in axes:
        set_winding(axis, motor.torque_constant, motor.resistance, motor.inductance)
    made = {
        axis.name: Servo(node, axis, traits, bus_rate=bus_rate)
        for axis, node in zip(axes, nodes, strict=True)
    }
    return made, ServoBank(DcMotors((motor,) * len(axes)), axes)
