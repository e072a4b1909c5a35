"""One drive's frames to what it has sent. Frames that make no sense are ignored: a bus is a public place."""

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.cia301 import NODE_MASK, NmtState
from firmware_bridge.canopen_drive.driver.feedback import DriveFeedback
from firmware_bridge.canopen_drive.driver.process_data import (
    POSITION,
    POSITION_COB_ID,
    SAMPLE,
    SAMPLE_COB_ID,
    STATUS,
    STATUS_COB_ID,
)
from firmware_bridge.canopen_drive.driver.product import DriveProduct
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import Axis
from firmware_bridge.units import Nanoseconds


class CanFeedback(DriveFeedback):
    """Filled in from the frames of one drive."""

    def __init__(self, axis: Axis, product: DriveProduct) -> None:
        super().__init__(axis, product)
        self._synchronized_at: Nanoseconds = NEVER_RECEIVED
        self._readers = {
            STATUS_COB_ID: self._status,
            SAMPLE_COB_ID: self._sample,
            POSITION_COB_ID: self._position,
            cia301.EMERGENCY: self._emergency,
            cia301.ERROR_CONTROL: self._heartbeat,
        }

    def synchronized(self, now: Nanoseconds) -> None:
        """Learn that a SYNC left: the next sample was taken then."""
        self._synchronized_at = now

    def receive(self, cob_id: int, payload: bytes, now: Nanoseconds) -> None:
        """Take a frame with this identifier, 11 bits without flags."""
        reader = self._readers.get(cob_id & ~NODE_MASK)
        if reader is not None:
            reader(payload, now)

    def _status(self, payload: bytes, _now: Nanoseconds) -> None:
        if self.expected and len(payload) >= STATUS.size:
            (statusword,) = STATUS.unpack(payload)
            self._state(statusword)

    def _sample(self, payload: bytes, now: Nanoseconds) -> None:
        if not self.expected or len(payload) < SAMPLE.size:
            return
        statusword, counter, current = SAMPLE.unpack(payload)
        self._state(statusword)
        # The first sample has no difference, and one across a new zero would be a jump.
        if self.sampled_at == NEVER_RECEIVED or self.zeroing:
            self.position_counts, self.velocity = counter, 0.0
        else:
            moved = self.moved_to(counter)
            elapsed = self._synchronized_at - self.sampled_at
            if elapsed > 0:
                self.move(moved, elapsed)
            # Added up, as the drive's counter of 32 bits wraps.
            self.position_counts += moved
        if self.between is not None:
            self.passes(counter, now)
        self.current = current
        self.sampled_at = self._synchronized_at
        self.received_at = self.current_at = now

    def _position(self, payload: bytes, now: Nanoseconds) -> None:
        if self.expected and len(payload) >= POSITION.size:
            (counter,) = POSITION.unpack(payload)
            self.passes(counter, now)

    def _state(self, statusword: int) -> None:
        # Process data comes in NMT operational only.
        self.operational = True
        self.state = self.on_statusword(statusword)

    def _emergency(self, payload: bytes, _now: Nanoseconds) -> None:
        message = cia301.decode_emergency(payload)
        if message is not None:
            self.fault = message.code

    def _heartbeat(self, payload: bytes, _now: Nanoseconds) -> None:
        state = cia301.decode_heartbeat(payload)
        if state is None:
            return
        # A heartbeat without Operational: the drive takes no process data and keeps its last target.
        self.operational = state is NmtState.OPERATIONAL
        if not self.operational:
            self.state = None
        if state is NmtState.BOOT_UP:
            self.restart()
            # That is how power-on and reset node end, but reset communication, too: it proves no power off.
            self.unpowered = False
