"""One EPOS2's frames to what it told. Frames that make no sense are ignored: a bus is a public place."""

from typing import Final

from firmware_bridge.drivers.drive import Heard
from firmware_bridge.drivers.epos2_pdo import SAMPLE, SAMPLE_COB_ID, STATUS, STATUS_COB_ID
from firmware_bridge.intent import NEVER_HEARD
from firmware_bridge.robot import Axis
from firmware_bridge.units import Nanoseconds, to_seconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.canopen import NODE_MASK, NmtState
from firmware_bridge.wire.cia402 import state_of

_COUNTER_SPAN: Final = 1 << 32
_COUNTER_HALF: Final = 1 << 31


class Ear:
    """Fills a `Heard` from the frames of one drive."""

    __slots__ = ("_quadcounts_per_radian", "_readers", "_synchronised_at", "heard", "knows_mapping")

    def __init__(self, axis: Axis) -> None:
        self.heard = Heard()
        self.knows_mapping = False
        """Process data counts only once this bridge has said what it carries."""
        self._quadcounts_per_radian = axis.quadcounts_per_radian
        self._synchronised_at: Nanoseconds = NEVER_HEARD
        self._readers = {
            STATUS_COB_ID: self._status,
            SAMPLE_COB_ID: self._sample,
            canopen.EMERGENCY: self._emergency,
            canopen.ERROR_CONTROL: self._heartbeat,
        }

    def synchronised(self, now: Nanoseconds) -> None:
        """Learn that a SYNC left: the next sample was taken then."""
        self._synchronised_at = now

    def hear(self, cob_id: int, payload: bytes, now: Nanoseconds) -> None:
        """Take a frame with this identifier, 11 bits without flags."""
        reader = self._readers.get(cob_id & ~NODE_MASK)
        if reader is not None:
            reader(payload, now)

    def _status(self, payload: bytes, _now: Nanoseconds) -> None:
        if self.knows_mapping and len(payload) >= STATUS.size:
            (statusword,) = STATUS.unpack(payload)
            self._state(statusword)

    def _sample(self, payload: bytes, now: Nanoseconds) -> None:
        if not self.knows_mapping or len(payload) < SAMPLE.size:
            return
        heard = self.heard
        statusword, position, current = SAMPLE.unpack(payload)
        self._state(statusword)
        elapsed = self._synchronised_at - heard.sampled_at
        if heard.sampled_at != NEVER_HEARD and elapsed > 0:
            # The drive's counter has 32 bits and wraps.
            moved = (position - heard.position_qc + _COUNTER_HALF) % _COUNTER_SPAN - _COUNTER_HALF
            heard.speed_rad_s = moved / self._quadcounts_per_radian / to_seconds(elapsed)
        heard.position_qc = position
        heard.current_ma = current
        heard.sampled_at = self._synchronised_at
        heard.heard_at = now

    def _state(self, statusword: int) -> None:
        # Process data comes in NMT operational only.
        self.heard.operational = True
        self.heard.statusword = statusword
        self.heard.state = state_of(statusword)

    def _emergency(self, payload: bytes, _now: Nanoseconds) -> None:
        message = canopen.decode_emergency(payload)
        if message is not None:
            self.heard.fault = message.code

    def _heartbeat(self, payload: bytes, _now: Nanoseconds) -> None:
        state = canopen.decode_heartbeat(payload)
        if state is None:
            return
        heard = self.heard
        heard.operational = state is NmtState.OPERATIONAL
        if not heard.operational:
            heard.state = None
        if state is NmtState.BOOT_UP:
            heard.restarted = True
            self.knows_mapping = False
            # The counter starts from zero again: no speed from before to after.
            heard.sampled_at = NEVER_HEARD
            heard.speed_rad_s = 0.0
