"""The queue of commands to a board, the most urgent first: motion, requests of a cycle, a task's commands."""

from collections import deque
from collections.abc import Iterable
from enum import Enum
from typing import Final

from firmware_bridge.families.motor_shield.driver.dialects import BoardMessage


class Part(Enum):
    """Part of the queue that a command belongs to, the most urgent first."""

    MOTION = "what the motors shall do"
    SAMPLE = "the questions of a cycle"
    TASK = "set-up, and the way to no power"


class Waiting:
    """The commands to one board."""

    def __init__(self) -> None:
        self.part = Part.TASK
        """Part of the newest command."""
        self.motion: Final[deque[BoardMessage]] = deque()
        self.samples: Final[deque[BoardMessage]] = deque()
        self._script: deque[BoardMessage] = deque()
        self._next: BoardMessage | None = None

    @property
    def urgent(self) -> bool:
        """True where a command waits that is no task's."""
        return bool(self.motion or self.samples)

    @property
    def scripted(self) -> bool:
        """True where a task's command waits."""
        return self._next is not None

    @property
    def last(self) -> bool:
        """True where a task's last command waits: all before it was sent, and answered where requested."""
        return self._next is not None and not self._script

    def begin(self, script: Iterable[BoardMessage]) -> None:
        """Put a task's commands into the queue; the first is reached by `advance`."""
        self._script, self._next = deque(script), None

    def advance(self) -> bool:
        """Go on to a task's next command; return whether there is one."""
        self._next = self._script.popleft() if self._script else None
        return self._next is not None

    def again(self, say: BoardMessage) -> None:
        """Put a task's command into the queue once more."""
        self._next = say

    def later(self, say: BoardMessage) -> None:
        """Put a task's command into the queue once more, behind those that are left."""
        self._script.append(say)
        self._next = self._script.popleft()

    def end(self) -> None:
        """Say nothing more of a task; an answer to its question that is under way is no task's any more."""
        self._script.clear()
        self._next = None
        if self.part is Part.TASK:
            self.part = Part.MOTION

    def drop(self) -> None:
        """Forget what is no task's."""
        self.motion.clear()
        self.samples.clear()

    def take(self, *, quiet: bool) -> BoardMessage | None:
        """Return the next command; none of a task while it is to be `quiet`."""
        for part, waiting in ((Part.MOTION, self.motion), (Part.SAMPLE, self.samples)):
            if waiting:
                self.part = part
                return waiting.popleft()
        if quiet or self._next is None:
            return None
        self.part = Part.TASK
        say, self._next = self._next, None
        return say
