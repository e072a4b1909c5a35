"""Referencing of one EPOS2's axis: homing, begun at standstill and with power on.

By method 35 the position is given: it takes the home position (0x2081) for its present one, and no shaft
turns. By any other it moves to find its reference (EPOS Firmware Specification, homing mode, by analogy).
Assumed: the offset 0x607C is a distance that it goes from the found reference, with its sign, and the home
position is its position then.

The objects that decide the start's effect are read back before: by another method the same Controlword would
set the axis in motion. The earlier halt stays in force until the mode is another, so that no position waits
for its end. Assumed: a mode may be changed with power on, as maxon's command library does.
"""

import math
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import ControlwordBit, PowerState, Status
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.sdo_client import Transfer
from firmware_bridge.drivers.driver import StartupError
from firmware_bridge.drivers.script_runner import Ask, Do, Script, Step, Until
from firmware_bridge.families.epos2.driver.feedback import MILLIAMPERES, DriveFeedback
from firmware_bridge.families.epos2.driver.scale import Scale, travel_of
from firmware_bridge.families.epos2.driver.set_point import ENABLE, HALT
from firmware_bridge.families.epos2.driver.setup import MODE, SetupObject
from firmware_bridge.families.epos2.driver.steps import controlled, expected, failing, pause, read, written
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.families.epos2.wire.rows import FIRMWARE_SPECIFICATION
from firmware_bridge.robot import Axis, CommandForm
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds

ACTUAL_POSITION: Final = 35
START_HOMING: Final = int(ENABLE | ControlwordBit.NEW_SETPOINT)
POLL: Final[Nanoseconds] = 10 * MILLISECOND
POLLS: Final = 20
_ATTAINED: Final = int(Status.HOMING_ATTAINED | Status.REFERENCED)
_FAILED: Final = int(Status.HOMING_ERROR)
_ENDED: Final = int(Status.HOMING_ATTAINED | Status.HOMING_ERROR)
_WHY: Final = "it stands there, someone saw it"
_SLOW: Final = "no faster than the robot file allows"


def set_zero(axis: Axis, feedback: DriveFeedback, position: float) -> Script:
    """Make the present place this position, in the axis's unit; an axis without travel is refused."""
    travel = travel_of(axis)
    if travel is None:
        raise StartupError(axis, "an axis without travel has no zero to be set")
    home_qc = Scale.of(axis).within(position, travel)
    return _homing(axis, feedback, rows(home_qc), (_attained(axis, feedback, POLLS),))


def home(axis: Axis, feedback: DriveFeedback) -> Script:
    """Have it home by the robot file; it is halted where it does not finish in time."""
    homing = axis.zero.homing
    if homing is None:
        raise StartupError(axis, "the robot file does not say how it is homed")
    return _homing(
        axis,
        feedback,
        rows_of(axis),
        (
            _sets_out(axis, feedback),
            Until(lambda: bool(feedback.statusword & _ENDED), from_seconds(homing.within_s)),
            _found(axis, feedback),
        ),
    )


def _homing(axis: Axis, feedback: DriveFeedback, rows: tuple[SetupObject, ...], awaited: Script) -> Script:
    """Write and read back what it hangs on, start, wait; then back to the axis's own mode."""
    steps: list[Step] = [Do(lambda: _is_enabled(axis, feedback))]
    for row in rows:
        steps.append(written(axis, Transfer(row.address, row.raw), f"writing {row.expected}"))
        steps.append(expected(axis, row))
    return (
        *steps,
        *_mode(axis, Mode.HOMING),
        controlled(axis, ENABLE),
        controlled(axis, START_HOMING),
        *awaited,
        # Bit 4 falls before the mode is another: there it is a new position, the one of before.
        _halted(axis),
        *_mode(axis, MODE[axis.command]),
        _counts(axis, feedback, rows[0].value),
    )


def rows(home_qc: int) -> tuple[SetupObject, ...]:
    """Return what method 35 hangs on."""
    source = FIRMWARE_SPECIFICATION
    return (
        SetupObject(at.HOME_POSITION, DataType.INTEGER32, home_qc, "home position", _WHY, source),
        SetupObject(
            od.HOMING_METHOD, DataType.INTEGER8, ACTUAL_POSITION, "homing method", "no shaft turns", source
        ),
    )


def rows_of(axis: Axis) -> tuple[SetupObject, ...]:
    """Return what the homing of an axis hangs on; StartupError where it has none."""
    homing, travel, scale, source = axis.zero.homing, travel_of(axis), Scale.of(axis), FIRMWARE_SPECIFICATION
    if homing is None or travel is None:
        raise StartupError(axis, "the robot file does not say how it is homed")
    fast, slow, ramp = homing.speed, homing.zero_speed, homing.acceleration
    offset_qc = scale.quadcounts(homing.offset)
    current = () if homing.current_a is None else (math.floor(homing.current_a * MILLIAMPERES),)
    u16, u32, i32 = DataType.UNSIGNED16, DataType.UNSIGNED32, DataType.INTEGER32
    there = "the robot file knows this place"
    return (
        SetupObject(at.HOME_POSITION, i32, scale.within(homing.at, travel), "home position", there, source),
        SetupObject(od.HOME_OFFSET, i32, offset_qc, "home offset", "off stop and switch", source),
        SetupObject(
            od.HOMING_SPEED_SWITCH, u32, _whole_rpm(scale, fast), "speed for switch search", _SLOW, source
        ),
        SetupObject(
            od.HOMING_SPEED_ZERO, u32, _whole_rpm(scale, slow), "speed for zero search", _SLOW, source
        ),
        SetupObject(
            od.HOMING_ACCELERATION, u32, _whole_rpm(scale, ramp), "homing acceleration", _SLOW, source
        ),
        *(
            SetupObject(at.HOMING_CURRENT, u16, threshold, "current threshold", "this is the stop", source)
            for threshold in current
        ),
        SetupObject(
            od.HOMING_METHOD, DataType.INTEGER8, homing.method, "homing method", "as the robot file", source
        ),
    )


def _whole_rpm(scale: Scale, speed: float) -> int:
    """Return whole rpm, or rpm/s, that are not above a speed behind the gear."""
    # Rounded down, but never 0: a homing at 0 rpm would not end.
    return max(1, math.floor(abs(scale.rpm(speed))))


def _halted(axis: Axis) -> Ask:
    return controlled(axis, HALT if axis.command is CommandForm.POSITION else ENABLE)


def _sets_out(axis: Axis, feedback: DriveFeedback) -> Ask:
    """Read a statusword that is newer than the start: bit 12 of before is none of this homing's."""

    def judge(statusword: int) -> Script:
        # Until the drive reports bit 12 its count is continuous, so the motion may be supervised by it.
        feedback.zeroing, feedback.seeking = False, True
        feedback.on_statusword(statusword)
        return ()

    return read(axis, od.STATUSWORD, DataType.UNSIGNED16, judge)


def _found(axis: Axis, feedback: DriveFeedback) -> Ask:
    """Look how the homing has ended; one that did not come to its end is halted at once."""

    def judge(statusword: int) -> Script:
        feedback.on_statusword(statusword)
        # CiA 402 homing: bit 12 attained, bit 13 error; bit 15 is maxon's "position referenced".
        if statusword & _ATTAINED == _ATTAINED and not statusword & _FAILED:
            return ()
        why = "it gave its homing up" if statusword & _FAILED else "it has not found its zero in time"
        return (_halted(axis), failing(axis, f"{why} (statusword 0x{statusword:04X})"))

    return read(axis, od.STATUSWORD, DataType.UNSIGNED16, judge)


def _is_enabled(axis: Axis, feedback: DriveFeedback) -> Script:
    if feedback.state is not PowerState.OPERATION_ENABLED:
        raise StartupError(axis, "it is not enabled; without power it takes no position")
    return ()


def _mode(axis: Axis, mode: Mode) -> Script:
    """Change the mode of operation, and wait for the drive's own report of it."""
    raw = DataType.INTEGER8.encode(mode)
    # 0x6061 shows the mode that is in force; 0x6060 only what was requested.
    display = SetupObject(od.MODE_DISPLAY, DataType.INTEGER8, mode, "mode of operation", "it counts now")
    return (written(axis, Transfer(od.MODE, raw), f"writing mode {mode:d}"), expected(axis, display))


def _attained(axis: Axis, feedback: DriveFeedback, polls: int) -> Ask:
    """Wait until the drive reports its position as referenced; so many polls are left."""

    def judge(statusword: int) -> Script:
        feedback.on_statusword(statusword)
        if statusword & _ATTAINED == _ATTAINED and not statusword & _FAILED:
            return ()
        if polls > 1 and not statusword & _FAILED:
            return (pause(POLL), _attained(axis, feedback, polls - 1))
        problem = f"it did not take the position (statusword 0x{statusword:04X}, expected bits 12 and 15)"
        raise StartupError(axis, problem)

    return read(axis, od.STATUSWORD, DataType.UNSIGNED16, judge)


def _counts(axis: Axis, feedback: DriveFeedback, home_qc: int) -> Ask:
    """Look whether it counts from there; it holds still within its following error."""
    margin = Epos2Axis.of(axis).profile.max_following_error_qc

    def judge(position_qc: int) -> Script:
        # Method 35 sets the count at standstill, where the regulator is off by its following error at most.
        if abs(position_qc - home_qc) > margin:
            raise StartupError(axis, f"it counts {position_qc} qc where its zero was set to {home_qc} qc")
        feedback.reference_set(position_qc)
        return ()

    return read(axis, od.POSITION_ACTUAL, DataType.INTEGER32, judge)
