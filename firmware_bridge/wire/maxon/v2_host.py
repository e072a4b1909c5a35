"""V2 on USB, the host's end: a command goes in, its outcome comes out. See `v2` for the frames."""

from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.maxon.end import LineEnd
from firmware_bridge.wire.maxon.frame import ANSWER, Answered, Failure, Frame, Outcome, encode_v2
from firmware_bridge.wire.maxon.v2 import Damaged, Reader


class V2Host(LineEnd):
    """The host's end, one command at a time. What it does not wait for, it does not hear."""

    def __init__(self, timeout: Nanoseconds, quiet: Nanoseconds = 0) -> None:
        """Wait `timeout` for an answer.

        Answers carry no number: one that comes too late would be taken for that of the next command. So
        `timeout` must be longer than the device ever takes, or `ready_at` must lie `quiet` behind a failure.
        """
        super().__init__()
        self.ready_at: Nanoseconds = 0
        """From when on a command may be asked."""
        self._timeout = timeout
        self._quiet = quiet
        self._reader = Reader()
        self._busy = False

    @property
    def busy(self) -> bool:
        """Whether a command is under way."""
        return self._busy

    def ask(self, frame: Frame, now: Nanoseconds, *, answered: bool = True) -> None:
        """Begin a command; V2 answers each. RuntimeError while another is under way."""
        if self._busy:
            raise RuntimeError("the line carries one command at a time")
        del answered
        self._reader.reset()
        self._busy = True
        self._sent += encode_v2(frame)
        self.due = now + self._timeout

    def hear(self, chunk: bytes, now: Nanoseconds) -> Outcome | None:
        """Take bytes; return how the command ended, once. What follows in the same bytes is dropped."""
        for byte in chunk if self._busy else b"":
            frame = self._reader.take(byte)
            if isinstance(frame, Damaged):
                return self._end(Failure.GARBLED, now)
            if frame is not None and frame.opcode == ANSWER:
                return self._end(Answered(frame.body), now)
        return None

    def wake(self, now: Nanoseconds) -> Outcome | None:
        """Give up a command that has had no answer in time."""
        return self._end(Failure.SILENCE, now) if self.due <= now else None

    def _end(self, outcome: Outcome, now: Nanoseconds) -> Outcome:
        self._busy = False
        self.due = NEVER
        self.ready_at = now if isinstance(outcome, Answered) else now + self._quiet
        return outcome
