"""The set-points of a board's motors, as commands to it."""

from collections.abc import Sequence

from firmware_bridge.drivers.driver import Stop
from firmware_bridge.families.motor_shield.driver.dialects import BoardMessage, Dialect
from firmware_bridge.families.motor_shield.driver.motor import ShieldMotor
from firmware_bridge.units import Nanoseconds


def expressed(
    dialect: Dialect, motors: Sequence[ShieldMotor], now: Nanoseconds, *, configured: bool
) -> tuple[list[BoardMessage], Sequence[ShieldMotor] | None]:
    """Return the commands, and the motors that they release; None where they drive.

    A board that is not set up receives only commands to release.
    """
    if not configured:
        if all(motor.released for motor in motors):
            return [], None
        return list(dialect.release_again(motor.number for motor in motors)), motors
    outputs = {motor.number: motor.output(now) for motor in motors}
    driven = outputs if dialect.on_board else {it.number: outputs[it.number] for it in motors if it.enabled}
    commands = list(dialect.drive(driven, {motor.number: motor.direction for motor in motors}))
    if dialect.on_board and not any(outputs.values()):
        # Speed 0 for all releases them all: sent again to motors that are released, it drives none.
        return commands, motors
    for motor in motors:
        if motor.enabled:
            motor.on_output(outputs[motor.number])
    if dialect.on_board:
        return commands, None
    off = [motor for motor in motors if motor.set_point is Stop.POWER_OFF]
    if not off:
        return commands, None
    # A command may be damaged on the line without a report: it is repeated while the wheel turns.
    slow = [motor for motor in off if not motor.released or motor.turns]
    return [*commands, *dialect.release(motor.number for motor in slow)], slow
