"""The tasks of one drive as scripts: tuples of steps, in the order of the procedure in the manual.

`firmware_bridge.drivers.script_runner` carries them over bus and time, which are not known here. A script
keeps nothing but its steps, so that its place in the procedure is data.
"""

from collections.abc import Callable
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.canopen.cia402 import PowerState, towards, word_of
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.sdo_client import ATTEMPTS, TIMEOUT, Outcome, SdoError, Transfer
from firmware_bridge.canopen_drive.driver import setup
from firmware_bridge.canopen_drive.driver.feedback import POWERED, DriveFeedback
from firmware_bridge.canopen_drive.driver.set_point import (
    DISABLE_VOLTAGE,
    FAULT_RESET,
    QUICK_STOP,
    SHUTDOWN,
    DriveSetPoint,
)
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.canopen_drive.driver.steps import (
    POLL,
    apart,
    controlled,
    expected,
    failing,
    nmt,
    pause,
    read,
    set_up,
)
from firmware_bridge.canopen_drive.settings import DriveAxis
from firmware_bridge.drivers.driver import StartupError
from firmware_bridge.drivers.script_runner import Ask, Do, Script, Until
from firmware_bridge.robot import Axis
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

FIND_WITHIN: Final[Nanoseconds] = 2 * SECOND
STATE_WITHIN: Final[Nanoseconds] = SECOND
"""For one transition; measuring the current offset and the rotor's start takes some 100 ms (assumed)."""
SAMPLE_WITHIN: Final[Nanoseconds] = 500 * MILLISECOND
LEAVE_WITHIN: Final[Nanoseconds] = 200 * MILLISECOND
STANDSTILL_WITHIN: Final[Nanoseconds] = 3 * SECOND
FAULT_RESETS: Final = 2
NEWEST_ERROR: Final = Address(od.ERROR_HISTORY_COUNT.index, 1)
"""The code is its low word (CiA 301)."""


def find(axis: Axis, feedback: DriveFeedback) -> Script:
    """Take the node to pre-operational, no reset: it may be moving. Wait until it answers."""
    feedback.expected = False
    # Only the first time: it is the state to which the drive is left at the end.
    if feedback.found_operational is None:
        feedback.found_operational = feedback.operational
    row = feedback.product.identity[0]
    return (
        nmt(axis, NmtCommand.ENTER_PRE_OPERATIONAL),
        expected(axis, row, attempts=FIND_WITHIN // TIMEOUT),
        Do(lambda: _found(feedback)),
        # A node that booted meanwhile did not receive the first one.
        nmt(axis, NmtCommand.ENTER_PRE_OPERATIONAL),
    )


def identify(axis: Axis, rows: tuple[SetupObject, ...]) -> Script:
    """Check that it is the drive that the robot file names."""
    return tuple(expected(axis, row) for row in rows)


def configure(axis: Axis, feedback: DriveFeedback, rows: tuple[SetupObject, ...]) -> Script:
    """Bring the drive to standstill without power, write the set-up, read back what safety hangs on."""
    # First without power: motor data and sensor types cannot be changed otherwise (abort 0x08000022).
    steps = _come_to_rest(axis, feedback)
    return (*steps, *(step for row in rows for step in set_up(axis, row)))


def start(axis: Axis, feedback: DriveFeedback) -> Script:
    """Let process data flow; wait for the first state and position."""
    before = feedback.received_at
    feedback.state = None
    feedback.expected = True
    return (
        nmt(axis, NmtCommand.START),
        Until(
            lambda: feedback.received_at != before and feedback.state is not None,
            SAMPLE_WITHIN,
            lambda: StartupError(
                axis, f"no statusword and position within {SAMPLE_WITHIN // MILLISECOND} ms after NMT start"
            ),
        ),
    )


def enable(axis: Axis, feedback: DriveFeedback, set_point: DriveSetPoint) -> Script:
    """Walk to operation enabled, over a fault reset where there is a fault."""
    # From the request on the power may come at any time; only a new Statusword proves the contrary.
    feedback.unpowered = False
    return (Do(lambda: _towards_enabled(axis, feedback, set_point, 0)),)


def leave(axis: Axis, feedback: DriveFeedback, set_point: DriveSetPoint) -> Script:
    """Take the power off in order, end the watch over the bridge, stop process data unless it flowed before.

    The task fails, and leaves the watch on, where the drive's own statusword does not confirm that it has no
    power: object by object where it does not by process data.
    """
    confirmed = (Do(lambda: _confirmed_off(axis, feedback)), *_farewell(axis, feedback, setup.farewell()))
    if not feedback.operational:
        return (Do(lambda: _come_to_rest(axis, feedback, at_last=True)), *confirmed)
    return (
        # Transition 8, then 7: each waits for its state, so that the drive is not left half way.
        set_point.word(SHUTDOWN),
        Until(lambda: feedback.state not in POWERED, LEAVE_WITHIN),
        Do(lambda: (set_point.word(DISABLE_VOLTAGE),)),
        Until(lambda: _is_off(feedback), LEAVE_WITHIN),
        Do(lambda: () if _is_off(feedback) else _come_to_rest(axis, feedback, at_last=True)),
        *confirmed,
    )


def listen(axis: Axis) -> Script:
    """Take the node to operational, from any NMT state; its set-up is left as it is."""
    return (nmt(axis, NmtCommand.START),)


def brake(axis: Axis, feedback: DriveFeedback) -> Script:
    """Stop a drive object by object, as one that receives no set-points; with answers, until standstill."""
    # One attempt: a drive that does not answer gets the next stage, which uses another channel.
    return (controlled(axis, QUICK_STOP, attempts=1), _standing(axis, feedback))


def disable(axis: Axis, feedback: DriveFeedback) -> Script:
    """Take the power off object by object, and read until the drive confirms it."""
    polls = STATE_WITHIN // POLL
    return (controlled(axis, DISABLE_VOLTAGE, attempts=1), _without_power(axis, feedback, polls))


def reset(axis: Axis, feedback: DriveFeedback) -> Script:
    """Make the drive start again, without power, and read its statusword when it has.

    A boot-up message alone proves nothing: after reset communication a motor may go on turning (assumed).
    """
    # The pause lets the boot-up pass: a drive that boots answers no SDO.
    return (
        nmt(axis, NmtCommand.RESET_NODE),
        pause(LEAVE_WITHIN),
        _restarted(axis, feedback, feedback.product.boot_polls),
    )


def _found(feedback: DriveFeedback) -> Script:
    feedback.restarted = False
    return ()


def _is_off(feedback: DriveFeedback) -> bool:
    return feedback.state in (PowerState.SWITCH_ON_DISABLED, PowerState.FAULT)


def _confirmed_off(axis: Axis, feedback: DriveFeedback) -> Script:
    if not feedback.unpowered:
        raise StartupError(axis, "it has not confirmed that its power is off; its watch stays on")
    return ()


def _statusword(
    axis: Axis, feedback: DriveFeedback, then: Callable[[int], Script], attempts: int = ATTEMPTS
) -> Ask:
    """Read the statusword, whether the drive listens to set-points or not."""

    def judge(statusword: int) -> Script:
        feedback.on_statusword(statusword)
        return then(statusword)

    return read(axis, od.STATUSWORD, DataType.UNSIGNED16, judge, attempts)


def _come_to_rest(axis: Axis, feedback: DriveFeedback, *, at_last: bool = False) -> Script:
    """Stop a drive that was left with power on: with power it refuses part of the set-up.

    `at_last`: it is queried once, and a drive that does not come to standstill loses its power, too.
    """
    standing = _standing(axis, feedback, STATE_WITHIN // POLL, ()) if at_last else _standing(axis, feedback)
    power_off = (controlled(axis, DISABLE_VOLTAGE), _without_power(axis, feedback, STATE_WITHIN // POLL))

    def judge(statusword: int) -> Script:
        # Without power it only needs to be put into a known state; with power it brakes first.
        if feedback.product.states.state_of(statusword) not in POWERED:
            return power_off
        return (controlled(axis, QUICK_STOP), standing, *power_off)

    return (_statusword(axis, feedback, judge, attempts=1 if at_last else ATTEMPTS),)


def _standing(
    axis: Axis,
    feedback: DriveFeedback,
    polls: int = STANDSTILL_WITHIN // POLL,
    otherwise: Script | None = None,
) -> Ask:
    """Wait until the motor stands; so many polls are left, and without `otherwise` the task fails then."""
    product, per_rpm = feedback.product, DriveAxis.of(axis).speed_per_rpm

    def judge(speed: int) -> Script:
        if abs(speed) <= product.standstill:
            return ()
        if polls > 1:
            return (pause(POLL), _standing(axis, feedback, polls - 1, otherwise))
        if otherwise is not None:
            return otherwise
        rpm = f"{speed / per_rpm:g} rpm"
        problem = f"the motor still turns with {rpm} {STANDSTILL_WITHIN // SECOND} s after a quick stop"
        return (pause(POLL), failing(axis, problem))

    return read(axis, product.velocity, DataType.INTEGER32, judge)


def _without_power(axis: Axis, feedback: DriveFeedback, polls: int) -> Ask:
    """Wait until the power is off; so many polls are left."""

    def judge(statusword: int) -> Script:
        if feedback.product.states.state_of(statusword) in (PowerState.SWITCH_ON_DISABLED, PowerState.FAULT):
            return ()
        if polls > 1:
            return (pause(POLL), _without_power(axis, feedback, polls - 1))
        problem = f"the power did not go off (statusword 0x{statusword:04X}, expected 0x0140)"
        return (pause(POLL), failing(axis, problem))

    return _statusword(axis, feedback, judge)


def _restarted(axis: Axis, feedback: DriveFeedback, polls: int) -> Ask:
    """Read the statusword of a drive that starts, which does not answer at once; so many polls are left."""

    def judge(outcome: Outcome) -> Script:
        if not isinstance(outcome, SdoError):
            feedback.on_statusword(DataType.UNSIGNED16.decode(outcome))
        elif polls > 1:
            return (pause(POLL), _restarted(axis, feedback, polls - 1))
        return ()

    return Ask(Transfer(od.STATUSWORD, attempts=1), judge)


def _farewell(axis: Axis, feedback: DriveFeedback, rows: tuple[SetupObject, ...]) -> Script:
    """Write what is written before leaving; a drive that refuses is left as it is."""
    if not rows:
        left = NmtCommand.START if feedback.found_operational else NmtCommand.ENTER_PRE_OPERATIONAL
        return (nmt(axis, left),)

    def judge(outcome: Outcome) -> Script:
        # Its own watch over the heartbeat will stop it: that is what the watch is for.
        return () if isinstance(outcome, SdoError) else _farewell(axis, feedback, rows[1:])

    return (Ask(Transfer(rows[0].address, rows[0].raw, attempts=1), judge),)


def _towards_enabled(axis: Axis, feedback: DriveFeedback, set_point: DriveSetPoint, resets: int) -> Script:
    """Take the next step from the present state; `resets` faults were reset so far."""
    if feedback.state is PowerState.OPERATION_ENABLED:
        feedback.fault = 0
        return ()
    if feedback.state is not PowerState.FAULT:
        # In a state that has none the drive is on its way by itself.
        command = towards(feedback.state, PowerState.OPERATION_ENABLED)
        word = None if command is None else word_of(command)
        go_on = Do(lambda: _towards_enabled(axis, feedback, set_point, resets))
        return (*_turn(axis, feedback, set_point, word), *apart(feedback.product), go_on)
    if resets == FAULT_RESETS:
        raise StartupError(axis, f"the fault came back after {resets} resets{_fault(feedback)}")
    return (
        *_ask_for_fault(feedback),
        Do(lambda: (set_point.word(DISABLE_VOLTAGE),)),
        pause(POLL),
        Do(lambda: _turn(axis, feedback, set_point, FAULT_RESET)),
        Do(lambda: _cured(feedback)),
        Do(lambda: _towards_enabled(axis, feedback, set_point, resets + 1)),
    )


def _cured(feedback: DriveFeedback) -> Script:
    feedback.fault = 0
    return ()


def _ask_for_fault(feedback: DriveFeedback) -> Script:
    """Learn the code of a fault from before this bridge listened; without an answer it stays unknown."""

    def learn(outcome: Outcome) -> Script:
        if not isinstance(outcome, SdoError):
            feedback.fault = int.from_bytes(outcome[:2], "little")
        return ()

    return () if feedback.fault else (Ask(Transfer(NEWEST_ERROR), learn),)


def _turn(axis: Axis, feedback: DriveFeedback, set_point: DriveSetPoint, controlword: int | None) -> Script:
    """Send a controlword, or none, and wait until the drive leaves its present state."""
    state = feedback.state
    return (
        *(() if controlword is None else (set_point.word(controlword),)),
        Until(
            lambda: feedback.state is not state,
            STATE_WITHIN,
            lambda: StartupError(axis, _stuck(feedback, state, controlword)),
        ),
    )


def _stuck(feedback: DriveFeedback, state: PowerState | None, controlword: int | None) -> str:
    where = "its state stayed unknown" if state is None else f"it stayed in '{state.title}'"
    after = "" if controlword is None else f" after controlword 0x{controlword:04X}"
    return (
        f"{where} for {STATE_WITHIN // MILLISECOND} ms{after} "
        f"(expected '{PowerState.OPERATION_ENABLED.title}', statusword 0x{feedback.statusword:04X})"
        f"{_fault(feedback)}"
    )


def _fault(feedback: DriveFeedback) -> str:
    return f"; fault {feedback.in_words(feedback.fault)}" if feedback.fault else ""
