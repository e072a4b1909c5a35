"""Readings from every drive over a serial line, their periods, and the state in their answers.

A serial line carries one command at a time. Values that safety and odometry depend on are read in every
cycle; the rest takes turns, so that no cycle has more of it than one object.
"""

from dataclasses import dataclass
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import Status
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.driver.feedback import DriveFeedback
from firmware_bridge.canopen_drive.driver.product import DriveProduct
from firmware_bridge.canopen_drive.driver.scale import wrapped
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import Axis
from firmware_bridge.units import Nanoseconds


@dataclass(frozen=True, slots=True)
class ReadRow:
    """One object, read once in so many cycles."""

    address: Address
    type: DataType
    name: str
    every: int = 1
    """Cycles."""
    phase: int = 0
    """The cycle of the first drive's turn."""
    step: int = 0
    """So many cycles later it is the next drive's."""

    def due(self, cycle: int, place: int) -> bool:
        """Return whether the drive at this place, from 0, is read in this cycle."""
        return (cycle - self.phase - place * self.step) % self.every == 0


POSITION: Final = ReadRow(od.POSITION_ACTUAL, DataType.INTEGER32, "position")
STATUSWORD: Final = ReadRow(od.STATUSWORD, DataType.UNSIGNED16, "statusword")
CURRENT: Final = ReadRow(at.CURRENT_AVERAGED, DataType.INTEGER16, "current", every=8, step=2)
ERROR_REGISTER: Final = ReadRow(
    od.ERROR_REGISTER, DataType.UNSIGNED8, "error register", every=20, phase=1, step=2
)

IN_EVERY_CYCLE: Final = (POSITION, STATUSWORD)
"""All drives' positions first, so that they are of nearly one instant; the statuswords are newer."""
IN_TURN: Final = (CURRENT, ERROR_REGISTER)


class SerialFeedback(DriveFeedback):
    """Filled in from the objects of one drive. A sample is whole when both have come in one cycle."""

    def __init__(self, axis: Axis, product: DriveProduct) -> None:
        super().__init__(axis, product)
        self._cycle_at: Nanoseconds = NEVER_RECEIVED
        self._position: tuple[int, Nanoseconds] | None = None
        """This cycle's position, and the time of its request."""
        self._before: tuple[int, Nanoseconds] | None = None
        """The same of the sample before, counted on across the counter's wrap."""

    def begin(self, now: Nanoseconds) -> None:
        """Begin a cycle: what is read from now on makes a new sample."""
        self._cycle_at = now
        self._position = None

    def position_read(self, counter: int, requested_at: Nanoseconds) -> None:
        """Take the position. The drive read it at the request, whenever this machine's port delivered it."""
        self._position = counter, requested_at

    def statusword_read(self, word: int, now: Nanoseconds) -> None:
        """Take the statusword, and with this cycle's position the sample.

        A drive that is not remote any more after it was has restarted: only then it leaves NMT operational
        without our command (EPOS Firmware Specification, statusword bit 9).
        """
        remote = bool(word & Status.REMOTE)
        # NMT operational ends without our command only by a restart (Statusword bit 9).
        if self.expected and self.operational and not remote:
            self.restart()
        self.operational = remote
        state = self.on_statusword(word)
        self.state = state if remote else None
        if self._position is not None and self.expected:
            self._sample(*self._position, now)

    def forget_motion(self) -> None:
        """Count again from the next sample on."""
        super().forget_motion()
        self._before = None

    def lose(self) -> None:
        """Forget the state: the line is gone, and whatever the drive does now, it does by itself."""
        self.state, self.operational = None, False
        self.expected = self.unpowered = False
        self.forget_motion()

    def _sample(self, counter: int, requested_at: Nanoseconds, now: Nanoseconds) -> None:
        """Take a whole sample, and shift it to the begin of the cycle: to the same instant for all drives.

        Two wheels that are read one after the other would look like a robot that turns a little.
        """
        position, shift = counter, 0
        if self.zeroing:
            self._before, self.velocity = None, 0.0
        if self._before is not None:
            before, before_at = self._before
            moved = wrapped(counter - before)
            position = before + moved
            elapsed = max(requested_at - before_at, 1)
            self.move(moved, elapsed)
            # By its speed back to the cycle's begin, the common instant of all drives.
            shift = round(moved * (requested_at - self._cycle_at) / elapsed)
        self._before = position, requested_at
        self.position_counts = position - shift
        self.sampled_at = self._cycle_at
        self.received_at = now
