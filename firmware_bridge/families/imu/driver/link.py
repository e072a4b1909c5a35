"""The line to an IMU as a link: the bridge listens, judges each frame, and reports its quantities.

Its loss stops no one by itself: readings are absent then, and those who need them decide.
"""

from collections.abc import Iterable
from typing import Final

from firmware_bridge.drivers.plain_link import PlainLink
from firmware_bridge.families.imu.driver.attitude import Attitude, Phase
from firmware_bridge.families.imu.driver.axes import Vector, rotated, rotation_of
from firmware_bridge.families.imu.driver.plausibility import Plausibility
from firmware_bridge.families.imu.driver.sensor import ImuQuantity
from firmware_bridge.families.imu.settings import ImuLink
from firmware_bridge.families.imu.wire import METRES, RADIANS, SEQUENCES, WRAP_MS, FrameReader, ImuFrame
from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

_PER_SECOND: Final = 1_000.0


class ImuLine(PlainLink):
    """One line, and the quantities that are read on it."""

    def __init__(self, name: str, table: ImuLink, quantities: Iterable[ImuQuantity]) -> None:
        super().__init__(name)
        self._table: Final = table
        self._quantities: Final = tuple(quantities)
        self._rotation: Final = rotation_of(table.mounted)
        self._silent: Final = table.silent_ms * MILLISECOND
        self._silent_at: Nanoseconds = NEVER
        """Time at which the line counts as silent, unless a frame comes before."""
        self._reader: Final = FrameReader()
        self._plausibility = Plausibility()
        self.attitude: Final = Attitude(table.time_constant_s)
        self._before: ImuFrame | None = None
        self.problem = "no frame was received"
        """Why there are no readings; empty where there are."""
        self.missing = 0
        """Frames that are missing by their sequence counters."""

    @property
    def refused(self) -> int:
        """Number of frames with a wrong CRC."""
        return self._reader.refused

    @property
    def lost(self) -> str | None:
        """The reason why the IMU is not reached, where the robot file lets its line stop something."""
        return None if self._table.stops == () else super().lost

    @property
    def wake_at(self) -> Nanoseconds:
        """Time at which the line counts as silent."""
        return self._silent_at

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Have no readings any more where nothing was received for too long."""
        if now >= self._silent_at:
            self._fall_silent(f"no frame for {self._table.silent_ms} ms")
        return ()

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take bytes, or the state of the line."""
        if packet.address == LINE_LOST:
            self.gone = "the serial adapter is unplugged"
            self._fall_silent(self.gone)
        elif packet.address == LINE_BACK:
            self.gone = ""
        else:
            for frame in self._reader.receive(packet.payload):
                self._take(frame, now)
        return ()

    def _fall_silent(self, why: str) -> None:
        self._silent_at, self._before = NEVER, None
        self._reader.flush()
        # The frames before do not count against the first one after.
        self._plausibility = Plausibility()
        self._miss(why)

    def _miss(self, why: str) -> None:
        """Have no readings, for this reason."""
        self.problem, self.remark = why, f"{self.name}: no readings of the IMU: {why}"
        self.attitude.restart()
        for one in self._quantities:
            one.missed()

    def _take(self, frame: ImuFrame, now: Nanoseconds) -> None:
        """Take a frame, and report what it has where it counts."""
        before, self._before, self._silent_at = self._before, frame, now + self._silent
        elapsed_ms = 0
        if before is not None:
            elapsed_ms = (frame.stamp_ms - before.stamp_ms) % WRAP_MS
            self.missing += (frame.sequence - before.sequence - 1) % SEQUENCES
            if not 0 < elapsed_ms <= self._table.silent_ms:
                # The device has started again, or frames are missing: rates between them are not known.
                self.attitude.restart()
                elapsed_ms = 0
        problem = self._plausibility.problem(frame, elapsed_ms)
        if problem:
            self._miss(problem)
            return
        force, rate = self._in_axes(frame.force, METRES), self._in_axes(frame.rate, RADIANS)
        self.attitude.step(force, rate, elapsed_ms / _PER_SECOND)
        self._report(force, rate, now)

    def _report(self, force: Vector, rate: Vector, now: Nanoseconds) -> None:
        attitude = self.attitude
        if attitude.phase is not Phase.READY:
            self.problem = attitude.phase.value
            moves = attitude.phase is Phase.MOVING
            self.remark = f"{self.name}: no readings of the IMU: {self.problem}" if moves else ""
            for one in self._quantities:
                one.missed()
            return
        self.problem = self.remark = ""
        turned = (rate[0] - attitude.bias[0], rate[1] - attitude.bias[1], rate[2] - attitude.bias[2])
        values = (attitude.pitch, attitude.roll, *force, *turned)
        for one in self._quantities:
            one.take(values, now - self._table.latency, now)

    def _in_axes(self, counts: tuple[int, int, int], unit: float) -> Vector:
        """Return a vector in the robot's axes, from counts in the sensor's."""
        x, y, z = counts
        return rotated(self._rotation, (x * unit, y * unit, z * unit))
