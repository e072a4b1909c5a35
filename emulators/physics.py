"""The one physics of a robot: its actuators, of whichever devices, and the plant that they move together.

One of them leads: it steps the plant. Where others follow, all go on in turns: first the leader, then the
others, whose commands count from the plant's next step on.
"""

from collections.abc import Callable, Sequence
from typing import Final, Protocol

from firmware_bridge.units import Nanoseconds


class Motor(Protocol):
    """One motor, as any device has it."""

    @property
    def name(self) -> str:
        """The axis that it moves."""

    @property
    def powered(self) -> int | bool:
        """True while its power stage is on."""

    def swap_channels(self, *, swapped: bool) -> None:
        """Exchange the channels of its encoder, or put them back; one without an encoder has none."""


class Actuators(Protocol):
    """Motors that go on together: the axes of all drives, those at one board's shield, an arm's joints."""

    @property
    def axes(self) -> Sequence[Motor]:
        """Its motors."""

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on, as `emulators.world.Physics` does; one that follows raises no events."""


class SteppedPlant(Protocol):
    """A plant, or the part of one that a device has, as its actuators step it."""

    def step(self) -> None:
        """Advance one step; a part that follows does nothing."""


class SteppedActuators:
    """Actuators of a device that acts in each step of the plant: `act`, then the step."""

    def __init__(
        self, axes: Sequence[Motor], act: Callable[[], None], plant: SteppedPlant, every: Nanoseconds
    ) -> None:
        self.axes: Final = axes
        self._act: Final = act
        self._plant: Final = plant
        self._every: Final = every
        self._reached: Nanoseconds = 0

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on by whole steps; the device requests its own wake when it has something to send."""
        while self._reached + self._every <= until:
            self._act()
            self._plant.step()
            self._reached += self._every
        return until, ()


class Physics:
    """Physics between two events: all actuators above one plant."""

    def __init__(self, leader: Actuators, followers: Sequence[Actuators], turn: Nanoseconds) -> None:
        """Take who steps the plant and who follows; `turn` is the longest time of one turn."""
        self.actuators: Final[tuple[Actuators, ...]] = (leader, *followers)
        self._leader: Final = leader
        self._followers: Final = tuple(followers)
        self._turn: Final = turn
        self._now: Nanoseconds = 0

    @property
    def axes(self) -> tuple[Motor, ...]:
        """Every motor."""
        return tuple(axis for actuators in self.actuators for axis in actuators.axes)

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on to `until`, or to the first event before it; see `emulators.world.Physics`."""
        if not self._followers:
            return self._leader.advance(until)
        while self._now < until:
            # On the grid of the turns, whatever the instants of the calls are.
            end = min(until, self._now - self._now % self._turn + self._turn)
            self._now, woken = self._leader.advance(end)
            for follower in self._followers:
                follower.advance(self._now)
            if woken:
                return self._now, woken
        return until, ()
