"""V1 on RS232, the host's end: a command goes in, its outcome comes out. See `v1` for the handshake."""

from enum import Enum, auto
from typing import Final

from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.maxon.end import LineEnd
from firmware_bridge.wire.maxon.frame import ANSWER, Answered, Failure, Frame, Outcome, encode_v1
from firmware_bridge.wire.maxon.v1 import FAILED, FRAME_TIMEOUT, OKAY, Rest


class _HostPhase(Enum):
    IDLE = auto()
    OPCODE = auto()
    COMMAND = auto()
    WORK = auto()
    ANSWER = auto()


_ACCEPTING: Final = frozenset({_HostPhase.OPCODE, _HostPhase.COMMAND})


class V1Host(LineEnd):
    """The host's end, one command at a time. What it does not wait for, it does not hear."""

    def __init__(self, timeout: Nanoseconds, quiet: Nanoseconds = FRAME_TIMEOUT) -> None:
        """Wait `timeout` for each step of the device; it covers the work on a command, too.

        After a failure `ready_at` lies `quiet` ahead: by then the device has given up the old command.
        """
        super().__init__()
        self.ready_at: Nanoseconds = 0
        """From when on a command may be asked."""
        self._timeout = timeout
        self._quiet = quiet
        self._phase = _HostPhase.IDLE
        self._command = b""
        self._answered = True
        self._rest = Rest(0)

    @property
    def busy(self) -> bool:
        """Whether a command is under way."""
        return self._phase is not _HostPhase.IDLE

    def ask(self, frame: Frame, now: Nanoseconds, *, answered: bool = True) -> None:
        """Begin a command; `answered` as its row says for V1. RuntimeError while another is under way."""
        if self.busy:
            raise RuntimeError("the line carries one command at a time")
        self._command = encode_v1(frame)
        self._answered = answered
        self._sent.append(frame.opcode)
        self._enter(_HostPhase.OPCODE, now)

    def hear(self, chunk: bytes, now: Nanoseconds) -> Outcome | None:
        """Take bytes; return how the command ended, once. What follows in the same bytes is dropped."""
        for byte in chunk:
            outcome = self._take(byte, now) if self.busy else None
            if outcome is not None:
                return self._end(outcome, now)
        return None

    def wake(self, now: Nanoseconds) -> Outcome | None:
        """Give up a command that has had no answer in time."""
        return self._end(Failure.SILENCE, now) if self.due <= now else None

    def _take(self, byte: int, now: Nanoseconds) -> Outcome | None:
        if self._phase in _ACCEPTING:
            return self._accepted(byte, now)
        if self._phase is _HostPhase.WORK:
            if byte == ANSWER:
                self._rest = Rest(byte)
                self._sent.append(OKAY)
                self._enter(_HostPhase.ANSWER, now)
            return None
        if not self._rest.take(byte):
            return None
        frame = self._rest.frame()
        self._sent.append(FAILED if frame is None else OKAY)
        return Failure.GARBLED if frame is None else Answered(frame.body)

    def _accepted(self, byte: int, now: Nanoseconds) -> Outcome | None:
        """Take the device's judgement; other bytes are noise."""
        first = self._phase is _HostPhase.OPCODE
        if byte == FAILED:
            return Failure.REFUSED if first else Failure.DAMAGED
        if byte != OKAY:
            return None
        if first:
            self._sent += self._command[1:]
            self._enter(_HostPhase.COMMAND, now)
        elif self._answered:
            self._enter(_HostPhase.WORK, now)
        else:
            return Answered(b"")
        return None

    def _enter(self, phase: _HostPhase, now: Nanoseconds) -> None:
        self._phase = phase
        self.due = now + self._timeout

    def _end(self, outcome: Outcome, now: Nanoseconds) -> Outcome:
        self._phase = _HostPhase.IDLE
        self.due = NEVER
        # A refusal leaves the device idle; after anything else it may still be in the middle of a phase.
        clear = isinstance(outcome, Answered) or outcome in {Failure.REFUSED, Failure.DAMAGED}
        self.ready_at = now if clear else now + self._quiet
        return outcome
