"""The way to a drive on the CAN bus: objects by SDO, network commands as they are.

A bus has room for one SDO client of each node. Beside a running bridge this one may get the answer to the
other's question about the same object.
"""

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.sdo_client import (
    ATTEMPTS,
    TIMEOUT,
    SdoClient,
    SdoError,
    SdoRefusedError,
    Transfer,
)
from firmware_bridge.canopen.sdo_client import SdoTimeoutError as NoAnswer
from firmware_bridge.families.epos2.commissioning.job import (
    BrokenAnswerError,
    Job,
    NetworkJob,
    Outcome,
    RefusedError,
    Sent,
    SilentError,
    WriteJob,
    attempts,
    patience,
)
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds


class CanAccess:
    """One drive by its node number."""

    def __init__(self, node: int, timeout: Nanoseconds = TIMEOUT) -> None:
        self.node = node
        """May be another from one job to the next."""
        self._timeout = timeout
        self._tries = ATTEMPTS
        self._client = SdoClient(timeout)
        self._job: Job | None = None
        self._sent_only = False

    @property
    def wake_at(self) -> Nanoseconds:
        """Time when the answer is late."""
        return self._client.wake_at

    def requests_once(self, timeout: Nanoseconds) -> None:
        """Wait so long for an answer from now on, and do not ask again."""
        self._timeout, self._tries = timeout, 1

    def begin(self, job: Job, now: Nanoseconds) -> Sent:
        """Begin a job; ValueError while another is under way."""
        if self._client.busy:
            raise ValueError(f"{job} while {self._job} is under way")
        if isinstance(job, NetworkJob):
            self._sent_only = True
            return (Packet(CAN, cia301.NMT, cia301.encode_nmt(job.command, job.node)),)
        self._job = job
        # One for each job: storing takes seconds, which is far longer than another answer may take.
        self._client = SdoClient(patience(job, self._timeout))
        raw = job.raw if isinstance(job, WriteJob) else None
        return self._requests(self._client.start(Transfer(job.address, raw, attempts(job, self._tries)), now))

    def receive(self, packet: Packet, now: Nanoseconds) -> Sent:
        """Take a frame of the bus; all but those of the drive's SDO server are foreign."""
        if (packet.link, packet.address) != (CAN, cia301.SDO_RESPONSE + self.node):
            return ()
        return self._requests(self._client.receive(packet.payload, now))

    def wake(self, now: Nanoseconds) -> Sent:
        """Ask again, or give up, where an answer is late."""
        return self._requests(self._client.wake(now))

    def take(self) -> Outcome | None:
        """Return how the job ended, once."""
        if self._sent_only:
            self._sent_only = False
            return b""
        outcome, job = self._client.take(), self._job
        if not isinstance(outcome, SdoError) or job is None:
            return outcome if isinstance(outcome, bytes) else None
        if isinstance(outcome, SdoRefusedError):
            return RefusedError(job, outcome.code)
        if isinstance(outcome, NoAnswer):
            return SilentError(job, outcome.transfer.attempts * patience(job, self._timeout))
        return BrokenAnswerError(job, outcome.problem)

    def _requests(self, payloads: tuple[bytes, ...]) -> Sent:
        return tuple(Packet(CAN, cia301.SDO_REQUEST + self.node, payload) for payload in payloads)
