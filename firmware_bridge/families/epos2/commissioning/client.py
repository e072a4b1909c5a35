"""The engineer's side as a node: carries a script of jobs out on one link, and is finished with it.

A script is a tuple of steps; a step may put further steps before the rest. The purpose of a script and its
link are not known here.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias, Union

from firmware_bridge.families.epos2.commissioning.job import DriveAccess, Job, JobError, Outcome, Sent
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, Nanoseconds


class CommissioningError(Exception):
    """A failed command to the drive: the problem, its place, the remedy."""


@dataclass(frozen=True, slots=True)
class Ask:
    """Do one job; `then` takes its outcome, and may raise it."""

    job: Job
    then: Callable[[Outcome], "Script"]


@dataclass(frozen=True, slots=True)
class Wait:
    """Let time pass."""

    duration: Nanoseconds


@dataclass(frozen=True, slots=True)
class Do:
    """Do something when its turn comes; it returns what follows."""

    act: Callable[[], "Script"]


Step: TypeAlias = Union[Ask, Wait, Do]  # noqa: UP007 - `Script` is a name yet to come
Script: TypeAlias = tuple[Step, ...]
Overhear: TypeAlias = Callable[[Packet], None]
"""A listener for every packet that arrives, from any sender."""


def need(then: Callable[[bytes], Script]) -> Callable[[Outcome], Script]:
    """Return a continuation for outcomes of which only success is of use."""

    def go_on(outcome: Outcome) -> Script:
        if isinstance(outcome, JobError):
            raise outcome
        return then(outcome)

    return go_on


class JobClient:
    """One script on one link. `failure` is the reason of an early end."""

    def __init__(self, link: DriveAccess, script: Script, overhear: Overhear | None = None) -> None:
        self.failure: JobError | CommissioningError | None = None
        self._link = link
        self._overhear = overhear
        self._rest = script
        self._requested: Ask | None = None
        self._paused_until: Nanoseconds = NEVER
        self._started = False
        self._stopped = False

    @property
    def finished(self) -> bool:
        """True where the script has been done, or has failed."""
        return self._started and self._requested is None and self._paused_until == NEVER and not self._rest

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take what arrives on the link."""
        if self._overhear is not None:
            self._overhear(packet)
        return self._go_on(self._link.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Begin at the first call; act on the time."""
        self._started = True
        return self._go_on(self._link.wake(now), now)

    def stop(self, _now: Nanoseconds) -> Reaction:
        """Send nothing more: the drive is left as the last job left it."""
        self._stopped = True
        return Reaction()

    def _go_on(self, sent: Sent, now: Nanoseconds) -> Reaction:
        if self._stopped:
            return Reaction()
        outbox = list(sent)
        try:
            self._advance(outbox, now)
        except (JobError, CommissioningError) as failure:
            self.failure = failure
            self._rest, self._requested, self._paused_until = (), None, NEVER
        wake_at = NEVER if self.finished else min(self._link.wake_at, self._paused_until)
        return Reaction(tuple(outbox), wake_at)

    def _advance(self, outbox: list[Packet], now: Nanoseconds) -> None:
        """Do steps until one has to wait, or none is left."""
        while self._come_true(now) and self._rest:
            step, *rest = self._rest
            self._rest = tuple(rest)
            match step:
                case Ask(job):
                    self._requested = step
                    outbox += self._link.begin(job, now)
                case Wait(duration):
                    self._paused_until = now + duration
                case Do(act):
                    self._rest = act() + self._rest

    def _come_true(self, now: Nanoseconds) -> bool:
        """Return whether what the newest step waits for has come."""
        if self._requested is not None:
            outcome = self._link.take()
            if outcome is None:
                return False
            requested, self._requested = self._requested, None
            self._rest = requested.then(outcome) + self._rest
        if now < self._paused_until != NEVER:
            return False
        self._paused_until = NEVER
        return True
