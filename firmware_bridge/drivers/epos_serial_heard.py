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

    __slots__ = ("_cycle_at", "_position", "_qc_per_radian", "_read_at", "heard", "knows_mapping")

    def __init__(self, axis: Axis) -> None:
        self.heard = Heard()
        self.knows_mapping = False
        self._qc_per_radian = axis.quadcounts_per_radian
        self._cycle_at: Nanoseconds = NEVER_HEARD
        self._position: tuple[int, Nanoseconds] | None = None
        """What this cycle has read, and when."""
        self._read_at: Nanoseconds = NEVER_HEARD
        """When the position that is heard was read."""

    def begin(self, now: Nanoseconds) -> None:
        """Begin a cycle: what is read from now on makes a new sample."""
        self._cycle_at = now
        self._position = None

    def position(self, quadcounts: int, now: Nanoseconds) -> None:
        """Take the position."""
        self._position = quadcounts, now

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
            heard.sampled_at = self._read_at = NEVER_HEARD
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
        heard.sampled_at = self._read_at = NEVER_HEARD
        self.knows_mapping = False

    def _sample(self, position: int, read_at: Nanoseconds, now: Nanoseconds) -> None:
        heard = self.heard
        elapsed = read_at - self._read_at
        if self._read_at != NEVER_HEARD and elapsed > 0:
            # The drive's counter has 32 bits and wraps.
            moved = (position - heard.position_qc + _COUNTER_HALF) % _COUNTER_SPAN - _COUNTER_HALF
            heard.speed_rad_s = moved / self._qc_per_radian / to_seconds(elapsed)
        heard.position_qc = position
        heard.sampled_at = self._cycle_at
        heard.heard_at = now
        self._read_at = read_at
