"""The runner of one drive's scripts: do a step, wait for its condition, go on with the next one.

A script is a tuple of steps: a packet to send at once, an object to request, a condition to wait for, or a
step that is found out when its turn comes. A step may put further steps before the rest. A `StartupError`
ends the script. The rest of a script is a tuple, too, so that a run can be taken back to any instant. The
purpose of a script is not known here.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeAlias, Union

from firmware_bridge.canopen.sdo_client import Outcome, Transfer
from firmware_bridge.drivers.driver import StartupError
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, Nanoseconds


@dataclass(frozen=True, slots=True)
class Ask:
    """Do one SDO transfer; `then` takes what was read (empty after a download) or the error."""

    transfer: Transfer
    then: Callable[[Outcome], "Script"]


@dataclass(frozen=True, slots=True)
class Until:
    """Wait for a condition; after `within` go on all the same, or fail with the error of `otherwise`."""

    met: Callable[[], bool]
    within: Nanoseconds
    otherwise: Callable[[], StartupError] | None = None


@dataclass(frozen=True, slots=True)
class Do:
    """Do something when its turn comes; it returns what follows."""

    act: Callable[[], "Script"]


Step: TypeAlias = Union[Packet, Ask, Until, Do]  # noqa: UP007 - `Script` is a name yet to come
Script: TypeAlias = tuple[Step, ...]
Sent: TypeAlias = tuple[Packet, ...]


class ObjectClient(Protocol):
    """A client that reads and writes one node's objects, one at a time; a method returns packets to send."""

    @property
    def busy(self) -> bool:
        """True while a transfer is under way."""

    @property
    def wake_at(self) -> Nanoseconds:
        """Time of its next wake-up."""

    def start(self, transfer: Transfer, now: Nanoseconds) -> Sent:
        """Begin a transfer; only when not busy."""

    def wake(self, now: Nanoseconds) -> Sent:
        """Act on the time."""

    def take(self) -> Outcome | None:
        """Return the outcome of the transfer that just ended, once; None while there is none."""

    def cancel(self) -> None:
        """Forget the transfer under way."""


class ScriptRunner:
    """One script at a time on one node, and single transfers in between."""

    def __init__(self, client: ObjectClient) -> None:
        self._client = client
        self._rest: Script | None = None
        """The steps after the one under way; None without a script."""
        self._requested: Ask | None = None
        self._until: Until | None = None
        self._until_at: Nanoseconds = NEVER
        self.failure: StartupError | None = None
        """The failure of the newest script; None without one, or while it has not ended."""

    @property
    def busy(self) -> bool:
        """True while a script has not ended yet."""
        return self._rest is not None

    @property
    def idle(self) -> bool:
        """True while neither a script nor a transfer is under way."""
        return self._rest is None and not self._client.busy

    @property
    def wake_at(self) -> Nanoseconds:
        """Time of its next wake-up."""
        until, late = self._until_at, self._client.wake_at
        return min(until, late)

    def run(self, script: Script, now: Nanoseconds) -> Sent:
        """Begin a script in place of whatever was under way."""
        # A new script replaces the old one whole: two at once would mix their answers.
        self.stop()
        return self._advance(script, now)

    def stop(self, failure: StartupError | None = None) -> None:
        """Forget script and transfer; `failure` is the reason where there is one."""
        self.failure = failure
        self._rest = self._requested = None
        self._client.cancel()
        self._until, self._until_at = None, NEVER

    def ask(self, transfer: Transfer, now: Nanoseconds) -> Sent:
        """Begin a single transfer; only when idle."""
        return self._client.start(transfer, now)

    def take(self) -> Outcome | None:
        """Return the outcome of a single transfer, once."""
        return None if self.busy else self._client.take()

    def wake(self, now: Nanoseconds) -> Sent:
        """Act on the time."""
        return self._client.wake(now) + self.go_on(now)

    def go_on(self, now: Nanoseconds) -> Sent:
        """Carry the script on where what it waits for has come."""
        rest, requested, until = self._rest, self._requested, self._until
        if rest is None:
            return ()
        if requested is not None:
            # The outcome is turned into steps, so that an error in it ends the script like any other.
            outcome = self._client.take()
            return () if outcome is None else self._advance((Do(lambda: requested.then(outcome)), *rest), now)
        if until is not None and not until.met():
            if now < self._until_at:
                return ()
            if until.otherwise is not None:
                self.stop(until.otherwise())
                return ()
        return self._advance(rest, now)

    def _advance(self, script: Script, now: Nanoseconds) -> Sent:
        """Do steps until one has to wait, or none is left; return what they send."""
        sent: Sent = ()
        self._requested, self._until, self._until_at = None, None, NEVER
        while script:
            step, *rest = script
            script = self._rest = tuple(rest)
            match step:
                case Packet():
                    sent += (step,)
                case Ask(transfer):
                    self._requested = step
                    return sent + self._client.start(transfer, now)
                case Until(met, within):
                    if not met():
                        self._until, self._until_at = step, now + within
                        return sent
                case Do(act):
                    try:
                        # What a step adds comes before the rest.
                        script = (*act(), *script)
                    except StartupError as failure:
                        self.stop(failure)
                        return sent
        self._rest = None
        return sent
