"""V1 on RS232, the drive's end: commands come out of the bytes, answers go in. See `v1` for the handshake."""

from collections import deque
from collections.abc import Callable, Container
from enum import Enum, auto

from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.maxon.end import LineEnd
from firmware_bridge.wire.maxon.frame import ANSWER, Frame, encode_v1
from firmware_bridge.wire.maxon.opcodes import COMMANDS
from firmware_bridge.wire.maxon.v1 import FAILED, OKAY, ROOM, Rest


class _DevicePhase(Enum):
    IDLE = auto()
    COMMAND = auto()
    WORK = auto()
    OFFER = auto()
    ANSWER = auto()


class V1Device(LineEnd):
    """The drive's end. `hear` returns a command, and each command wants one call of `answer`."""

    def __init__(self, timeout: Callable[[], Nanoseconds], known: Container[int] = COMMANDS) -> None:
        """Take the time of a phase from `timeout` each time one begins."""
        super().__init__()
        self._timeout = timeout
        self._known = known
        self._phase = _DevicePhase.IDLE
        self._rest = Rest(0)
        self._answer = b""
        self._waiting: deque[int] = deque()

    def hear(self, chunk: bytes, now: Nanoseconds) -> Frame | None:
        """Take bytes; return the command that they complete, if any."""
        self.wake(now)
        free = self._phase is not _DevicePhase.WORK
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
            if byte in self._known:
                self._rest = Rest(byte)
                self._say(OKAY, _DevicePhase.COMMAND, now)
            else:
                self._sent.append(FAILED)
        elif phase is _DevicePhase.COMMAND:
            return self._commanded(now) if self._rest.take(byte) else None
        elif phase is _DevicePhase.OFFER and byte == OKAY:
            self._sent += self._answer[1:]
            self._enter(_DevicePhase.ANSWER, now)
        else:
            self._rests()
        return None

    def _commanded(self, now: Nanoseconds) -> Frame | None:
        frame = self._rest.frame()
        if frame is None:
            self._sent.append(FAILED)
            self._rests()
            return None
        self._say(OKAY, _DevicePhase.WORK, now)
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
