"""Steps that the tasks of an EPOS2 are made of: one transfer or one frame each, and what its answer must be.

They refuse to know which task they belong to.
"""

from collections.abc import Callable

from firmware_bridge.drivers.drive import StartupError
from firmware_bridge.drivers.epos2_setup import Row
from firmware_bridge.drivers.script import Ask, Do, Script, Until
from firmware_bridge.drivers.sdo_client import Outcome, SdoError, Transfer
from firmware_bridge.node import CAN, Packet
from firmware_bridge.robot import Axis
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.canopen import NmtCommand
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.rows import DataType


def nmt(axis: Axis, command: NmtCommand) -> Packet:
    """Return the network command to this node."""
    return Packet(CAN, canopen.NMT, canopen.encode_nmt(command, axis.node))


def expected(axis: Axis, row: Row, attempts: int = 2) -> Ask:
    """Read an object; the task fails unless it holds the row's value."""

    def judge(outcome: Outcome) -> Script:
        if isinstance(outcome, SdoError):
            raise StartupError(axis, f"{outcome} (expected {row.expected})") from outcome
        if outcome != row.raw:
            problem = f"SDO upload {row.address} gave {row.show(outcome)} (expected {row.expected})"
            raise StartupError(axis, problem)
        return ()

    return Ask(Transfer(row.address, attempts=attempts), judge)


def read(axis: Axis, address: at.Address, kind: DataType, then: Callable[[int], Script]) -> Ask:
    """Read a number and go on with what `then` makes of it; the task fails without an answer."""

    def judge(outcome: Outcome) -> Script:
        if isinstance(outcome, SdoError):
            raise StartupError(axis, str(outcome)) from outcome
        return then(kind.decode(outcome))

    return Ask(Transfer(address), judge)


def written(axis: Axis, transfer: Transfer, doing: str) -> Ask:
    """Write an object; the task fails unless the drive takes it. `doing` is for people."""

    def judge(outcome: Outcome) -> Script:
        if isinstance(outcome, SdoError):
            raise StartupError(axis, f"{outcome} ({doing})") from outcome
        return ()

    return Ask(transfer, judge)


def controlled(axis: Axis, controlword: int) -> Ask:
    """Write the controlword by SDO: before process data flows there is no other way."""
    transfer = Transfer(at.CONTROLWORD, DataType.UNSIGNED16.encode(controlword))
    return written(axis, transfer, f"writing 0x{controlword:04X}")


def pause(duration: Nanoseconds) -> Until:
    """Let time pass."""
    return Until(lambda: False, duration)


def failing(axis: Axis, problem: str) -> Do:
    """End the task with this problem."""

    def fail() -> Script:
        raise StartupError(axis, problem)

    return Do(fail)
