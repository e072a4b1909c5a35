"""The way to a drive on a serial line, and through it, as a gateway, to the others on its CAN bus.

Up to four bytes by ReadObject and WriteObject, longer objects by segments, as maxon's command library does.
Assumed: after silence, or an answer that cannot be read, asking once more does no harm: what is written twice
is the same value, and a controlword without a new edge starts nothing.
"""

from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.commissioning.job import (
    BrokenAnswerError,
    Job,
    NetworkJob,
    Outcome,
    ReadJob,
    RefusedError,
    Sent,
    SilentError,
    attempts,
    patience,
)
from firmware_bridge.families.epos2.maxon import messages
from firmware_bridge.families.epos2.maxon.frame import Failure, Generation
from firmware_bridge.families.epos2.maxon.frame import Outcome as LineOutcome
from firmware_bridge.families.epos2.maxon.lines import host_end
from firmware_bridge.families.epos2.maxon.messages import Request
from firmware_bridge.families.epos2.maxon.opcodes import decode_answer, encode_request, row_of
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

OWN: Final = 0
"""The node number that means the drive on the line, whichever it is."""
TIMEOUT: Final[Nanoseconds] = 2 * SECOND
"""For one step of the drive; its gateway gives another node up before (maxon's library: 1.5 s on USB)."""
ATTEMPTS: Final = 2
DIRECT: Final = 4
"""Size in bytes of a ReadObject answer."""
_NOT_TAKEN: Final = frozenset({Failure.REFUSED, Failure.DAMAGED})
"""The drive has done nothing. This also follows where it took the command for the rest of an earlier one."""
LARGEST_READ: Final = 64 * 1024
"""Size in bytes after which an object that does not end is given up."""


class SerialAccess:
    """One drive by its node number, `OWN` for the one on the line."""

    def __init__(self, generation: Generation, node: int = OWN, timeout: Nanoseconds = TIMEOUT) -> None:
        self.node = node
        self.generation: Final = generation
        self._timeout = timeout
        self._host = host_end(generation, timeout)
        self._job: Job | None = None
        self._request: Request | None = None
        self._begin_at: Nanoseconds = NEVER
        self._attempts_left = 0
        self._gathered: bytearray | None = None
        self._toggle = False
        self._outcome: Outcome | None = None

    @property
    def wake_at(self) -> Nanoseconds:
        """Time when a step is late, or the line is free again."""
        return min(self._begin_at, self._host.due)

    def begin(self, job: Job, now: Nanoseconds) -> Sent:
        """Begin a job; ValueError while another is under way."""
        if self._job is not None:
            raise ValueError(f"{job} while {self._job} is under way")
        self._job = job
        self._attempts_left = ATTEMPTS
        return self._try(job, now)

    def receive(self, packet: Packet, now: Nanoseconds) -> Sent:
        """Take bytes of the line."""
        if packet.link != SERIAL:
            return ()
        return self._ended(self._host.receive(packet.payload, now), now)

    def wake(self, now: Nanoseconds) -> Sent:
        """Give up a step that is late, or begin what had to wait for the line."""
        if self._begin_at <= now and self._request is not None:
            return self._ask(self._request, now)
        return self._ended(self._host.wake(now), now)

    def take(self) -> Outcome | None:
        """Return how the job ended, once."""
        outcome, self._outcome = self._outcome, None
        return outcome

    def _try(self, job: Job, now: Nanoseconds) -> Sent:
        """Begin from the start, when the line is free."""
        self._attempts_left -= 1
        self._gathered = None
        # The new host end inherits the pause that the line needs after a failed command.
        free_at = self._host.ready_at
        self._host = host_end(self.generation, patience(job, self._timeout))
        self._host.ready_at = free_at
        self._request = request = self._first(job)
        if free_at > now:
            self._begin_at = free_at
            return ()
        return self._ask(request, now)

    def _first(self, job: Job) -> Request:
        if isinstance(job, NetworkJob):
            return messages.SendNmtService(job.node, job.command)
        index, subindex = job.address.index, job.address.subindex
        if not isinstance(job, ReadJob):
            return messages.WriteObject(index, subindex, self.node, job.raw.ljust(DIRECT, b"\0"))
        if 0 < size_of(job.address) <= DIRECT:
            return messages.ReadObject(index, subindex, self.node)
        return messages.InitiateSegmentedRead(index, subindex, self.node)

    def _ask(self, request: Request, now: Nanoseconds) -> Sent:
        self._request, self._begin_at = request, NEVER
        answered = self.generation in row_of(request).answered
        self._host.ask(encode_request(request), now, answered=answered)
        return self._taken()

    def _ended(self, outcome: LineOutcome | None, now: Nanoseconds) -> Sent:
        """Act on the end of a command, if this is one."""
        job, request = self._job, self._request
        sent = self._taken()
        if outcome is None or job is None or request is None:
            return sent
        if isinstance(outcome, Failure):
            return sent + self._failed(job, outcome, now)
        if not outcome.body and isinstance(job, NetworkJob):
            self._end(b"")
            return sent
        return sent + self._answered(job, request, outcome.body, now)

    def _answered(self, job: Job, request: Request, body: bytes, now: Nanoseconds) -> Sent:
        answer = decode_answer(request, body)
        if answer is None:
            self._end(BrokenAnswerError(job, f"{len(body)} bytes are no answer to it"))
        elif answer.error:
            self._end(RefusedError(job, answer.error))
        elif isinstance(answer, messages.ObjectRead) and isinstance(job, ReadJob):
            # A direct read has always four bytes: those beyond the object's length are nothing.
            self._end(answer.raw[: size_of(job.address)])
        elif isinstance(answer, messages.SegmentOut):
            return self._gather(job, answer, now)
        elif isinstance(request, messages.InitiateSegmentedRead):
            self._gathered, self._toggle = bytearray(), False
            return self._ask(messages.SegmentRead(messages.control(0, toggle=False)), now)
        else:
            self._end(b"")
        return ()

    def _gather(self, job: Job, segment: messages.SegmentOut, now: Nanoseconds) -> Sent:
        gathered = self._gathered
        # CiA 301: the toggle bit alternates; otherwise a segment came twice, or is missing.
        if gathered is None or messages.toggle_of(segment) is not self._toggle:
            self._end(BrokenAnswerError(job, "the toggle bit did not alternate"))
            return ()
        gathered += segment.raw[: messages.length_of(segment)]
        if not messages.more_of(segment):
            self._end(bytes(gathered))
            return ()
        # A broken drive could send segments without an end.
        if len(gathered) > LARGEST_READ:
            self._end(BrokenAnswerError(job, f"it does not end after {len(gathered)} bytes"))
            return ()
        self._toggle = not self._toggle
        return self._ask(messages.SegmentRead(messages.control(0, toggle=self._toggle)), now)

    def _failed(self, job: Job, failure: Failure, now: Nanoseconds) -> Sent:
        # What the drive has not taken may be sent again, also a command that stores.
        if self._attempts_left and (failure in _NOT_TAKEN or attempts(job, ATTEMPTS) > 1):
            return self._try(job, now)
        if failure is Failure.SILENCE:
            waited = attempts(job, ATTEMPTS) * patience(job, self._timeout)
            self._end(SilentError(job, waited))
        else:
            self._end(BrokenAnswerError(job, failure.value))
        return ()

    def _end(self, outcome: Outcome) -> None:
        self._job = self._request = self._gathered = None
        self._outcome = outcome

    def _taken(self) -> Sent:
        raw = self._host.taken()
        return (Packet(SERIAL, 0, raw),) if raw else ()


def size_of(address: Address) -> int:
    """Return an object's bytes: 0 where its length varies; four where it is not in the table."""
    row = ANY_TYPE.get(address)
    return DIRECT if row is None else row.type.size
