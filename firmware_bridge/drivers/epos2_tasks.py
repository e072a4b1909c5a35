"""The tasks of one EPOS2 as scripts: each yields what it needs next, and is sent what came.

A script reads top to bottom like the procedure in the manual; `firmware_bridge.drivers.script` carries it
over bus and time. It refuses to know either.
"""

from collections.abc import Generator, Mapping
from typing import Final

from firmware_bridge.drivers import epos2_setup as setup
from firmware_bridge.drivers.drive import StartupError
from firmware_bridge.drivers.epos2_heard import Ear
from firmware_bridge.drivers.epos2_setpoint import (
    DISABLE_VOLTAGE,
    ENABLE,
    FAULT_RESET,
    QUICK_STOP,
    SHUTDOWN,
    SWITCH_ON,
    SetPoint,
)
from firmware_bridge.drivers.epos2_setup import Row, Travel
from firmware_bridge.drivers.script import Script, Step, Until
from firmware_bridge.drivers.sdo_client import TIMEOUT, SdoError, Transfer
from firmware_bridge.node import CAN, Packet
from firmware_bridge.robot import Axis, Bus
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.canopen import NmtCommand
from firmware_bridge.wire.cia402 import State, state_of
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.emergency import EMERGENCIES
from firmware_bridge.wire.epos2.rows import DataType

FIND_WITHIN: Final[Nanoseconds] = 2 * SECOND
STATE_WITHIN: Final[Nanoseconds] = SECOND
"""For one transition; measuring the current offset and the rotor's start takes some 100 ms (ASSUME)."""
SAMPLE_WITHIN: Final[Nanoseconds] = 500 * MILLISECOND
LEAVE_WITHIN: Final[Nanoseconds] = 200 * MILLISECOND
POLL: Final[Nanoseconds] = 20 * MILLISECOND
STANDSTILL_WITHIN: Final[Nanoseconds] = 3 * SECOND
STANDSTILL_RPM: Final = 5
"""At the motor; the averaged velocity of a resting shaft shows one or two."""
FAULT_RESETS: Final = 2
NEWEST_ERROR: Final = at.Address(at.ERROR_HISTORY_COUNT.index, 1)
"""The code is its low word (EPOS Firmware Specification)."""

POWERED: Final = (
    State.REFRESH,
    State.MEASURE_INIT,
    State.OPERATION_ENABLED,
    State.QUICK_STOP_ACTIVE,
    State.FAULT_REACTION_ENABLED,
)
"""States in which the motor may have torque."""

TOWARDS_ENABLED: Final[Mapping[State | None, int]] = {
    State.SWITCH_ON_DISABLED: SHUTDOWN,
    State.READY_TO_SWITCH_ON: SWITCH_ON,
    State.SWITCHED_ON: ENABLE,
    State.QUICK_STOP_ACTIVE: ENABLE,
}
"""The next controlword on the way to operation enabled; in other states the drive is on its way by itself."""


def find(axis: Axis, ear: Ear) -> Script:
    """Take the node to pre-operational, no reset: it may be moving. Wait until it answers."""
    ear.knows_mapping = False
    yield _nmt(axis, NmtCommand.ENTER_PRE_OPERATIONAL)
    row = setup.identity(axis)[0]
    yield from _expected(axis, row, attempts=FIND_WITHIN // TIMEOUT)
    ear.heard.restarted = False
    # A node that booted meanwhile did not hear the first one.
    yield _nmt(axis, NmtCommand.ENTER_PRE_OPERATIONAL)


def identify(axis: Axis) -> Script:
    """Check that it is the drive that the robot file names."""
    for row in setup.identity(axis):
        yield from _expected(axis, row)


def configure(axis: Axis, bus: Bus, travel: Travel | None) -> Script:
    """Bring the drive to rest without power, write the set-up, read back what safety hangs on."""
    yield from _come_to_rest(axis)
    for row in setup.configuration(axis, bus, travel):
        try:
            yield Transfer(row.address, row.raw)
        except SdoError as error:
            raise StartupError(axis, f"{error} (writing {row.expected})") from error
        if row.read_back:
            yield from _expected(axis, row)


def start(axis: Axis, ear: Ear) -> Script:
    """Let process data flow; wait for the first state and position."""
    heard = ear.heard
    before = heard.heard_at
    heard.state = None
    ear.knows_mapping = True
    yield _nmt(axis, NmtCommand.START)
    yield Until(
        lambda: heard.heard_at != before and heard.state is not None,
        SAMPLE_WITHIN,
        lambda: StartupError(
            axis, f"no statusword and position within {SAMPLE_WITHIN // MILLISECOND} ms after NMT start"
        ),
    )


def enable(axis: Axis, ear: Ear, set_point: SetPoint) -> Script:
    """Walk to operation enabled, over a fault reset where there is a fault."""
    heard = ear.heard
    resets = 0
    while (state := heard.state) is not State.OPERATION_ENABLED:
        if state is State.FAULT:
            if resets == FAULT_RESETS:
                raise StartupError(axis, f"the fault came back after {resets} resets{_fault(ear)}")
            resets += 1
            yield from _ask_for_fault(ear)
            yield set_point.word(DISABLE_VOLTAGE)
            yield _pause(POLL)
            yield from _turn(axis, ear, set_point, FAULT_RESET)
            heard.fault = 0
        else:
            yield from _turn(axis, ear, set_point, TOWARDS_ENABLED.get(state))
    heard.fault = 0


def leave(axis: Axis, ear: Ear, set_point: SetPoint) -> Script:
    """Take the power off in order, end the watch over the bridge, stop process data."""
    heard = ear.heard
    if heard.operational:
        yield set_point.word(SHUTDOWN)
        yield Until(lambda: heard.state not in POWERED, LEAVE_WITHIN)
        yield set_point.word(DISABLE_VOLTAGE)
        yield Until(lambda: heard.state in (State.SWITCH_ON_DISABLED, State.FAULT), LEAVE_WITHIN)
    for row in setup.farewell():
        try:
            yield Transfer(row.address, row.raw, attempts=1)
        except SdoError:
            # Its own watch over the heartbeat will stop it: that is what the watch is for.
            return
    yield _nmt(axis, NmtCommand.ENTER_PRE_OPERATIONAL)


def _expected(axis: Axis, row: Row, attempts: int = 2) -> Script:
    try:
        raw = yield Transfer(row.address, attempts=attempts)
    except SdoError as error:
        raise StartupError(axis, f"{error} (expected {row.expected})") from error
    if raw != row.raw:
        problem = f"SDO upload {row.address} gave {row.show(raw)} (expected {row.expected})"
        raise StartupError(axis, problem)


def _come_to_rest(axis: Axis) -> Script:
    """Stop a drive that an earlier run left with power on: with power it refuses part of the set-up."""
    if state_of((yield from _read(axis, at.STATUSWORD, DataType.UNSIGNED16))) in POWERED:
        yield from _write(axis, QUICK_STOP)
        for _ in range(STANDSTILL_WITHIN // POLL):
            rpm = yield from _read(axis, at.VELOCITY_AVERAGED, DataType.INTEGER32)
            if abs(rpm) <= STANDSTILL_RPM:
                break
            yield _pause(POLL)
        else:
            seconds = STANDSTILL_WITHIN // SECOND
            raise StartupError(axis, f"the motor still turns with {rpm} rpm {seconds} s after a quick stop")
    yield from _write(axis, DISABLE_VOLTAGE)
    for _ in range(STATE_WITHIN // POLL):
        statusword = yield from _read(axis, at.STATUSWORD, DataType.UNSIGNED16)
        if state_of(statusword) in (State.SWITCH_ON_DISABLED, State.FAULT):
            return
        yield _pause(POLL)
    raise StartupError(axis, f"the power did not go off (statusword 0x{statusword:04X}, expected 0x0140)")


def _read(axis: Axis, address: at.Address, kind: DataType) -> Generator[Step, bytes, int]:
    try:
        return kind.decode((yield Transfer(address)))
    except SdoError as error:
        raise StartupError(axis, str(error)) from error


def _write(axis: Axis, controlword: int) -> Script:
    try:
        yield Transfer(at.CONTROLWORD, DataType.UNSIGNED16.encode(controlword))
    except SdoError as error:
        raise StartupError(axis, f"{error} (writing 0x{controlword:04X})") from error


def _nmt(axis: Axis, command: NmtCommand) -> Packet:
    return Packet(CAN, canopen.NMT, canopen.encode_nmt(command, axis.node))


def _pause(duration: Nanoseconds) -> Until:
    return Until(lambda: False, duration)


def _ask_for_fault(ear: Ear) -> Script:
    """Learn the code of a fault from before this bridge listened; without an answer it stays unknown."""
    if ear.heard.fault:
        return
    try:
        raw = yield Transfer(NEWEST_ERROR)
    except SdoError:
        return
    ear.heard.fault = int.from_bytes(raw[:2], "little")


def _turn(axis: Axis, ear: Ear, set_point: SetPoint, controlword: int | None) -> Script:
    """Send a controlword, or none, and wait until the drive leaves its present state."""
    state = ear.heard.state
    if controlword is not None:
        yield set_point.word(controlword)
    yield Until(
        lambda: ear.heard.state is not state,
        STATE_WITHIN,
        lambda: StartupError(axis, _stuck(ear, state, controlword)),
    )


def _stuck(ear: Ear, state: State | None, controlword: int | None) -> str:
    where = "its state stayed unknown" if state is None else f"it stayed in '{state.title}'"
    after = "" if controlword is None else f" after controlword 0x{controlword:04X}"
    return (
        f"{where} for {STATE_WITHIN // MILLISECOND} ms{after} "
        f"(expected '{State.OPERATION_ENABLED.title}', statusword 0x{ear.heard.statusword:04X}){_fault(ear)}"
    )


def _fault(ear: Ear) -> str:
    code = ear.heard.fault
    if not code:
        return ""
    known = EMERGENCIES.get(code)
    return f"; fault 0x{code:04X}" + (f", {known.cause}" if known else "")
