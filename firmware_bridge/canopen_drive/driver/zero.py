"""Referencing of one drive's axis: homing, begun at standstill and with power on.

By a method in place the position is given, and no shaft turns. By any other it moves to find its reference.
The product's rows name the method and the objects that it hangs on.

The objects that decide the start's effect are read back before: by another method the same Controlword would
set the axis in motion. The earlier halt stays in force until the mode is another, so that no position waits
for its end. Assumed: a mode may be changed with power on, as maxon's command library does.
"""

from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import ControlwordBit, Mode, PowerState, Status
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.sdo_client import Transfer
from firmware_bridge.canopen_drive.driver.feedback import DriveFeedback
from firmware_bridge.canopen_drive.driver.product import DriveProduct
from firmware_bridge.canopen_drive.driver.scale import WHOLE_COUNTER, Scale, travel_of
from firmware_bridge.canopen_drive.driver.set_point import ENABLE, HALT
from firmware_bridge.canopen_drive.driver.setup import MODE
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.canopen_drive.driver.steps import (
    apart,
    controlled,
    expected,
    failing,
    pause,
    read,
    set_up,
    written,
)
from firmware_bridge.canopen_drive.settings import DriveAxis
from firmware_bridge.drivers.driver import StartupError
from firmware_bridge.drivers.script_runner import Ask, Do, Script, Step, Until
from firmware_bridge.robot import Axis, CommandForm
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds

START_HOMING: Final = int(ENABLE | ControlwordBit.NEW_SETPOINT)
POLL: Final[Nanoseconds] = 10 * MILLISECOND
POLLS: Final = 20
_FAILED: Final = int(Status.HOMING_ERROR)
_ENDED: Final = int(Status.HOMING_ATTAINED | Status.HOMING_ERROR)


def set_zero(axis: Axis, feedback: DriveFeedback, position: float) -> Script:
    """Make the present place this position, in the axis's unit; an axis without travel is refused."""
    travel = travel_of(axis)
    if travel is None:
        raise StartupError(axis, "an axis without travel has no zero to be set")
    at = Scale.of(axis).within(position, travel)
    rows = feedback.product.in_place(at)
    return _homing(axis, feedback, rows, (_attained(axis, feedback, POLLS),), at)


def home(axis: Axis, feedback: DriveFeedback) -> Script:
    """Have it home by the robot file; it is halted where it does not finish in time."""
    homing = axis.zero.homing
    if homing is None:
        raise StartupError(axis, "the robot file does not say how it is homed")
    return _homing(
        axis,
        feedback,
        feedback.product.homing,
        (
            _sets_out(axis, feedback),
            Until(lambda: bool(feedback.statusword & _ENDED), from_seconds(homing.within_s)),
            _found(axis, feedback),
        ),
        Scale.of(axis).within(homing.at, travel_of(axis) or WHOLE_COUNTER),
    )


def _homing(
    axis: Axis, feedback: DriveFeedback, rows: tuple[SetupObject, ...], awaited: Script, at: int
) -> Script:
    """Write and read back what it hangs on, start, wait; then back to the axis's own mode."""
    steps: list[Step] = [Do(lambda: _is_enabled(axis, feedback))]
    for row in rows:
        steps.append(written(axis, Transfer(row.address, row.raw), f"writing {row.expected}"))
        steps.append(expected(axis, row))
    return (
        *steps,
        *_mode(axis, Mode.HOMING, feedback.product),
        controlled(axis, ENABLE),
        *apart(feedback.product),
        controlled(axis, START_HOMING),
        *awaited,
        # Bit 4 falls before the mode is another: there it is a new position, the one of before.
        _halted(axis),
        *apart(feedback.product),
        *_mode(axis, MODE[axis.command], feedback.product),
        _counts(axis, feedback, at),
    )


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
        # CiA 402 homing: bit 12 attained, bit 13 error.
        if _is_attained(feedback, statusword) and not statusword & _FAILED:
            return ()
        why = "it gave its homing up" if statusword & _FAILED else "it has not found its zero in time"
        return (_halted(axis), failing(axis, f"{why} (statusword 0x{statusword:04X})"))

    return read(axis, od.STATUSWORD, DataType.UNSIGNED16, judge)


def _attained_bits(feedback: DriveFeedback) -> int:
    return Status.HOMING_ATTAINED | feedback.product.referenced


def _is_attained(feedback: DriveFeedback, statusword: int) -> bool:
    bits = _attained_bits(feedback)
    return statusword & bits == bits


def _is_enabled(axis: Axis, feedback: DriveFeedback) -> Script:
    if feedback.state is not PowerState.OPERATION_ENABLED:
        raise StartupError(axis, "it is not enabled; without power it takes no position")
    return ()


def _mode(axis: Axis, mode: Mode, product: DriveProduct) -> Script:
    """Change the mode of operation, and wait for the drive's own report of it."""
    raw = DataType.INTEGER8.encode(mode)
    # 0x6061 shows the mode that is in force; 0x6060 only what was requested.
    display = SetupObject(
        od.MODE_DISPLAY,
        DataType.INTEGER8,
        mode,
        "mode of operation",
        "it counts now",
        awaited=product.mode_within,
        hint=product.mode_hint,
    )
    shown = set_up(axis, display) if product.mode_within else (expected(axis, display),)
    return (written(axis, Transfer(od.MODE, raw), f"writing mode {mode:d}"), *shown)


def _attained(axis: Axis, feedback: DriveFeedback, polls: int) -> Ask:
    """Wait until the drive reports its position as referenced; so many polls are left."""

    def judge(statusword: int) -> Script:
        feedback.on_statusword(statusword)
        if _is_attained(feedback, statusword) and not statusword & _FAILED:
            return ()
        if polls > 1 and not statusword & _FAILED:
            return (pause(POLL), _attained(axis, feedback, polls - 1))
        bits = f"0x{_attained_bits(feedback):04X}"
        problem = f"it did not take the position (statusword 0x{statusword:04X}, expected the bits {bits})"
        raise StartupError(axis, problem)

    return read(axis, od.STATUSWORD, DataType.UNSIGNED16, judge)


def _counts(axis: Axis, feedback: DriveFeedback, at: int) -> Ask:
    """Look whether it counts from there; it holds still within its following error."""
    margin = DriveAxis.of(axis).profile.max_following_error_qc

    def judge(position: int) -> Script:
        # The count is set at standstill, where the regulator is off by its following error at most.
        if abs(position - at) > margin:
            raise StartupError(axis, f"it counts {position} where its zero was set to {at}")
        feedback.reference_set(position)
        return ()

    return read(axis, od.POSITION_ACTUAL, DataType.INTEGER32, judge)
