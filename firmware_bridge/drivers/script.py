"""Carries one drive's scripts: sends what a script yields, waits, and sends back what came.

A script is a generator that yields an SDO transfer (and is sent the bytes read, or thrown the `SdoError`), a
packet to send at once, or something to wait for. A `StartupError` ends it. It refuses to know what a script
is for.
"""

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import TypeAlias

from firmware_bridge.drivers.drive import StartupError
from firmware_bridge.drivers.sdo_client import SdoClient, SdoError, Transfer
from firmware_bridge.node import CAN, Packet
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire import canopen


@dataclass(frozen=True, slots=True)
class Until:
    """Wait for something; after `within` go on all the same, or fail with what `otherwise` says."""

    met: Callable[[], bool]
    within: Nanoseconds
    otherwise: Callable[[], StartupError] | None = None


Step: TypeAlias = Transfer | Packet | Until
Script: TypeAlias = Generator[Step, bytes, None]
Sent: TypeAlias = tuple[Packet, ...]


class Performer:
    """One script at a time on one node, and single transfers in between."""

    __slots__ = ("_client", "_node", "_script", "_until", "_until_at", "failure")

    def __init__(self, node: int) -> None:
        self._node = node
        self._client = SdoClient()
        self._script: Script | None = None
        self._until: Until | None = None
        self._until_at: Nanoseconds = NEVER
        self.failure: StartupError | None = None
        """Why the newest script failed; None where it did not, or has not ended."""

    @property
    def busy(self) -> bool:
        """Whether a script has not ended yet."""
        return self._script is not None

    @property
    def idle(self) -> bool:
        """Whether neither a script nor a transfer is under way."""
        return self._script is None and not self._client.busy

    @property
    def wake_at(self) -> Nanoseconds:
        """When it wants to be woken."""
        return min(self._until_at, self._client.wake_at)

    def perform(self, script: Script, now: Nanoseconds) -> Sent:
        """Begin a script in place of whatever was under way."""
        self.stop()
        self.failure = None
        self._script = script
        return self._advance(None, now)

    def stop(self, failure: StartupError | None = None) -> None:
        """Forget script and transfer; `failure` says why where there is a reason."""
        self.failure = failure
        if self._script is not None:
            self._script.close()
            self._script = None
        self._client.cancel()
        self._until, self._until_at = None, NEVER

    def ask(self, transfer: Transfer, now: Nanoseconds) -> Sent:
        """Begin a single transfer; only when idle."""
        return self._asked(self._client.start(transfer, now))

    def take(self) -> bytes | SdoError | None:
        """Return the outcome of a single transfer, once."""
        return None if self._script is not None else self._client.take()

    def answered(self, payload: bytes, now: Nanoseconds) -> Sent:
        """Take a frame of the node's SDO server."""
        return self._asked(self._client.hear(payload, now)) + self.go_on(now)

    def wake(self, now: Nanoseconds) -> Sent:
        """Act on the time."""
        return self._asked(self._client.wake(now)) + self.go_on(now)

    def go_on(self, now: Nanoseconds) -> Sent:
        """Carry the script on where what it waits for has come."""
        if self._script is None:
            return ()
        if self._until is None:
            outcome = self._client.take()
            return () if outcome is None else self._advance(outcome, now)
        if self._until.met():
            return self._advance(b"", now)
        if now < self._until_at:
            return ()
        if self._until.otherwise is None:
            return self._advance(b"", now)
        self.stop(self._until.otherwise())
        return ()

    def _advance(self, came: bytes | SdoError | None, now: Nanoseconds) -> Sent:
        """Give the script what came, None to start it; send what it yields until it has to wait, or ends."""
        sent: Sent = ()
        script = self._script
        while script is not None:
            self._until, self._until_at = None, NEVER
            try:
                step = _next_step(script, came)
            except StopIteration:
                self._script = None
                break
            except StartupError as failure:
                self.stop(failure)
                break
            if isinstance(step, Packet):
                sent += (step,)
            elif isinstance(step, Transfer):
                return sent + self._asked(self._client.start(step, now))
            elif not step.met():
                self._until, self._until_at = step, now + step.within
                return sent
            came = b""
        return sent

    def _asked(self, payloads: tuple[bytes, ...]) -> Sent:
        return tuple(Packet(CAN, canopen.SDO_REQUEST + self._node, payload) for payload in payloads)


def _next_step(script: Script, came: bytes | SdoError | None) -> Step:
    if came is None:
        return next(script)
    return script.throw(came) if isinstance(came, SdoError) else script.send(came)
