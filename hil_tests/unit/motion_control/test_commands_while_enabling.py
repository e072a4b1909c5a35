"""A command that comes while the drive enables is carried out when it is enabled; none is lost.

A brushless motor needs some ms to be enabled, and clients do not wait for it: 0x0F, the target, 0x1F.
"""

import pytest

from emulators.epos2.control.power_states import BRUSHED_DC
from emulators.epos2.modes.interpolation_buffer import BUFFER_CLEAR
from emulators.epos2.objects.device_profile import BUFFER_SIZE
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.modes import Mode
from hil_tests.rows import every
from hil_tests.unit.motion_control.conftest import ENABLE, SHUTDOWN, SWITCH_ON, Drive, make_drive
from hil_tests.unit.motion_control.interpolated_position.conftest import feed

SINUS_COMMUTATED = 10
START = 0x1F
WAITS_MS = (0, 3, 50)
MOTORS = (BRUSHED_DC, SINUS_COMMUTATED)


def enabling(motor: int, mode: int, wait_ms: float) -> Drive:
    """A drive so many ms after the word that enables it."""
    drive = make_drive()
    drive.write(od.MOTOR_TYPE, motor)
    drive.write(od.MODE, mode)
    drive.command(SHUTDOWN, SWITCH_ON)
    if mode == Mode.INTERPOLATED_POSITION:
        drive.store.set(BUFFER_SIZE, 64)
        drive.write(BUFFER_CLEAR, 1)
        feed(drive, (0, 0, 50), (400, 0, 0))
    drive.command(ENABLE)
    assert drive.stands_in(PowerState.OPERATION_ENABLED) == (motor == BRUSHED_DC)
    drive.run(wait_ms)
    return drive


def commanded(drive: Drive, word: int, *, by_pdo: bool) -> None:
    if by_pdo:
        drive.carries((od.CONTROLWORD, word))
    else:
        drive.command(word)


@pytest.mark.parametrize("by_pdo", [False, True], ids=["sdo", "pdo"])
@every("wait_ms", WAITS_MS)
@every("motor", MOTORS)
def test_a_set_point_is_taken(motor: int, wait_ms: float, *, by_pdo: bool) -> None:
    drive = enabling(motor, Mode.PROFILE_POSITION, wait_ms)
    drive.write(od.TARGET_POSITION, 3000)
    commanded(drive, START, by_pdo=by_pdo)
    drive.run(600)
    assert drive.read(od.POSITION_DEMAND) == 3000
    assert drive.statusword & 0x1000, "set-point acknowledged"


@pytest.mark.parametrize("by_pdo", [False, True], ids=["sdo", "pdo"])
@every("wait_ms", WAITS_MS)
@every("motor", MOTORS)
def test_a_homing_starts(motor: int, wait_ms: float, *, by_pdo: bool) -> None:
    drive = enabling(motor, Mode.HOMING, wait_ms)
    drive.write(od.HOMING_METHOD, 35)
    drive.write(at.HOME_POSITION, 777)
    commanded(drive, START, by_pdo=by_pdo)
    drive.run(50)
    assert drive.read(od.POSITION_ACTUAL) == pytest.approx(777, abs=2)
    assert drive.statusword & 0x9000 == 0x9000, "attained, referenced"


@pytest.mark.parametrize("by_pdo", [False, True], ids=["sdo", "pdo"])
@every("wait_ms", WAITS_MS)
@every("motor", MOTORS)
def test_a_path_starts(motor: int, wait_ms: float, *, by_pdo: bool) -> None:
    drive = enabling(motor, Mode.INTERPOLATED_POSITION, wait_ms)
    commanded(drive, START, by_pdo=by_pdo)
    drive.run(100)
    assert drive.read(od.POSITION_DEMAND) == 400


def test_the_bit_in_the_word_that_enables_starts_nothing() -> None:
    drive = make_drive()
    drive.write(od.TARGET_POSITION, 3000)
    drive.write(od.MODE, Mode.PROFILE_POSITION)
    for word in (SHUTDOWN, SWITCH_ON, START):
        drive.carries((od.CONTROLWORD, word))
    drive.run(300)
    assert drive.stands_in(PowerState.OPERATION_ENABLED)
    assert drive.read(od.POSITION_DEMAND) == 0


def test_a_stop_while_it_enables_wins_over_the_set_point_before_it() -> None:
    drive = enabling(SINUS_COMMUTATED, Mode.PROFILE_POSITION, 1)
    drive.write(od.TARGET_POSITION, 3000)
    drive.command(START, 0x0002)
    drive.run(300)
    assert not drive.stands_in(PowerState.OPERATION_ENABLED)
    assert drive.read(od.POSITION_ACTUAL) == pytest.approx(0, abs=2)
