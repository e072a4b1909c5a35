"""ROME's geometry, limits, control and paths in its robot file (A. Seleit, MSc thesis, UCF, 2020)."""

import math
from collections.abc import Mapping
from itertools import pairwise
from types import MappingProxyType
from typing import Annotated, Final, Self

from pydantic import Field, model_validator

from firmware_bridge import renamed
from firmware_bridge.robot.table import Finite, NonNegative, Positive, Table

FASTEST: Final[Mapping[str, float]] = MappingProxyType({"circle": 0.25, "line": 1.0, "ellipse": 0.375})
"""The highest speed on each path of (2.20) to (2.22), in m/s for one meter to the unit."""
SPEED_SHARE: Final = 0.98
"""Share of the speed limit that set-points use: the loop on the board swings by 9 mm/s about a constant one.
docs/decisions/omni-limits.md has the measurements."""
SETTLES: Final = 1.001
"""A path may be as fast as the limit, rounding left out."""


class Base(Table):
    """Three omni wheels at 0, 120 and 240 degrees."""

    wheel_radius_m: Positive
    wheel_distance_m: Positive
    """From a wheel to the base's middle."""


class RomeLimits(Table):
    """The limits that the interlocks enforce, whatever the operator commands."""

    speed_mps: Positive
    """Of the base itself, in all directions; set-points use 0.98 of it."""
    acceleration_mps2: Positive
    """Of the set-points, in all directions. Behind the loop on the board the base has more for an instant."""
    turn_rate_rad_s: Positive
    turn_acceleration_rad_s2: Positive
    """Of the set-points."""
    rim_mps: Positive
    """Of each wheel; what motor, gear and supply give."""

    @property
    def setpoint_mps(self) -> float:
        """The highest speed of a set-point; the base itself then keeps `speed_mps`."""
        return SPEED_SHARE * self.speed_mps


class RomeGains(Table):
    """Gains of the control law (2.15), of all three directions."""

    kp_per_s: NonNegative
    ki_per_s2: NonNegative


class Paths(Table):
    """Meters for each unit of the thesis's paths; and a path of one's own."""

    circle: Positive = 1.0
    line: Positive = 1.0
    ellipse: Positive = 1.0
    points: Annotated[tuple[tuple[Finite, Finite, Finite, Finite], ...], Field(strict=False)] = ()
    """Of the path follower `points`: s, m, m, rad; straight from one to the next."""

    @model_validator(mode="after")
    def _time_goes_on(self) -> Self:
        times = [point[0] for point in self.points]
        # Each piece's speed is its way by its time: two equal times would divide by 0.
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise ValueError("each of points must be later than the one before")
        return self

    def fastest(self) -> dict[str, float]:
        """Return the highest speed on each path, m/s."""
        known = {name: speed * float(getattr(self, name)) for name, speed in FASTEST.items()}
        steps = pairwise(self.points)
        known["points"] = max(
            (math.hypot(new[1] - old[1], new[2] - old[2]) / (new[0] - old[0]) for old, new in steps),
            default=0.0,
        )
        return known


class RomeGeometry(Table):
    """The base, its limits, its control and its paths."""

    base: Base
    limits: RomeLimits
    control: RomeGains
    paths: Paths = Paths()

    @model_validator(mode="after")
    def _paths_are_no_faster_than_the_base(self) -> Self:
        for name, speed in self.paths.fastest().items():
            if speed > SETTLES * self.limits.setpoint_mps:
                scale = "" if name == "points" else f"; use {name} = {self.scale_of(name):.3g} or less"
                raise ValueError(
                    f"the path {name} needs {speed:.3g} m/s, limits.speed_mps leaves "
                    f"{self.limits.setpoint_mps:.3g} to set-points{scale}"
                )
        return self

    def scale_of(self, name: str) -> float:
        """Return the largest scale of a path that the speed limit allows."""
        return self.limits.setpoint_mps / FASTEST[name]


__getattr__ = renamed.module(__name__, __name__, Geometry="RomeGeometry")
