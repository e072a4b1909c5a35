"""Devices without a robot, each with a motor and a load of its own."""

from collections.abc import Callable, Sequence
from typing import TypeVar

from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import SUPPLY_MV, DcMotor, DcMotors
from emulators.servo.winding import set_winding

_T = TypeVar("_T")


def with_motors(
    nodes: Sequence[int],
    made: Callable[[int, ServoAxis], _T],
    motor: DcMotor,
    *,
    counts: int,
    supply_mv: int = SUPPLY_MV,
) -> tuple[dict[str, _T], ServoBank]:
    """Make a device of each node number and its motor's axis; return them by name, and what moves them.

    `counts` are the edges of an encoder in one turn.
    """
    axes = [ServoAxis(f"node{node}", counts, supply_mv=supply_mv) for node in nodes]
    for axis in axes:
        set_winding(axis, motor.torque_constant, motor.resistance, motor.inductance)
    devices = {axis.name: made(node, axis) for axis, node in zip(axes, nodes, strict=True)}
    return devices, ServoBank(DcMotors((motor,) * len(axes)), axes)
