"""Steps that the tasks of a drive are made of: one transfer or one frame each, and what its answer must be.

They refuse to know which task they belong to. What judges an answer is a frozen object and no closure: a
world that can be rewound looks into each closure at each moment.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.sdo_client import ATTEMPTS, Outcome, SdoError, SdoRefusedError, Transfer
from firmware_bridge.canopen_drive.driver.product import DriveProduct
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.canopen_drive.settings import DriveAxis
from firmware_bridge.drivers.driver import StartupError
from firmware_bridge.drivers.script_runner import Ask, Do, Script, Until
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis
from firmware_bridge.units import MILLISECOND, Nanoseconds

POLL: Final[Nanoseconds] = 20 * MILLISECOND
ABSENT: Final = (AbortCode.NO_OBJECT, AbortCode.NO_SUBINDEX)
"""Aborts of a drive that has not got an object."""


def nmt(axis: Axis, command: NmtCommand) -> Packet:
    """Return the network command to this node."""
    return Packet(axis.link, cia301.NMT, cia301.encode_nmt(command, DriveAxis.of(axis).node))


@dataclass(frozen=True, slots=True)
class _Expected:
    """A check of a read value: the task fails unless it is the row's value."""

    axis: Axis
    row: SetupObject

    def __call__(self, outcome: Outcome) -> Script:
        row = self.row
        if isinstance(outcome, SdoError):
            raise StartupError(self.axis, f"{outcome} (expected {row.expected}){row.hint}") from outcome
        if not row.has(outcome):
            problem = f"SDO upload {row.address} gave {row.show(outcome)} (expected {row.expected}){row.hint}"
            raise StartupError(self.axis, problem)
        return ()


@dataclass(frozen=True, slots=True)
class _Decoded:
    """Goes on with a number that was read."""

    axis: Axis
    kind: DataType
    then: Callable[[int], Script]

    def __call__(self, outcome: Outcome) -> Script:
        if isinstance(outcome, SdoError):
            raise StartupError(self.axis, str(outcome)) from outcome
        return self.then(self.kind.decode(outcome))


@dataclass(frozen=True, slots=True)
class _Taken:
    """Judges whether the drive took what was written."""

    axis: Axis
    doing: str

    def __call__(self, outcome: Outcome) -> Script:
        if isinstance(outcome, SdoError):
            raise StartupError(self.axis, f"{outcome} ({self.doing})") from outcome
        return ()


@dataclass(frozen=True, slots=True)
class _TakenIfThere:
    """Passes over an object that the drive has not got; one that it took is read back by the row."""

    axis: Axis
    row: SetupObject
    doing: str

    def __call__(self, outcome: Outcome) -> Script:
        if isinstance(outcome, SdoRefusedError) and outcome.code in ABSENT:
            return ()
        _Taken(self.axis, self.doing)(outcome)
        return (expected(self.axis, self.row),) if self.row.read_back else ()


@dataclass(frozen=True, slots=True)
class _Awaited:
    """Reads again until the object has the row's value; so many reads are left, this one included."""

    axis: Axis
    row: SetupObject
    reads: int

    def __call__(self, outcome: Outcome) -> Script:
        if self.reads > 1 and not isinstance(outcome, SdoError) and not self.row.has(outcome):
            return (pause(POLL), _awaited(self.axis, self.row, self.reads - 1))
        return _Expected(self.axis, self.row)(outcome)


def expected(axis: Axis, row: SetupObject, attempts: int = 2) -> Ask:
    """Read an object; the task fails unless it holds the row's value."""
    return Ask(Transfer(row.address, attempts=attempts), _Expected(axis, row))


def read(
    axis: Axis,
    address: Address,
    kind: DataType,
    then: Callable[[int], Script],
    attempts: int = ATTEMPTS,
) -> Ask:
    """Read a number and go on with what `then` makes of it; the task fails without an answer."""
    return Ask(Transfer(address, attempts=attempts), _Decoded(axis, kind, then))


def written(axis: Axis, transfer: Transfer, doing: str) -> Ask:
    """Write an object; the task fails unless the drive takes it. `doing` is for people."""
    return Ask(transfer, _Taken(axis, doing))


def controlled(axis: Axis, controlword: int, attempts: int = ATTEMPTS) -> Ask:
    """Write the controlword by SDO: where process data does not flow there is no other way."""
    # In pre-operational no RPDO is taken (CiA 301), so an object is the only way.
    transfer = Transfer(od.CONTROLWORD, DataType.UNSIGNED16.encode(controlword), attempts)
    return written(axis, transfer, f"writing 0x{controlword:04X}")


def set_up(axis: Axis, row: SetupObject) -> Script:
    """Give an object of the set-up its value, or wait for it, and read back what safety hangs on."""
    if row.awaited:
        return (_awaited(axis, row, row.awaited // POLL),)
    write = Transfer(row.address, row.raw)
    doing = f"writing {row.expected}{row.hint}"
    if row.optional:
        return (Ask(write, _TakenIfThere(axis, row, doing)),)
    # A write that was acknowledged may still be clipped or ignored.
    return (written(axis, write, doing), *((expected(axis, row),) if row.read_back else ()))


def _awaited(axis: Axis, row: SetupObject, reads: int) -> Ask:
    return Ask(Transfer(row.address), _Awaited(axis, row, reads))


def pause(duration: Nanoseconds) -> Until:
    """Let time pass."""
    return Until(lambda: False, duration)


def apart(product: DriveProduct) -> Script:
    """Let the time pass that a drive needs between two Controlwords."""
    return (pause(product.controlword_gap),) if product.controlword_gap else ()


def failing(axis: Axis, problem: str) -> Do:
    """End the task with this problem."""

    def fail() -> Script:
        raise StartupError(axis, problem)

    return Do(fail)
