"""The common part of both serial protocols' ends."""

from typing import Protocol

from firmware_bridge.families.epos2.maxon.frame import Frame, Outcome
from firmware_bridge.units import NEVER, Nanoseconds


class LineEnd:
    """One end of a line: it receives bytes and the time; its bytes to send wait in `taken`."""

    def __init__(self) -> None:
        self.due: Nanoseconds = NEVER
        """Time of the next call of `wake`."""
        self._sent = bytearray()

    def taken(self) -> bytes:
        """Return what is to be sent, once."""
        sent = bytes(self._sent)
        self._sent.clear()
        return sent


class DeviceEnd(Protocol):
    """The drive's end of either protocol. Each command that comes out needs one call of `answer`."""

    due: Nanoseconds

    @property
    def idle(self) -> bool:
        """True while no command is under way, nor has one begun."""

    def taken(self) -> bytes:
        """Return what is to be sent, once."""

    def receive(self, chunk: bytes, now: Nanoseconds) -> Frame | None:
        """Take bytes; return the command that they complete, if any."""

    def answer(self, body: bytes | None, now: Nanoseconds) -> Frame | None:
        """Answer the command, or with None go without; return the next command where one has waited."""

    def wake(self, now: Nanoseconds) -> None:
        """Give up what has lasted too long."""

    def reset(self) -> None:
        """Forget everything, as at power-on."""


class HostEnd(Protocol):
    """The host's end of either protocol: one command at a time, and one outcome for each."""

    due: Nanoseconds
    ready_at: Nanoseconds

    @property
    def busy(self) -> bool:
        """True while a command is under way."""

    def taken(self) -> bytes:
        """Return what is to be sent, once."""

    def ask(self, frame: Frame, now: Nanoseconds, *, answered: bool = True) -> None:
        """Begin a command; `answered` by its row for this protocol."""

    def receive(self, chunk: bytes, now: Nanoseconds) -> Outcome | None:
        """Take bytes; return how the command ended, once."""

    def wake(self, now: Nanoseconds) -> Outcome | None:
        """Give up a command that has had no answer in time."""
