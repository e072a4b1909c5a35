"""The view of one axis for the guard's node and its rules over several axes, whatever device moves it."""

from typing import NamedTuple, Protocol

from firmware_bridge.robot import Axis
from firmware_bridge.units import Nanoseconds


class RequestedMotion(NamedTuple):
    """The motion that a set-point requests of an axis."""

    moves: bool
    speed: float
    """In the axis's unit a second; 0 where it is commanded by position."""


class InForce(Protocol):
    """One axis, and the set-point in force at its device."""

    commanded_at: Nanoseconds
    """Time of the node's last set-point for it, good or bad."""
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
        """True while its device may have power."""

    @property
    def moving(self) -> bool:
        """True while the set-point in force commands motion, or its device moves for homing."""

    @property
    def homes(self) -> bool:
        """True while its device is commanded to home with motion."""

    @property
    def homes_within_s(self) -> float:
        """Longest permitted time of that, in s."""
