"""Jobs for a drive over any link, their possible ends, and the interface of their carrier."""

from dataclasses import dataclass
from typing import Final, Protocol, TypeAlias

from firmware_bridge.canopen.abort import AbortCode, meaning_of
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

STORING: Final = frozenset({0x1010, 0x1011})
"""Indexes whose writes take as long as the drive's memory needs."""
STORE_TIMEOUT: Final[Nanoseconds] = 6 * SECOND
"""For these; maxon's command library waits 5 s."""


@dataclass(frozen=True, slots=True)
class ReadJob:
    """Read an object."""

    address: Address

    def __str__(self) -> str:
        """Say it for people."""
        return f"reading {self.address}"


@dataclass(frozen=True, slots=True)
class WriteJob:
    """Write an object with one to four bytes, low byte first."""

    address: Address
    raw: bytes

    def __str__(self) -> str:
        """Say it for people."""
        return f"writing {self.address}"


@dataclass(frozen=True, slots=True)
class NetworkJob:
    """Send a network command to a node, 0 for all; no one answers."""

    command: NmtCommand
    node: int

    def __str__(self) -> str:
        """Say it for people."""
        return f"network command {self.command.name.lower().replace('_', ' ')}"


Job: TypeAlias = ReadJob | WriteJob | NetworkJob


class JobError(Exception):
    """A job that did not succeed; `job` is the one."""

    def __init__(self, job: Job, problem: str) -> None:
        super().__init__(job, problem)
        self.job = job
        self.problem = problem
        self.unheard = False
        """True where the drive itself sent nothing at all, so that further requests are of no use."""

    def __str__(self) -> str:
        """Say it in one line."""
        return f"{self.job}: {self.problem}"


class RefusedError(JobError):
    """A refusal by the drive, or by the one on the line in its place."""

    def __init__(self, job: Job, code: int) -> None:
        super().__init__(job, f"refused with {meaning_of(code)}")
        self.code = code
        self.unheard = code == AbortCode.TIMEOUT


class SilentError(JobError):
    """No one answered."""

    def __init__(self, job: Job, waited: Nanoseconds) -> None:
        super().__init__(job, f"no answer within {waited // MILLISECOND} ms")
        self.waited = waited
        self.unheard = True


class BrokenAnswerError(JobError):
    """Something answered that breaks the protocol."""


Outcome: TypeAlias = bytes | JobError
"""The bytes read (empty after any other job), or the failure."""


def patience(job: Job, usual: Nanoseconds) -> Nanoseconds:
    """Return how long to wait for an answer: the link's usual time, or what storing takes."""
    storing = isinstance(job, WriteJob) and job.address.index in STORING
    return STORE_TIMEOUT if storing else usual


def attempts(job: Job, usual: int) -> int:
    """Return the number of attempts: a job that stores is sent only once."""
    return 1 if patience(job, 0) else usual


Sent = tuple[Packet, ...]


class DriveAccess(Protocol):
    """The way to one drive, one job at a time."""

    @property
    def wake_at(self) -> Nanoseconds:
        """Time of the next call of `wake`; `NEVER` while nothing is under way."""

    def begin(self, job: Job, now: Nanoseconds) -> Sent:
        """Begin a job, and return what to send."""

    def receive(self, packet: Packet, now: Nanoseconds) -> Sent:
        """Take a packet, whosever it is, and return what to send."""

    def wake(self, now: Nanoseconds) -> Sent:
        """Act on the time, and return what to send."""

    def take(self) -> Outcome | None:
        """Return how the job ended, once; None while it has not."""
