"""Network commands, and the check of their effect: they have no answer.

After a reset the library of maxon waits 100 ms and then reads the error register for up to 8 s; so does this.
A node in Stopped answers no SDO, so nothing is checked there.
"""

from functools import partial
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import ALL_NODES, NODE_MASK, NmtCommand
from firmware_bridge.canopen.cia402 import Status
from firmware_bridge.families.epos2.commissioning.client import (
    Ask,
    CommissioningError,
    Do,
    Script,
    Wait,
    need,
)
from firmware_bridge.families.epos2.commissioning.job import (
    JobError,
    NetworkJob,
    Outcome,
    ReadJob,
    SilentError,
)
from firmware_bridge.families.epos2.commissioning.serial_access import OWN, SerialAccess
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

SETTLE: Final[Nanoseconds] = 100 * MILLISECOND
RESET_WITHIN: Final[Nanoseconds] = 8 * SECOND
SDO_SERVER: Final = Address(0x1200, 1)
"""Its identifier holds the drive's number, whatever switch or memory that comes from."""
_RESETS: Final = frozenset({NmtCommand.RESET_NODE, NmtCommand.RESET_COMMUNICATION})
_OPERATIONAL: Final = {NmtCommand.START: True, NmtCommand.ENTER_PRE_OPERATIONAL: False}


class NetworkCommand:
    """One command to one node, to all, or to the drive on a serial line whose number is still unknown."""

    def __init__(self, command: NmtCommand, node: int | None) -> None:
        self.command: Final = command
        self.node = node
        self.seen = False
        """True where the effect was checked, and was there."""
        self._time_left: Nanoseconds = RESET_WITHIN

    def script(self) -> Script:
        """Send it, and look where there is one drive to look at."""
        if self.node is None:
            return (Ask(ReadJob(SDO_SERVER), need(self._numbered)),)
        return (Ask(NetworkJob(self.command, self.node), need(lambda _raw: ())), *self._looks())

    def _numbered(self, raw: bytes) -> Script:
        # The identifier of its SDO server is 0x600 plus its number (CiA 301).
        self.node = int.from_bytes(raw, "little") & NODE_MASK
        return self.script()

    def _looks(self) -> Script:
        # A stopped node answers no SDO (CiA 301): there is nothing to look at.
        if self.node == ALL_NODES or self.command is NmtCommand.STOP:
            return ()
        if self.command in _RESETS:
            return (Wait(SETTLE), Ask(ReadJob(od.ERROR_REGISTER), self._back))
        return (Wait(SETTLE), Ask(ReadJob(od.STATUSWORD), need(partial(self._look))))

    def _back(self, outcome: Outcome) -> Script:
        self._time_left -= SETTLE
        # While a drive starts it is silent: the wait for an answer is part of its time.
        if isinstance(outcome, SilentError):
            self._time_left -= outcome.waited
        if isinstance(outcome, JobError) and self._time_left > 0:
            return (Wait(SETTLE), Ask(ReadJob(od.ERROR_REGISTER), self._back))
        if isinstance(outcome, JobError):
            raise outcome
        self.seen = True
        return ()

    def _look(self, raw: bytes) -> Script:
        # The EPOS2 sets bit 9 of its Statusword (remote) only in the NMT state operational.
        operational = bool(int.from_bytes(raw, "little") & Status.REMOTE)
        if operational is not _OPERATIONAL[self.command]:
            found = "operational" if operational else "not operational"
            raise CommissioningError(
                f"node {self.node} is {found} after it; does a second controller command it?"
            )
        self.seen = True
        return ()


class GatewayCheck:
    """Sees that the drive on a serial line is the one that is meant, before anything else is done."""

    def __init__(self, link: SerialAccess, node: int) -> None:
        self.node: Final = node
        self._link = link
        self._target = OWN if link.node == node else link.node

    def script(self) -> Script:
        """Ask it for its number; CommissioningError for another one."""
        return (Do(self._ask),)

    def _ask(self) -> Script:
        self._link.node = OWN
        return (Ask(ReadJob(SDO_SERVER), need(self._compare)),)

    def _compare(self, raw: bytes) -> Script:
        self._link.node = self._target
        found = int.from_bytes(raw, "little") & NODE_MASK
        if found != self.node:
            raise CommissioningError(
                f"the drive on the line is node {found}, not {self.node}; nothing was done. "
                f"Say --gateway {found}, or put the cable into the other drive"
            )
        return ()
