"""A plant's body on film: where it was at each exposure, kept while the physics runs on.

So nobody is stopped or woken for an exposure; the cameras look at the film when the frame is to leave.
"""

from collections import deque
from collections.abc import Callable, Sequence
from typing import Final, Protocol

from emulators.motion_capture.bodies import Place, on_floor
from firmware_bridge.units import Nanoseconds

LENGTH: Final = 1_024
"""Pictures that are kept: those of 4 s at 240 Hz."""


class Physics(Protocol):
    """What moves the plant; see `emulators.world.Physics`."""

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on to `until`, or to the first event before it."""


class Doubles(Protocol):
    """An array of floating-point numbers, as ctypes makes them."""

    def __getitem__(self, index: int, /) -> float: ...


class Outputs(Protocol):
    """What a plant tells of itself; `emulators.servo.seam.Plant` does."""

    @property
    def outputs(self) -> Doubles:
        """Its outputs now, SI."""


class Film:
    """Physics whose plant has outputs x, y and heading, and as a truth where its body was at an exposure."""

    def __init__(
        self,
        physics: Physics,
        plant: Outputs,
        names: Sequence[str],
        exposed_at: Callable[[int], Nanoseconds],
    ) -> None:
        """Take the outputs' names, and when each exposure is, from 0 on; ValueError where one is missing."""
        self._physics: Final = physics
        self._plant: Final = plant
        self._at: Final = (names.index("x"), names.index("y"), names.index("heading"))
        self._exposed_at: Final = exposed_at
        self._number = 0
        self._next_at = exposed_at(0)
        self._pictures: deque[tuple[Nanoseconds, float, float, float]] = deque(maxlen=LENGTH)

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on as the physics does, from exposure to exposure."""
        while self._next_at <= until:
            reached, woken = self._physics.advance(self._next_at)
            if woken:
                return reached, woken
            outputs, (x, y, heading) = self._plant.outputs, self._at
            self._pictures.append((self._next_at, outputs[x], outputs[y], outputs[heading]))
            self._number += 1
            self._next_at = self._exposed_at(self._number)
        return self._physics.advance(until)

    def __call__(self, now: Nanoseconds) -> Place:
        """Return where the body was, by the newest picture of this instant or before, or by the oldest."""
        for at, x, y, heading in reversed(self._pictures):
            if at <= now:
                return on_floor(x, y, heading)
        _, x, y, heading = self._pictures[0]
        return on_floor(x, y, heading)
