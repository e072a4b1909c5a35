"""The drivers' jobs for one serial line, in order of urgency; the line carries one command at a time.

Bytes and handshake are the line's, in the module beside. The meaning of a command is not known here.
"""

from dataclasses import dataclass
from enum import IntEnum
from typing import Final, Protocol, TypeAlias

from firmware_bridge.families.epos2.maxon.frame import Failure, MaxonAnswer
from firmware_bridge.families.epos2.maxon.messages import Answer, Done, Request
from firmware_bridge.families.epos2.maxon.opcodes import decode_answer
from firmware_bridge.families.epos2.maxon.packets import command, outcome_of
from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

PATIENCE: Final[Nanoseconds] = 4 * SECOND
"""Longer than the line takes to give a command up; only one that the guard kept back comes to this."""

Result: TypeAlias = Answer | Failure
"""The answer of the drive, or of the gateway for it; or the reason why there is no answer."""


class Rank(IntEnum):
    """Rank of a job, the most urgent first."""

    SET_POINT = 0
    BEAT = 1
    SAMPLE = 2
    TASK = 3
    ROTATING = 4


_READS: Final = frozenset({Rank.SAMPLE, Rank.ROTATING})


class Owner(Protocol):
    """The owner of jobs."""

    def ended(self, job: "Job", request: Request, result: Result, now: Nanoseconds) -> None:
        """Learn how a command ended; the rest of the job follows only after a success."""


@dataclass(slots=True, eq=False)
class Job:
    """Commands that belong together, in order."""

    rank: Rank
    owner: Owner
    left: tuple[Request, ...]
    """The requests that have not been sent yet."""
    begun: bool = False
    over: bool = False


class LineExchange:
    """The jobs of one line. Each method returns the command that is to be sent, if any."""

    def __init__(self, link: str) -> None:
        """Take the name of the line."""
        self._link = link
        self.gone = False
        """True while the line has vanished; jobs fail until it is back."""
        self.idle_at: Nanoseconds = 0
        """Time when the last command ended that had nothing behind it."""
        self.under_way: Job | None = None
        self._request: Request | None = None
        self._until: Nanoseconds = NEVER
        self._waiting: list[Job] = []
        self.clock: Nanoseconds = 0
        """The newest instant that is known."""
        self.requested_at: Nanoseconds = 0
        """Time when the newest command began."""

    @property
    def wake_at(self) -> Nanoseconds:
        """Time of its next wake-up."""
        # A line that is gone fails its jobs with the next call.
        return 0 if self.gone and self._waiting else self._until

    def put(self, job: Job) -> None:
        """Add a job behind those of the same rank."""
        self._waiting.append(job)

    def drop(self, job: Job) -> None:
        """Forget what is left of a job; a command of it that is under way still ends."""
        job.left, job.over = (), True
        if job in self._waiting:
            self._waiting.remove(job)

    def drop_reads(self, owner: Owner) -> None:
        """Forget an owner's requests that only read."""
        for job in [job for job in self._waiting if job.owner is owner and job.rank in _READS]:
            self.drop(job)

    def go_on(self) -> tuple[Packet, ...]:
        """Begin the most urgent command where none is under way."""
        if self.under_way is not None or self.gone or not self._waiting:
            return ()
        # `min` takes the first of equals, so jobs of one rank keep their order.
        job = min(self._waiting, key=_rank)
        request, *left = job.left
        job.begun, job.left = True, tuple(left)
        self._waiting.remove(job)
        self.under_way, self._request = job, request
        self.requested_at = self.clock
        self._until = self.clock + PATIENCE
        return (command(request, self._link),)

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take the line's packet; one that answers no command of ours is ignored."""
        self.clock = now
        if packet.address == LINE_LOST and not packet.payload:
            self.gone = True
            self._fail(now)
        elif packet.address == LINE_BACK and not packet.payload:
            self.gone = False
        elif (request := self._request) is not None:
            opcode, outcome = outcome_of(packet)
            # Answers carry no number, only the opcode: one to another command is late, and of no use.
            if opcode == command(request, self._link).address:
                self._end(_result(request, outcome), now)
        return self.go_on()

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Give up a command that no one has answered for."""
        self.clock = now
        if self.gone:
            self._fail(now)
        elif now >= self._until:
            self._end(Failure.SILENCE, now)
        return self.go_on()

    def _end(self, result: Result, now: Nanoseconds) -> None:
        job, request = self.under_way, self._request
        self.under_way = self._request = None
        self._until = NEVER
        if job is None or request is None:
            return
        # The rest goes to the front: a target and its Controlword must not be separated.
        if job.left and succeeded(result):
            self._waiting.insert(0, job)
        else:
            job.over = True
        if not self._waiting:
            self.idle_at = now
        job.owner.ended(job, request, result, now)

    def _fail(self, now: Nanoseconds) -> None:
        """End everything that was under way or has waited; what is begun again now waits for another call."""
        # Taken out first: an owner may put a new job while it learns of the failure.
        waiting, self._waiting = self._waiting, []
        self._end(Failure.SILENCE, now)
        for job in waiting:
            request, job.left, job.over = job.left[0], (), True
            job.owner.ended(job, request, Failure.SILENCE, now)


def succeeded(result: Result) -> bool:
    """Return whether a command was carried out."""
    return not isinstance(result, Failure) and result.error == 0


def _rank(job: Job) -> Rank:
    return job.rank


def _result(request: Request, outcome: MaxonAnswer | Failure) -> Result:
    if isinstance(outcome, Failure):
        return outcome
    if not outcome.body:
        return Done(0)  # V1 answers some commands with its handshake only
    answer = decode_answer(request, outcome.body)
    return Failure.GARBLED if answer is None else answer
