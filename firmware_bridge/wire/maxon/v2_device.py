"""V2 on USB, the drive's end: commands come out of the bytes, answers go in. See `v2` for the frames."""

from collections import deque
from collections.abc import Callable

from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.maxon.end import LineEnd
from firmware_bridge.wire.maxon.frame import ANSWER, Frame, encode_v2
from firmware_bridge.wire.maxon.v2 import ROOM, Reader


class V2Device(LineEnd):
    """The drive's end. `hear` returns a command, and each command wants one call of `answer`."""

    def __init__(self, timeout: Callable[[], Nanoseconds], bad_checksum: int) -> None:
        """Answer damaged frames with this error code; take the time of a frame from `timeout`."""
        super().__init__()
        self._timeout = timeout
        self._complaint = encode_v2(Frame(ANSWER, bad_checksum.to_bytes(4, "little")))
        self._reader = Reader()
        self._working = False
        self._waiting: deque[int] = deque()

    def hear(self, chunk: bytes, now: Nanoseconds) -> Frame | None:
        """Take bytes; return the command that they complete, if any."""
        self.wake(now)
        free = not self._working
        self._waiting.extend(chunk if free else chunk[: max(ROOM - len(self._waiting), 0)])
        return self._next(now)

    def answer(self, body: bytes | None, now: Nanoseconds) -> Frame | None:
        """Answer the command, or with None go without; return the next command where one has waited."""
        if self._working:
            self._working = False
            if body is not None:
                self._sent += encode_v2(Frame(ANSWER, body))
        return self._next(now)

    def wake(self, now: Nanoseconds) -> None:
        """Give up a frame that has lasted too long."""
        if self.due <= now:
            self.due = NEVER
            self._reader.reset()

    def reset(self) -> None:
        """Forget everything, as at power-on."""
        self._reader.reset()
        self._working = False
        self._waiting.clear()
        self._sent.clear()
        self.due = NEVER

    def _next(self, now: Nanoseconds) -> Frame | None:
        waiting, reader = self._waiting, self._reader
        while waiting and not self._working:
            begun = reader.begun
            frame = reader.take(waiting.popleft())
            if not reader.inside:
                self.due = NEVER
            elif reader.begun != begun:
                self.due = now + self._timeout()
            if isinstance(frame, Frame):
                self._working = True
                return frame
            if frame is not None:
                self._sent += self._complaint
        return None
