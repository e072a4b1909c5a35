"""V1 on RS232, both ends: the handshake byte by byte, and a frame as it comes in.

Source: EPOS2 Application Notes Collection, April 2013, p. 11-166; EPOS Communication Guide, October 2006. A
command goes `opcode`, then `O` or `F` comes back; the rest goes, and again `O` or `F` comes, but no `O` for
one that resets a node or its communication. The answer's opcode 0 comes, and the host sends `O`; its rest
comes, and the host sends `O` or `F`. Where they are silent:

* Bytes that arrive while the device works on a command wait, up to `ROOM` of them, and count afterwards.
* Another byte of the host is dropped together with the answer; its last `F` repeats nothing.
* A device's phase lasts from its own last byte to the last byte that it wants from the host.
"""

from collections import deque
from collections.abc import Callable, Container
from enum import Enum, auto
from typing import Final

from firmware_bridge.families.epos2.maxon.end import LineEnd
from firmware_bridge.families.epos2.maxon.frame import (
    ANSWER,
    CHECKSUM_SIZE,
    Failure,
    Frame,
    MaxonAnswer,
    Outcome,
    checksum,
    encode_v1,
)
from firmware_bridge.families.epos2.maxon.opcodes import COMMANDS, RESETS_WITHIN, acknowledged
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

OKAY: Final = 0x4F
FAILED: Final = 0x46
FRAME_TIMEOUT: Final = 500 * MILLISECOND
"""Default of 0x2005; a host that failed is silent for so long, and the device is idle again."""
ROOM: Final = 1024
_HEAD: Final = 2


class Rest:
    """A frame behind its opcode as it comes in: length, data, check sum."""

    def __init__(self, opcode: int) -> None:
        self._taken = bytearray((opcode,))

    def take(self, byte: int) -> bool:
        """Take a byte; True when the frame is whole."""
        self._taken.append(byte)
        # The length byte counts words less one, so 0 is one word.
        return len(self._taken) == _HEAD + 2 * (self._taken[1] + 1) + CHECKSUM_SIZE

    def frame(self) -> Frame | None:
        """Return the whole frame; None where the check sum is wrong."""
        taken = bytes(self._taken)
        body = taken[_HEAD:-CHECKSUM_SIZE]
        sent = int.from_bytes(taken[-CHECKSUM_SIZE:], "little")
        return Frame(taken[0], body) if checksum(taken[0] << 8 | taken[1], body) == sent else None


class _DevicePhase(Enum):
    IDLE = auto()
    COMMAND = auto()
    WORK = auto()
    OFFER = auto()
    ANSWER = auto()


class V1Device(LineEnd):
    """The drive's end. `receive` returns a command, and each command needs one call of `answer`."""

    def __init__(self, timeout: Callable[[], Nanoseconds], known: Container[int] = COMMANDS) -> None:
        """Take the time of a phase from `timeout` each time one begins."""
        super().__init__()
        self._timeout = timeout
        self._known = known
        self._phase = _DevicePhase.IDLE
        self._rest = Rest(0)
        self._answer = b""
        self._waiting: deque[int] = deque()

    @property
    def idle(self) -> bool:
        """True while no command is under way, nor has one begun."""
        return self._phase is _DevicePhase.IDLE

    def receive(self, chunk: bytes, now: Nanoseconds) -> Frame | None:
        """Take bytes; return the command that they complete, if any.

        A phase ends by `wake` alone: bytes that a busy machine hands over late have arrived in time.
        """
        free = self._phase is not _DevicePhase.WORK
        # While a command is at work its bytes lie in the port's buffer, which has an end.
        self._waiting.extend(chunk if free else chunk[: max(ROOM - len(self._waiting), 0)])
        return self._next(now)

    def answer(self, body: bytes | None, now: Nanoseconds) -> Frame | None:
        """Answer the command, or with None go without; return the next command where one has waited."""
        if self._phase is _DevicePhase.WORK:
            if body is None:
                self._rests()
            else:
                self._answer = encode_v1(Frame(ANSWER, body))
                self._say(ANSWER, _DevicePhase.OFFER, now)
        return self._next(now)

    def wake(self, now: Nanoseconds) -> None:
        """Give up a phase that has lasted too long."""
        if self.due <= now:
            self._rests()

    def reset(self) -> None:
        """Forget everything, as at power-on."""
        self._waiting.clear()
        self._sent.clear()
        self._rests()

    def _next(self, now: Nanoseconds) -> Frame | None:
        waiting = self._waiting
        while waiting and self._phase is not _DevicePhase.WORK:
            frame = self._take(waiting.popleft(), now)
            if frame is not None:
                return frame
        return None

    def _take(self, byte: int, now: Nanoseconds) -> Frame | None:
        phase = self._phase
        if phase is _DevicePhase.IDLE:
            # The opcode is judged alone, before the rest is sent: an unknown one costs two bytes.
            if byte in self._known:
                self._rest = Rest(byte)
                self._say(OKAY, _DevicePhase.COMMAND, now)
            else:
                # The opcode alone is refused; the rest of the command was not sent yet.
                self._sent.append(FAILED)
        elif phase is _DevicePhase.COMMAND:
            return self._commanded(now) if self._rest.take(byte) else None
        elif phase is _DevicePhase.OFFER and byte == OKAY:
            self._sent += self._answer[1:]
            self._enter(_DevicePhase.ANSWER, now)
        else:
            # Out of turn: the answer is dropped, as the host has given up the command.
            self._rests()
        return None

    def _commanded(self, now: Nanoseconds) -> Frame | None:
        frame = self._rest.frame()
        if frame is None:
            self._sent.append(FAILED)
            self._rests()
            return None
        if acknowledged(frame):
            self._sent.append(OKAY)
        self._enter(_DevicePhase.WORK, now)
        # The work has no time-out of its own: a gateway may wait 500 ms for its node.
        self.due = NEVER
        return frame

    def _say(self, byte: int, phase: _DevicePhase, now: Nanoseconds) -> None:
        self._sent.append(byte)
        self._enter(phase, now)

    def _enter(self, phase: _DevicePhase, now: Nanoseconds) -> None:
        self._phase = phase
        self.due = now + self._timeout()

    def _rests(self) -> None:
        self._phase = _DevicePhase.IDLE
        self.due = NEVER


class _HostPhase(Enum):
    IDLE = auto()
    OPCODE = auto()
    COMMAND = auto()
    WORK = auto()
    ANSWER = auto()


_ACCEPTING: Final = frozenset({_HostPhase.OPCODE, _HostPhase.COMMAND})


class V1Host(LineEnd):
    """The host's end, one command at a time. Bytes that it does not expect are dropped."""

    def __init__(self, timeout: Nanoseconds, quiet: Nanoseconds = FRAME_TIMEOUT) -> None:
        """Wait `timeout` for each step of the device; it covers the work on a command, too.

        After a failure `ready_at` lies `quiet` ahead: by then the device has given up the old command.
        """
        super().__init__()
        self.ready_at: Nanoseconds = 0
        """Earliest time of the next command."""
        self._timeout = timeout
        self._quiet = quiet
        self._phase = _HostPhase.IDLE
        self._command = b""
        self._answered = self._acknowledged = True
        self._rest = Rest(0)

    @property
    def busy(self) -> bool:
        """True while a command is under way."""
        return self._phase is not _HostPhase.IDLE

    def ask(self, frame: Frame, now: Nanoseconds, *, answered: bool = True) -> None:
        """Begin a command; `answered` by its row for V1. RuntimeError while another is under way."""
        if self.busy:
            raise RuntimeError("the line carries one command at a time")
        self._command = encode_v1(frame)
        self._answered, self._acknowledged = answered, acknowledged(frame)
        self._sent.append(frame.opcode)
        self._enter(_HostPhase.OPCODE, now)

    def receive(self, chunk: bytes, now: Nanoseconds) -> Outcome | None:
        """Take bytes; return how the command ended, once. What follows in the same bytes is dropped."""
        for byte in chunk:
            outcome = self._take(byte, now) if self.busy else None
            if outcome is not None:
                return self._end(outcome, now)
        return None

    def wake(self, now: Nanoseconds) -> Outcome | None:
        """Give up a command that has had no answer in time; silence is a reset's."""
        if self.due > now:
            return None
        # A reset is not acknowledged, so silence after its data is its success.
        done = self._phase is _HostPhase.COMMAND and not self._acknowledged
        return self._end(MaxonAnswer(b"") if done else Failure.SILENCE, now)

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
        # The device repeats nothing, so a garbled answer is lost.
        self._sent.append(FAILED if frame is None else OKAY)
        return Failure.GARBLED if frame is None else MaxonAnswer(frame.body)

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
            if not self._acknowledged:
                self.due = now + RESETS_WITHIN
        elif self._answered:
            self._enter(_HostPhase.WORK, now)
        else:
            return MaxonAnswer(b"")
        return None

    def _enter(self, phase: _HostPhase, now: Nanoseconds) -> None:
        self._phase = phase
        self.due = now + self._timeout

    def _end(self, outcome: Outcome, now: Nanoseconds) -> Outcome:
        self._phase = _HostPhase.IDLE
        self.due = NEVER
        # A refusal leaves the device idle; after anything else it may still be in the middle of a phase.
        clear = isinstance(outcome, MaxonAnswer) or outcome in {Failure.REFUSED, Failure.DAMAGED}
        self.ready_at = now if clear else now + self._quiet
        return outcome
