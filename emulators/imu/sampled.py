"""A plant's body, sampled while the physics runs on: what it felt at each instant.

The physics stops at each sample, so that no one is woken for it. Three samples, 5 ms apart, make a value:
it is 5 ms old, as behind the part's low-pass filter (44 Hz, delay 4.9 ms; RM-MPU-6000A-00, DLPF_CFG 3:
assumed).
"""

from collections import deque
from collections.abc import Mapping, Sequence
from typing import Final, Protocol

from emulators.imu.truth import FLOOR, SLOPE, SPACE, TILT, Felt, Posed, felt, posed
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

EVERY: Final[Nanoseconds] = 5 * MILLISECOND
KEPT: Final = 1_024
"""Samples that are kept: those of 5 s."""
_NEEDED: Final = 3


class Physics(Protocol):
    """Physics that move the plant; see `emulators.world.Physics`."""

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on to `until`, or to the first event before it."""


class Doubles(Protocol):
    """An array of floating-point numbers, as ctypes makes them."""

    def __getitem__(self, index: int, /) -> float: ...


class Plant(Protocol):
    """A plant, as far as it is seen here; `fmu.plant.FmuPlant` is one."""

    @property
    def outputs(self) -> Doubles:
        """Its outputs now, SI."""

    @property
    def output_names(self) -> Sequence[str]:
        """Their names."""

    @property
    def variables(self) -> Mapping[str, object]:
        """All variables by their names."""

    def read(self, name: str) -> float:
        """Return any variable's value now."""


def lacking(outputs: Sequence[str]) -> tuple[str, ...]:
    """Return which outputs a plant lacks to show its body; none where it has `FLOOR` or `SPACE`."""
    if set(SPACE) <= set(outputs):
        return ()
    return tuple(name for name in FLOOR if name not in outputs)


class Sampled:
    """Physics around the plant's; as a truth it returns what its body felt."""

    def __init__(self, physics: Physics, plant: Plant) -> None:
        names = plant.output_names
        used = SPACE if set(SPACE) <= set(names) else (*FLOOR, *(one for one in TILT if one in names))
        self._physics: Final = physics
        self._plant: Final = plant
        self._places: Final = tuple((name, names.index(name)) for name in used)
        known = plant.variables
        self._parameters: Final = tuple(name for name in SLOPE if name in known and "qw" not in used)
        self._next_at: Nanoseconds = 0
        self._poses: deque[tuple[Nanoseconds, Posed]] = deque(maxlen=KEPT)

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on as the physics does, from sample to sample."""
        while self._next_at <= until:
            reached, woken = self._physics.advance(self._next_at)
            # An event before the sample: the next call goes on to the same sample.
            if woken:
                return reached, woken
            outputs = self._plant.outputs
            values = {name: outputs[place] for name, place in self._places}
            # They may change while it drives: a ramp begins.
            values |= {name: self._plant.read(name) for name in self._parameters}
            self._poses.append((self._next_at, posed(values)))
            self._next_at += EVERY
        return self._physics.advance(until)

    def __call__(self, now: Nanoseconds) -> Felt:
        """Return what the body felt by the newest samples up to an instant."""
        found = self._until(now) if self._late(now) else self._newest()
        # Before the first ones it stood where it stands.
        return felt([found[0]] * (_NEEDED - len(found)) + found, to_seconds(EVERY))

    def _late(self, now: Nanoseconds) -> bool:
        """Return whether there are newer samples than those of this instant, as on a busy machine."""
        return bool(self._poses) and self._poses[-1][0] > now

    def _until(self, now: Nanoseconds) -> list[Posed]:
        found = [pose for at, pose in self._poses if at <= now][-_NEEDED:]
        # One that is older than all that is kept is shown the oldest.
        return found or [self._poses[0][1]]

    def _newest(self) -> list[Posed]:
        return [self._poses[place][1] for place in range(max(-_NEEDED, -len(self._poses)), 0)]
