"""Interpolated position mode: runs a path through position, velocity and time, record by record.

Source: application note Interpolation Position Mode, December 2008. Where it is silent:
* the path begins with a rising edge of bit 4, outside a halt, and with each controlword that is written with
  it by SDO or a serial command where none runs: maxon's command library never lowers the bit (recorded);
* halt, or bit 4 going down, brakes with 0x6084, drops the records and ends the path: one that went on later
  would begin with a jump;
* a full buffer is a fault only in this mode;
* a segment that is too fast, too sharp or leads out of 0x607D is not begun: the drive stops there;
* a first record away from the position demand is a velocity of that way in 1 ms;
* where the last record's velocity is not 0 the axis brakes with 0x6084 from there on.
"""

from typing import ClassVar, Final

from emulators.drive.mode import ModeOfOperation
from emulators.drive.shaft import Shaft
from emulators.epos2.modes.interpolation_buffer import BufferStatus, InterpolationBuffer
from emulators.servo import spline
from emulators.servo.axis import SPLINE
from emulators.servo.scaling import speed_units
from emulators.servo.spline import Knot, SplineSegment
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import ControlwordBit, Status
from firmware_bridge.families.epos2.wire import emergency
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.families.epos2.wire.pvt import PvtRecord

_ENABLE: Final = int(ControlwordBit.ENABLE_INTERPOLATION)
_ACTIVE: Final = int(Status.INTERPOLATION_ACTIVE)
_FEWEST: Final = 2
"""Records that a segment needs."""


class InterpolatedPosition(ModeOfOperation):
    """Mode that follows the records of 0x20C1."""

    heeds_halt: ClassVar[bool] = True
    goes_by_writes: ClassVar[bool] = True

    def __init__(self, shaft: Shaft) -> None:
        super().__init__(shaft)
        self._buffer = InterpolationBuffer(shaft.store, self._overflowed)
        self._done = 0
        """Segments of the axis that have been seen to end."""

    def restart(self) -> None:
        """Begin as after power-on."""
        self._buffer.restart()

    def forget(self) -> None:
        """Drop the path that was going on; what was filled in beforehand stays."""
        if self._buffer.active:
            self._buffer.records.clear()
            self._buffer.end()

    def status(self, *, failed: bool) -> int:
        """Bit 12: interpolated position mode active."""
        del failed
        return _ACTIVE if self._buffer.active else 0

    @property
    def arrived(self) -> bool:
        """Bit 10: the path is over, or the halt has come to its end."""
        return self.shaft.arrived and not self._buffer.active

    def halt(self) -> None:
        """Bit 8 has come up."""
        self.forget()
        super().halt()

    def controls(self, word: int, before: int) -> bool:
        """Bit 4 lets the path run."""
        if not word & _ENABLE:
            if self._buffer.active:
                self.halt()
        elif not before & _ENABLE and not self.shaft.halted and not self._buffer.active:
            self._start()
        return False

    def advance(self) -> None:
        """Count the segments that are over, and keep the axis supplied."""
        buffer, axis = self._buffer, self.shaft.axis
        while buffer.active and self._done != axis.splines_done:
            self._done += 1
            del buffer.records[:1]
            self._next()
        if buffer.active and len(buffer.records) < _FEWEST:
            self._fail(BufferStatus.UNDERFLOW_ERROR)
        # One segment in advance: the axis goes on within its ms, however late this code is called.
        if buffer.active and axis.next_ms == 0:
            self._prepare()

    def _start(self) -> None:
        buffer, axis = self._buffer, self.shaft.axis
        if len(buffer.records) < _FEWEST:
            self._fail(BufferStatus.UNDERFLOW_ERROR)
            return
        first = self._knot(buffer.records[0])
        # Velocity units are demand units per ms: the jump is the velocity of its 1 ms.
        jump = first.position - axis.position_demand
        if abs(jump) > self.shaft.fastest():
            self._fail(BufferStatus.VELOCITY_ERROR)
        elif abs(jump + first.velocity - axis.velocity_demand) > self.shaft.acceleration(od.MAX_ACCELERATION):
            self._fail(BufferStatus.ACCELERATION_ERROR)
        else:
            buffer.active = True
            self._done = axis.splines_done
            self._next()
            self._prepare()

    def _next(self) -> None:
        """Go on from the knot that the first record now is."""
        buffer, axis = self._buffer, self.shaft.axis
        if buffer.records and buffer.records[0].ms == 0:
            self._finish()
        elif len(buffer.records) >= _FEWEST:
            present = self._segment(0)
            # A segment that was prepared has been begun by the axis; it must not start a second time.
            if self._admitted(present) and (axis.profile != SPLINE or axis.spline_ms == 0):
                spline.begin(axis, present)

    def _finish(self) -> None:
        """End the path at its last record."""
        last = self._buffer.records.pop(0)
        self._buffer.end()
        if last.velocity:
            self.shaft.brake()

    def _prepare(self) -> None:
        """Give the axis the segment after the present one, where there is one to which nothing objects."""
        records = self._buffer.records
        # Time 0 marks the last record: no segment begins there.
        if not self._buffer.active or len(records) <= _FEWEST or records[1].ms == 0:
            return
        following = self._segment(1)
        if not self._beyond(following) and not self._error(following):
            spline.prepare(self.shaft.axis, following)

    def _admitted(self, present: SplineSegment) -> bool:
        """Look at the segment that is to run now: fail with its error, or note its warnings."""
        if self._beyond(present):
            # 0x20C4:1 has no bit for the position limits: the emergency FF09 alone gives the cause.
            self._buffer.fail(BufferStatus(0))
            self.shaft.error = emergency.POSITION_LIMIT
            return False
        error = self._error(present)
        if error:
            self._fail(error)
            return False
        shaft, warnings = self.shaft, BufferStatus(0)
        if present.fastest() > speed_units(shaft.axis, shaft.store.get(od.PROFILE_VELOCITY)):
            warnings |= BufferStatus.VELOCITY_WARNING
        if present.sharpest() > shaft.acceleration(od.PROFILE_ACCELERATION):
            warnings |= BufferStatus.ACCELERATION_WARNING
        self._buffer.warnings = warnings
        return True

    def _error(self, segment: SplineSegment) -> BufferStatus:
        if segment.fastest() > self.shaft.fastest():
            return BufferStatus.VELOCITY_ERROR
        if segment.sharpest() > self.shaft.acceleration(od.MAX_ACCELERATION):
            return BufferStatus.ACCELERATION_ERROR
        return BufferStatus(0)

    def _beyond(self, segment: SplineSegment) -> bool:
        """Return True if a segment ends outside the software position limits."""
        low, high = self.shaft.limits()
        # The cubic at t = T, where each power of t/T is 1.
        end = segment.start + segment.linear + segment.square + segment.cube
        return not low <= end >> self.shaft.axis.fraction <= high

    def _knot(self, record: PvtRecord) -> Knot:
        axis = self.shaft.axis
        return Knot(record.position << axis.fraction, speed_units(axis, record.velocity))

    def _segment(self, first: int) -> SplineSegment:
        start, end = self._buffer.records[first : first + 2]
        return spline.segment(self._knot(start), self._knot(end), start.ms)

    def _overflowed(self) -> None:
        if self.shaft.store.get(od.MODE_DISPLAY) == Mode.INTERPOLATED_POSITION:
            self._fail(BufferStatus.OVERFLOW_ERROR)

    def _fail(self, error: BufferStatus) -> None:
        self._buffer.fail(error)
        self.shaft.error = emergency.INTERPOLATION
