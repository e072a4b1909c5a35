"""What the guard's node, and its rules over several axes, must know of one axis, whatever device moves it."""

from typing import NamedTuple, Protocol

from firmware_bridge.robot import Axis
from firmware_bridge.units import Nanoseconds


class Requested(NamedTuple):
    """What an axis would do by a set-point."""

    moves: bool
    speed: float
    """In the axis's unit a second; 0 where it is commanded by position."""


class InForce(Protocol):
    """One axis, and the set-point in force at its device."""

    commanded_at: Nanoseconds
    """When the node last had a set-point for it, good or bad."""
    all: "tuple[InForce, ...]"
    """Every axis of the robot, this one among them."""

    @property
    def axis(self) -> Axis:
        """Its table in the robot file."""

    @property
    def cycle(self) -> Nanoseconds:
        """The time from one of its set-points to the next."""

    @property
    def speed(self) -> float:
        """The speed that is in force, in the axis's unit a second; 0 where it is commanded by position."""

    @property
    def powered(self) -> bool:
        """Whether its device may have power."""

    @property
    def moving(self) -> bool:
        """Whether the set-point in force asks for motion, or its device moves to find its zero."""

    @property
    def homes(self) -> bool:
        """Whether its device was told to find its zero, by moving."""

    @property
    def homes_within_s(self) -> float:
        """How long that may last."""
