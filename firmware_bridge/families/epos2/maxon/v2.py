"""V2 on USB, both ends: frames that begin with DLE STX, at any point, and double each DLE after.

Source: EPOS2 Application Notes Collection, April 2013, p. 11-164; EPOS4 Communication Guide (same link layer,
by analogy). Where they are silent:

* A DLE before anything else ends the frame, and so does a length above 143 words: both hunt for DLE STX.
* The time-out runs from DLE STX to the last byte of the frame. What it ends is not answered.
* A frame cut off just behind a DLE swallows the next one, which begins with a DLE; the time-out parts them.
* Bytes that arrive while the device works on a command wait, up to `ROOM` of them, and count afterwards.
"""

from collections import deque
from collections.abc import Callable
from enum import Enum, auto
from typing import Final

from firmware_bridge.families.epos2.maxon.end import LineEnd
from firmware_bridge.families.epos2.maxon.frame import (
    ANSWER,
    CHECKSUM_SIZE,
    DLE,
    MOST_WORDS,
    STX,
    Failure,
    Frame,
    MaxonAnswer,
    Outcome,
    checksum,
    encode_v2,
)
from firmware_bridge.families.epos2.maxon.opcodes import RESETS_WITHIN, acknowledged
from firmware_bridge.units import NEVER, Nanoseconds

ROOM: Final = 1024
_HEAD: Final = 2


class Damaged(Enum):
    """A whole frame whose check sum is wrong."""

    DAMAGED = auto()


class FrameReader:
    """Finds frames among bytes, whatever stands between them."""

    def __init__(self) -> None:
        self.begun = 0
        """Count of the frames begun so far."""
        self._escaped = False
        self._open = False
        self._taken = bytearray()

    @property
    def inside(self) -> bool:
        """True while a frame has begun and not ended."""
        return self._open

    def reset(self) -> None:
        """Forget a frame that has begun."""
        self._escaped = self._open = False

    def take(self, byte: int) -> Frame | Damaged | None:
        """Take a byte; return the frame that it completes."""
        if self._escaped:
            if byte == STX:
                self._escaped, self._open = False, True
                self._taken.clear()
                self.begun += 1
                return None
            if byte != DLE:
                self.reset()
                return None
            if not self._open:
                return None  # outside a frame the second DLE may begin one
            self._escaped = False
        elif byte == DLE:
            self._escaped = True
            return None
        return self._append(byte) if self._open else None

    def _append(self, byte: int) -> Frame | Damaged | None:
        taken = self._taken
        taken.append(byte)
        if len(taken) < _HEAD:
            return None
        if taken[1] > MOST_WORDS:
            self.reset()
            return None
        if len(taken) < _HEAD + 2 * taken[1] + CHECKSUM_SIZE:
            return None
        self.reset()
        body = bytes(taken[_HEAD:-CHECKSUM_SIZE])
        sent = int.from_bytes(taken[-CHECKSUM_SIZE:], "little")
        # Over length and opcode as one word, without the doubled bytes.
        if checksum(taken[1] << 8 | taken[0], body) != sent:
            return Damaged.DAMAGED
        return Frame(taken[0], body)


class V2Device(LineEnd):
    """The drive's end. `receive` returns a command, and each command needs one call of `answer`."""

    def __init__(self, timeout: Callable[[], Nanoseconds], bad_checksum: int) -> None:
        """Answer damaged frames with this error code; take the time of a frame from `timeout`."""
        super().__init__()
        self._timeout = timeout
        self._complaint = encode_v2(Frame(ANSWER, bad_checksum.to_bytes(4, "little")))
        self._reader = FrameReader()
        self._working = False
        self._waiting: deque[int] = deque()

    @property
    def idle(self) -> bool:
        """True while no command is under way, nor has one begun."""
        return not self._working and not self._reader.inside

    def receive(self, chunk: bytes, now: Nanoseconds) -> Frame | None:
        """Take bytes; return the command that they complete, if any; as in V1, one ends by `wake` alone."""
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
            # The time runs per frame, from DLE STX on, and not per byte.
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


class V2Host(LineEnd):
    """The host's end, one command at a time. Frames that it does not expect are dropped."""

    def __init__(self, timeout: Nanoseconds, quiet: Nanoseconds = 0) -> None:
        """Wait `timeout` for an answer.

        Answers carry no number: one that comes too late would be taken for that of the next command. So
        `timeout` must be longer than the device ever takes, or `ready_at` must lie `quiet` behind a failure.
        """
        super().__init__()
        self.ready_at: Nanoseconds = 0
        """Earliest time of the next command."""
        self._timeout = timeout
        self._quiet = quiet
        self._reader = FrameReader()
        self._busy = False
        self._acknowledged = True

    @property
    def busy(self) -> bool:
        """True while a command is under way."""
        return self._busy

    def ask(self, frame: Frame, now: Nanoseconds, *, answered: bool = True) -> None:
        """Begin a command; V2 answers each but resets. RuntimeError while another is under way."""
        if self._busy:
            raise RuntimeError("the line carries one command at a time")
        del answered
        # A late answer to the command before must not be taken for the one to this.
        self._reader.reset()
        self._busy = True
        self._acknowledged = acknowledged(frame)
        self._sent += encode_v2(frame)
        # A reset is not answered: its silence is success after a short time.
        self.due = now + (self._timeout if self._acknowledged else RESETS_WITHIN)

    def receive(self, chunk: bytes, now: Nanoseconds) -> Outcome | None:
        """Take bytes; return how the command ended, once. What follows in the same bytes is dropped."""
        for byte in chunk if self._busy else b"":
            frame = self._reader.take(byte)
            if isinstance(frame, Damaged):
                return self._end(Failure.GARBLED, now)
            if frame is not None and frame.opcode == ANSWER:
                return self._end(MaxonAnswer(frame.body), now)
        return None

    def wake(self, now: Nanoseconds) -> Outcome | None:
        """Give up a command that has had no answer in time; silence is a reset's."""
        if self.due > now:
            return None
        return self._end(Failure.SILENCE if self._acknowledged else MaxonAnswer(b""), now)

    def _end(self, outcome: Outcome, now: Nanoseconds) -> Outcome:
        self._busy = False
        self.due = NEVER
        self.ready_at = now if isinstance(outcome, MaxonAnswer) else now + self._quiet
        return outcome
