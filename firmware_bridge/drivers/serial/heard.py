"""What one drive tells over a serial line, read object by object in every cycle."""

from typing import Final

from firmware_bridge.drivers.drive import Heard
from firmware_bridge.intent import NEVER_HEARD
from firmware_bridge.robot import Axis
from firmware_bridge.units import Nanoseconds, to_seconds
from firmware_bridge.wire.cia402 import State, Status, state_of

_COUNTER_SPAN: Final = 1 << 32
_COUNTER_HALF: Final = 1 << 31
FAULT_STATES: Final = (State.FAULT, State.FAULT_REACTION_DISABLED, State.FAULT_REACTION_ENABLED)


class SerialEar:
    """Fills a `Heard` from the objects of one drive. A sample is whole when both have come in one cycle."""

    __slots__ = ("_before", "_cycle_at", "_position", "_qc_per_radian", "heard", "knows_mapping")

    def __init__(self, axis: Axis) -> None:
        self.heard = Heard()
        self.knows_mapping = False
        self._qc_per_radian = axis.quadcounts_per_radian
        self._cycle_at: Nanoseconds = NEVER_HEARD
        self._position: tuple[int, Nanoseconds] | None = None
        """What this cycle has read, and when it was asked for."""
        self._before: tuple[int, Nanoseconds] | None = None
        """The same of the sample before."""

    def begin(self, now: Nanoseconds) -> None:
        """Begin a cycle: what is read from now on makes a new sample."""
        self._cycle_at = now
        self._position = None

    def position(self, quadcounts: int, asked_at: Nanoseconds) -> None:
        """Take the position. The drive read it when it was asked, whenever this machine's port told of it."""
        self._position = quadcounts, asked_at

    def statusword(self, word: int, now: Nanoseconds) -> None:
        """Take the statusword, and with this cycle's position the sample.

        A drive that is not remote any more after it was has restarted: only then it leaves NMT operational
        without our command (EPOS Firmware Specification, statusword bit 9).
        """
        heard = self.heard
        remote = bool(word & Status.REMOTE)
        if self.knows_mapping and heard.operational and not remote:
            heard.restarted = True
            self.knows_mapping = False
            heard.sampled_at, self._before = NEVER_HEARD, None
            heard.speed_rad_s = 0.0
        heard.operational = remote
        heard.statusword = word
        heard.state = state_of(word) if remote else None
        if self._position is not None and self.knows_mapping:
            self._sample(*self._position, now)

    def lose(self) -> None:
        """Forget the state: the line is gone, and whatever the drive does now, it does by itself."""
        heard = self.heard
        heard.state, heard.operational = None, False
        heard.speed_rad_s = 0.0
        heard.sampled_at, self._before = NEVER_HEARD, None
        self.knows_mapping = False

    def _sample(self, position: int, asked_at: Nanoseconds, now: Nanoseconds) -> None:
        """Take a whole sample, and shift it to the begin of the cycle: to the same instant for all drives.

        Two wheels that are read one after the other would look like a robot that turns a little.
        """
        heard, shift = self.heard, 0
        if self._before is not None:
            before, before_at = self._before
            # The drive's counter has 32 bits and wraps.
            moved = (position - before + _COUNTER_HALF) % _COUNTER_SPAN - _COUNTER_HALF
            elapsed = max(asked_at - before_at, 1)
            heard.speed_rad_s = moved / self._qc_per_radian / to_seconds(elapsed)
            shift = round(moved * (asked_at - self._cycle_at) / elapsed)
        self._before = position, asked_at
        heard.position_qc = (position - shift + _COUNTER_HALF) % _COUNTER_SPAN - _COUNTER_HALF
        heard.sampled_at = self._cycle_at
        heard.heard_at = now
