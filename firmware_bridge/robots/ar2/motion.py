"""The arm's motion in its own terms: its tool's in the frame of its foot, x ahead, y left, z up."""

from collections.abc import Sequence
from typing import Final

from firmware_bridge import renamed
from firmware_bridge.value import valueclass

STILL: Final[tuple[float, ...]] = (0.0,) * 6


@valueclass(frozen=True, slots=True)
class Ar2Motion:
    """A motion: the operator's command, the permitted one, or the bridge's set-point."""

    ahead_mps: float = 0.0
    left_mps: float = 0.0
    up_mps: float = 0.0
    roll_rad_s: float = 0.0
    """About x, as the next two are about y and z."""
    pitch_rad_s: float = 0.0
    yaw_rad_s: float = 0.0
    angles: tuple[float, ...] | None = None
    """Of the six joints, rad: where a set-point has them be at the end of its cycle; None: where they are."""
    path_s: float | None = None
    """Progress of a path follower on its course, in s; None without one."""

    @property
    def speed(self) -> tuple[float, ...]:
        """Of the tool, m/s."""
        return self.ahead_mps, self.left_mps, self.up_mps

    @property
    def turn(self) -> tuple[float, ...]:
        """Of the tool, rad/s."""
        return self.roll_rad_s, self.pitch_rad_s, self.yaw_rad_s

    @property
    def twist(self) -> tuple[float, ...]:
        """Both."""
        return (*self.speed, *self.turn)


def motion_of(
    twist: Sequence[float], angles: tuple[float, ...] | None = None, path_s: float | None = None
) -> Ar2Motion:
    """Return the motion with six speeds, m/s along x, y and z and rad/s about them."""
    x, y, z, roll, pitch, yaw = map(float, twist)
    return Ar2Motion(x, y, z, roll, pitch, yaw, angles, path_s)


@valueclass(frozen=True, slots=True)
class Ar2State:
    """State of the joints: counted, not measured."""

    angles: tuple[float, ...]
    """rad."""
    rates: tuple[float, ...]
    """rad/s."""


__getattr__ = renamed.module(__name__, __name__, Motion="Ar2Motion", State="Ar2State")
