"""A plant's body on film: where it was at each exposure, kept while the physics runs on.

So no one is stopped or woken for an exposure; the cameras look at the film when the frame is to leave.
"""

from collections import deque
from collections.abc import Callable, Sequence
from typing import Final, Protocol

from emulators.motion_capture.bodies import Attitude, on_floor
from firmware_bridge.units import Nanoseconds

FLOOR: Final = ("x", "y", "heading")
"""The outputs of a plant that drives on a floor, by which its body is seen."""
SPACE: Final = ("x", "y", "z", "qx", "qy", "qz", "qw")
"""Outputs of a robot that goes up walls: its body's place in the room, and a quaternion."""
LENGTH: Final = 1_024
"""Pictures that are kept: those of 4 s at 240 Hz."""


class Physics(Protocol):
    """Physics that move the plant; see `emulators.world.Physics`."""

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on to `until`, or to the first event before it."""


class Doubles(Protocol):
    """An array of floating-point numbers, as ctypes makes them."""

    def __getitem__(self, index: int, /) -> float: ...


class Outputs(Protocol):
    """Outputs of a plant, as `emulators.servo.seam.ServoPlant` has them."""

    @property
    def outputs(self) -> Doubles:
        """Its outputs now, SI."""


class Film:
    """Physics whose plant outputs its body's pose, by `SPACE` or `FLOOR`; as a truth it returns past ones."""

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
        self._in_space: Final = set(SPACE) <= set(names)
        self._at: Final = [names.index(name) for name in (SPACE if self._in_space else FLOOR)]
        self._exposed_at: Final = exposed_at
        self._number = 0
        self._next_at = exposed_at(0)
        self._pictures: deque[tuple[Nanoseconds, list[float]]] = deque(maxlen=LENGTH)

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on as the physics does, from exposure to exposure."""
        while self._next_at <= until:
            reached, woken = self._physics.advance(self._next_at)
            # An event before the exposure: the next call goes on to the same exposure.
            if woken:
                return reached, woken
            outputs = self._plant.outputs
            self._pictures.append((self._next_at, [outputs[place] for place in self._at]))
            self._number += 1
            self._next_at = self._exposed_at(self._number)
        return self._physics.advance(until)

    def __call__(self, now: Nanoseconds) -> Attitude:
        """Return where the body was, by the newest picture of this instant or before, or by the oldest."""
        # From the newest on: exposures lie only some ms back.
        for at, picture in reversed(self._pictures):
            if at <= now:
                return self._place(picture)
        return self._place(self._pictures[0][1])

    def _place(self, picture: list[float]) -> Attitude:
        if not self._in_space:
            x, y, heading = picture
            return on_floor(x, y, heading)
        x, y, z, qx, qy, qz, qw = picture
        return Attitude((x, y, z), (qx, qy, qz, qw))
