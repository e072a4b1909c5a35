"""The arm's sketch on a Mega spoken to by hand, byte by byte; every pulse is kept with its instant."""

from collections.abc import Callable, Sequence

from emulators.arduino_omni.ar2.axes import AXES
from emulators.arduino_omni.ar2.firmwares import FIRMWARES
from emulators.arduino_omni.ar2.joints import Joints
from emulators.arduino_omni.ar2.sketch import Ar2Sketch
from emulators.arduino_omni.mega.mega import Mega
from firmware_bridge.units import MICROSECOND, NEVER, SECOND, Nanoseconds

GAP = SECOND // 100
"""Time between two lines, in which the answer has left."""
LEVEL = (0,) * 6
"""No weight at any joint."""


def weightless(_: Sequence[float]) -> Sequence[float]:
    return LEVEL


class Bench:
    """A board that has started, and has its line's bytes at once."""

    def __init__(
        self,
        generation: str = "2.0",
        load: Callable[[Sequence[float]], Sequence[float]] = weightless,
    ) -> None:
        self.kept: list[tuple[int, int, int]] = []
        """Pulses: axis, 1 for ahead or -1, instant in us."""
        self.joints = Joints(load, on_count=self._keep)
        firmware = FIRMWARES[generation]
        self.mega = Mega(
            lambda mega: Ar2Sketch(mega, self.joints, firmware), firmware.baud, shafts=self.joints, boot=0
        )
        self.now: Nanoseconds = 0
        self.mega.reset(0)
        self.mega.advance(0)

    def _keep(self, axis: int, ahead: int, at: Nanoseconds) -> None:
        self.kept.append((axis, ahead, at // MICROSECOND))

    @property
    def busy(self) -> bool:
        return self.mega.due != NEVER

    @property
    def sketch(self) -> Ar2Sketch:
        assert isinstance(self.mega.sketch, Ar2Sketch)
        return self.mega.sketch

    @property
    def begun(self) -> Nanoseconds:
        """Time at which the next line will have come."""
        return self.now + GAP

    def ask(self, line: bytes, within: Nanoseconds = 1_000 * SECOND) -> bytes:
        """Send a line; return the output until nothing is due any more, or the time is over."""
        self.kept.clear()
        self.now += GAP
        self.mega.advance(self.now)
        for byte in line:
            self.mega.receive(byte, self.now)
        return self.run(within)

    def run(self, within: Nanoseconds) -> bytes:
        end = self.now + within
        while (due := self.mega.due) <= end:
            self.mega.advance(max(due, self.now))
            self.now = max(due, self.now)
        if self.busy:
            self.now = end
            self.mega.advance(end)
        return self.mega.serial.taken(NEVER)

    def moved(self) -> list[int]:
        """Return by how many steps each axis was commanded to go, with signs, by the last line."""
        reported = [0] * len(AXES)
        for axis, ahead, _ in self.kept:
            reported[axis] += ahead
        return reported

    def span_us(self) -> int:
        """Return the time from the first pulse to the last."""
        return self.kept[-1][2] - self.kept[0][2]
