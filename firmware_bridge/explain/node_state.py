"""One node as the frames of a recording show it, and the regularity of what comes again and again."""

from collections import deque
from dataclasses import dataclass, field
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.explain.drive_state import DriveState
from firmware_bridge.explain.motion import MotionWatch
from firmware_bridge.units import MILLISECOND, Nanoseconds

GAPS: Final = 8
"""Number of intervals that make a period, and that are compared with it."""
SHORTEST: Final[Nanoseconds] = MILLISECOND
"""Frames that come closer have waited somewhere together."""
REGULAR: Final = 1.5
"""Longest by shortest interval of what is sent by a clock."""
TOO_OFTEN: Final = 0.65
"""Mean interval by period of what two nodes send."""
USUAL: Final = (0.8, 1.25)
"""An interval by the period that is as usual."""


@dataclass(slots=True)
class Rhythm:
    """The period of a message, as its first intervals show it."""

    last_at: Nanoseconds | None = None
    period: Nanoseconds | None = None
    """None until it is known."""
    gaps: deque[Nanoseconds] = field(default_factory=lambda: deque(maxlen=GAPS))
    excess: float = 0.0
    """Messages more than its period allows; negative after a silence, until what has waited is there."""

    def take(self, at: Nanoseconds) -> Nanoseconds:
        """Take a message; return the interval before it, 0 for the first one."""
        last, self.last_at = self.last_at, at
        if last is None:
            return 0
        gap = at - last
        if self.period is not None:
            self._balance(gap, self.period)
        if gap >= SHORTEST:
            self.gaps.append(gap)
            if self.period is None and len(self.gaps) == GAPS and max(self.gaps) <= REGULAR * min(self.gaps):
                self.period = sorted(self.gaps)[GAPS // 2]
        return gap

    def overdue(self, now: Nanoseconds, periods: float) -> bool:
        """Return whether the next message is missing for more than so many periods."""
        return (
            self.period is not None
            and self.last_at is not None
            and now - self.last_at > periods * self.period
        )

    @property
    def doubled(self) -> bool:
        """Whether it comes much more often than its period."""
        if self.period is None or len(self.gaps) < GAPS or self.excess < GAPS / 2:
            return False
        return sum(self.gaps) < TOO_OFTEN * GAPS * self.period

    def _balance(self, gap: Nanoseconds, period: Nanoseconds) -> None:
        before = self.gaps[-1] if self.gaps else 0
        self.excess += 1 - gap / period
        # Two usual intervals, one after the other, are of one sender.
        if all(USUAL[0] * period < one < USUAL[1] * period for one in (gap, before)):
            self.excess /= 2

    def restart(self) -> None:
        """Begin again: the next interval is none."""
        self.last_at = None
        self.gaps.clear()
        self.excess = 0.0

    def set(self, period: Nanoseconds) -> None:
        """Take a period that was configured; 0: it is not sent any more."""
        self.period = period or None
        self.gaps.clear()
        self.excess = 0.0
        if not period:
            self.last_at = None


@dataclass(slots=True)
class Request:
    """An SDO request that waits for its answer."""

    at: Nanoseconds
    address: int
    payload: bytes
    target: Address
    write: bool
    stopped: bool
    """Whether its node was in the NMT state stopped."""


@dataclass(slots=True)
class NodeState:
    """One node."""

    node: int
    drive: DriveState
    motion: MotionWatch
    sent: int = 0
    """Number of its frames, boot-up messages aside."""
    booted: bool = False
    addressed: int = 0
    """Number of frames to it alone."""
    first_to: tuple[Nanoseconds, int, bytes] | None = None
    network: NmtState | None = None
    reset_at: Nanoseconds | None = None
    """Of a reset command that its boot-up message will answer."""
    beats: Rhythm = field(default_factory=Rhythm)
    beat: bytes = b""
    silent: bool = False
    sent_at: Nanoseconds = 0
    request: Request | None = None
    answered: Request | None = None
    """The last request that was answered."""
    status_raw: int = -1
    left_at: Nanoseconds = 0
    """When it left operation enabled."""
    emergency_at: Nanoseconds | None = None
    in_vain_since: Nanoseconds | None = None
    """Of set-points that it does not take: the first and the last."""
    in_vain_at: Nanoseconds = 0

    @classmethod
    def of(cls, node: int) -> "NodeState":
        """Return a node of which nothing was seen."""
        drive = DriveState(node)
        return cls(node, drive, MotionWatch(drive))

    @property
    def seen(self) -> bool:
        """Whether it ever sent a frame."""
        return self.booted or self.sent > 0

    def address(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take a frame to this node alone."""
        if not self.addressed:
            self.first_to = (at, address, payload)
        self.addressed += 1
