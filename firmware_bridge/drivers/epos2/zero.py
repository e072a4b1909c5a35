"""How one EPOS2 is told where its axis stands: homing by method 35, at rest and with power on.

The drive takes the home position (0x2081) for the place where it is; no shaft turns (EPOS Firmware
Specification, homing mode, by analogy). What the start hangs on is read back before: by another method the
same word would set the axis in motion. The halt of before stands until the mode is another, so that no
position waits for its end. ASSUME: a mode may be changed with power on, as maxon's command library does.
"""

from typing import Final

from firmware_bridge.drivers.driver import StartupError
from firmware_bridge.drivers.epos2.feedback import DriveFeedback
from firmware_bridge.drivers.epos2.scale import Scale, travel_of
from firmware_bridge.drivers.epos2.set_point import ENABLE, HALT
from firmware_bridge.drivers.epos2.setup import MODE, Row
from firmware_bridge.drivers.epos2.steps import controlled, expected, pause, read, written
from firmware_bridge.drivers.script_runner import Ask, Do, Script, Step
from firmware_bridge.drivers.sdo_client import Transfer
from firmware_bridge.robot import Axis, Command
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.cia402 import Control, Mode, State, Status
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.rows import FIRMWARE_SPECIFICATION, DataType

ACTUAL_POSITION: Final = 35
START_HOMING: Final = int(ENABLE | Control.NEW_SETPOINT)
POLL: Final[Nanoseconds] = 10 * MILLISECOND
POLLS: Final = 20
_ATTAINED: Final = int(Status.HOMING_ATTAINED | Status.REFERENCED)
_FAILED: Final = int(Status.HOMING_ERROR)
_WHY: Final = "it stands there, somebody saw it"


def set_zero(axis: Axis, feedback: DriveFeedback, position: float) -> Script:
    """Make the present place this position, in the axis's unit; an axis without travel is refused."""
    travel = travel_of(axis)
    if travel is None:
        raise StartupError(axis, "an axis without travel has no zero to be set")
    home_qc = Scale.of(axis).within(position, travel)
    steps: list[Step] = [Do(lambda: _is_enabled(axis, feedback))]
    for row in rows(home_qc):
        steps.append(written(axis, Transfer(row.address, row.raw), f"writing {row.expected}"))
        steps.append(expected(axis, row))
    return (
        *steps,
        *_mode(axis, Mode.HOMING),
        controlled(axis, ENABLE),
        controlled(axis, START_HOMING),
        _attained(axis, feedback, POLLS),
        # Bit 4 falls before the mode is another: there it is a new position, the one of before.
        controlled(axis, HALT if axis.command is Command.POSITION else ENABLE),
        *_mode(axis, MODE[axis.command]),
        _counts(axis, feedback, home_qc),
    )


def rows(home_qc: int) -> tuple[Row, ...]:
    """Return what method 35 hangs on."""
    source = FIRMWARE_SPECIFICATION
    return (
        Row(at.HOME_POSITION, DataType.INTEGER32, home_qc, "home position", _WHY, source),
        Row(at.HOMING_METHOD, DataType.INTEGER8, ACTUAL_POSITION, "homing method", "no shaft turns", source),
    )


def _is_enabled(axis: Axis, feedback: DriveFeedback) -> Script:
    if feedback.state is not State.OPERATION_ENABLED:
        raise StartupError(axis, "it is not enabled; without power it takes no position")
    return ()


def _mode(axis: Axis, mode: Mode) -> Script:
    """Change the mode of operation, and wait for the drive's own word for it."""
    raw = DataType.INTEGER8.encode(mode)
    display = Row(at.MODE_DISPLAY, DataType.INTEGER8, mode, "mode of operation", "it counts now")
    return (written(axis, Transfer(at.MODE, raw), f"writing mode {mode:d}"), expected(axis, display))


def _attained(axis: Axis, feedback: DriveFeedback, polls: int) -> Ask:
    """Wait until the drive says that its position is referenced; so many polls are left."""

    def judge(statusword: int) -> Script:
        feedback.told(statusword)
        if statusword & _ATTAINED == _ATTAINED and not statusword & _FAILED:
            return ()
        if polls > 1 and not statusword & _FAILED:
            return (pause(POLL), _attained(axis, feedback, polls - 1))
        problem = f"it did not take the position (statusword 0x{statusword:04X}, expected bits 12 and 15)"
        raise StartupError(axis, problem)

    return read(axis, at.STATUSWORD, DataType.UNSIGNED16, judge)


def _counts(axis: Axis, feedback: DriveFeedback, home_qc: int) -> Ask:
    """Look whether it counts from there; it holds still within its following error."""
    margin = axis.settings.profile.max_following_error_qc

    def judge(position_qc: int) -> Script:
        if abs(position_qc - home_qc) > margin:
            raise StartupError(axis, f"it counts {position_qc} qc where its zero was set to {home_qc} qc")
        feedback.zero_set(position_qc)
        return ()

    return read(axis, at.POSITION_ACTUAL, DataType.INTEGER32, judge)
