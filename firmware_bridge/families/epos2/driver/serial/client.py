"""Objects of one node read and written over a serial line; a `drivers.script_runner.ObjectClient`.

Both commands may be repeated: reading changes nothing, and writing the same value twice is writing it once.
"""

from collections.abc import Callable
from typing import Final

from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.sdo_client import Outcome, SdoRefusedError, SdoTimeoutError, Transfer
from firmware_bridge.families.epos2.driver.serial.exchange import Job, LineExchange, Rank, Result, succeeded
from firmware_bridge.families.epos2.maxon.frame import Failure
from firmware_bridge.families.epos2.maxon.messages import ObjectRead, ReadObject, Request, WriteObject
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

RAW: Final = 4
"""Size in bytes of either command's data, whatever the object's size."""
TRY_WITHIN: Final[Nanoseconds] = 2 * SECOND
"""Time after which a request is not repeated, whatever attempts are left.

A node that does not answer holds up the whole line for half a second each time.
"""


def reading(node: int, address: Address) -> ReadObject:
    """Return the command that reads an object."""
    return ReadObject(address.index, address.subindex, node)


def writing(node: int, address: Address, raw: bytes) -> WriteObject:
    """Return the command that writes an object of up to four bytes."""
    return WriteObject(address.index, address.subindex, node, raw.ljust(RAW, b"\0"))


def value_in(address: Address, answer: ObjectRead) -> bytes:
    """Return an object's value in an answer; the bytes beyond its size mean nothing."""
    # An answer always has four bytes; those behind the object's size are random.
    return answer.raw[: ANY_TYPE[address].type.size or RAW]


def silent(result: Result) -> bool:
    """Return whether no one answered: on the line, or behind the gateway."""
    return isinstance(result, Failure) or result.error == AbortCode.TIMEOUT


def request_for(node: int, transfer: Transfer) -> Request:
    """Return the command that does a transfer."""
    if transfer.raw is None:
        return reading(node, transfer.address)
    return writing(node, transfer.address, transfer.raw)


def outcome_of(transfer: Transfer, result: Result, waited: Nanoseconds) -> Outcome:
    """Return what a command's end means for the transfer that it did."""
    if isinstance(result, Failure) or silent(result):
        return SdoTimeoutError(transfer, waited)
    if not succeeded(result):
        return SdoRefusedError(transfer, result.error)
    return value_in(transfer.address, result) if isinstance(result, ObjectRead) else b""


class SerialClient:
    """The transfers of one node, one after the other."""

    def __init__(self, node: int, exchange: LineExchange, note: Callable[[Result], None]) -> None:
        """Take the node, the line, and who notes how every single command ended."""
        self._node = node
        self._note = note
        self._exchange = exchange
        self._transfer: Transfer | None = None
        self._job: Job | None = None
        self._outcome: Outcome | None = None
        self._attempts_left = 0
        self._begun_at: Nanoseconds = 0

    @property
    def busy(self) -> bool:
        """True while a transfer is under way."""
        return self._transfer is not None

    @property
    def wake_at(self) -> Nanoseconds:
        """Never: the line keeps the time."""
        return NEVER

    def start(self, transfer: Transfer, now: Nanoseconds) -> tuple[Packet, ...]:
        """Put a transfer in the line; ValueError while another is under way."""
        if self._transfer is not None:
            raise ValueError(f"{transfer} while {self._transfer} is under way")
        self._transfer, self._outcome = transfer, None
        self._attempts_left, self._begun_at = transfer.attempts, now
        self._ask(transfer)
        return ()

    def wake(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Do nothing: the line keeps the time."""
        return ()

    def take(self) -> Outcome | None:
        """Return the outcome of the transfer that just ended, once."""
        outcome, self._outcome = self._outcome, None
        return outcome

    def cancel(self) -> None:
        """Forget the transfer under way; what it has written stays written."""
        if self._job is not None:
            self._exchange.drop(self._job)
        self._transfer = self._job = self._outcome = None

    def ended(self, job: Job, _request: Request, result: Result, now: Nanoseconds) -> None:
        """Learn how the command ended; try again where no one answered and attempts are left."""
        transfer = self._transfer
        if transfer is None or job is not self._job:
            return
        self._note(result)
        # A silent node keeps the line for the gateway's 500 ms at each attempt.
        again = self._attempts_left and now - self._begun_at < TRY_WITHIN
        if silent(result) and again and not self._exchange.gone:
            self._ask(transfer)
            return
        self._transfer = self._job = None
        self._outcome = outcome_of(transfer, result, now - self._begun_at)

    def _ask(self, transfer: Transfer) -> None:
        self._attempts_left -= 1
        self._job = Job(Rank.TASK, self, (request_for(self._node, transfer),))
        self._exchange.put(self._job)
