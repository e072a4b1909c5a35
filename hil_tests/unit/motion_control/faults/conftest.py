"""A drive that knows its motor, and what the stories of a fault have in common."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import pytest

from emulators.servo.axis_faults import SensorWires
from emulators.servo.winding import set_winding
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen.emergency import FaultReaction
from firmware_bridge.families.epos2.wire.emergency import EMERGENCIES
from hil_tests.unit.motion_control.conftest import STEERING, into_the_supply

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

RESET = 0x80
SOUND = SensorWires()
SENSOR_TYPE, POLARITY, MISCELLANEOUS = Address(0x2210, 2), Address(0x2210, 4), Address(0x2008)
STRUCTURE, NUMERATOR, DENOMINATOR = Address(0x2220), Address(0x2230, 1), Address(0x2230, 2)
POLE_PAIRS = Address(0x6410, 3)
WITH_INDEX, WITHOUT_INDEX, SSI = 1, 2, 4
SINUS, BLOCK = 10, 11


@pytest.fixture
def drive(drive: "Drive") -> "Drive":
    """The drive knows its motor, so that an open winding carries no current from the first instant."""
    set_winding(drive.axis, STEERING.torque_constant, STEERING.resistance, STEERING.inductance)
    return drive


def moving(drive: "Drive", rpm: int = 3000) -> None:
    drive.enable(mode=3)
    drive.run(20)
    drive.write(od.TARGET_VELOCITY, rpm)
    drive.run(300)


def falls(drive: "Drive", code: int, within_ms: int = 100) -> None:
    """Expect this one emergency, with the reaction of its row, and no current after it."""
    already = list(drive.reported)
    drive.runs_until(lambda: drive.reported != already, within_ms)
    fell(drive, *already, code)


def fell(drive: "Drive", *codes: int) -> None:
    """Expect it to have reported these, and to react to the last one by its row, without current."""
    assert drive.reported == list(codes)
    if EMERGENCIES[codes[-1]].reaction is FaultReaction.DISABLE:
        assert drive.stands_in(PowerState.FAULT)
    drive.runs_until(lambda: drive.stands_in(PowerState.FAULT), 500)
    stays_without_current(drive)


def stays_without_current(drive: "Drive") -> None:
    """Check the current: the winding's inductance keeps it going for some ms; then nothing flows."""
    assert not drive.axis.powered
    drive.run(10)
    for _ in range(50):
        drive.run(1)
        assert abs(drive.plant.outputs[0]) < 0.02 + into_the_supply(drive)
        assert not drive.axis.powered


def resets(drive: "Drive") -> bool:
    drive.command(0, RESET)
    return drive.state is PowerState.SWITCH_ON_DISABLED


def resets_after(drive: "Drive", remedy_of: Callable[[], None]) -> None:
    """Expect that the fault can be left when its cause is gone, and not before."""
    assert not resets(drive)
    remedy_of()
    drive.run(2)
    assert resets(drive)
