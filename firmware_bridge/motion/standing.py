"""How firmly a robot stands on its wheels: margin of the zero-moment point, accelerations, and a safe speed.

Axes are the body's: x ahead, y to the left, from one point on the floor between the wheels. The zero-moment
point (ZMP) is where the floor's force acts: while it is inside the support all wheels are loaded (A. P. Das,
PhD thesis, IIT Delhi, 2018, 2.3, for a support of any convex shape and a floor that tilts any way).
"""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Final, TypeAlias

from firmware_bridge.units import STANDARD_GRAVITY

Corner: TypeAlias = tuple[float, float]
_LEVEL: Final = 1e-12


class Standing:
    """One robot at one instant."""

    __slots__ = ("_across", "_along", "_edges", "_normal", "_x", "height_m")

    def __init__(
        self,
        corners: Sequence[Corner],
        centre: tuple[float, float, float],
        pitch_rad: float = 0.0,
        roll_rad: float = 0.0,
    ) -> None:
        """Take the wheels' contacts, counter-clockwise, the centre of mass over them, and the tilt.

        Pitch is positive with the nose up, roll with the left side up. Lengths in m; ValueError for a tilt
        of 90 degrees or more, or a centre of mass in the floor.
        """
        x, y, self.height_m = centre
        self._x: Final = x
        self._normal: Final = STANDARD_GRAVITY * math.cos(pitch_rad) * math.cos(roll_rad)
        if not (self._normal > _LEVEL and self.height_m > 0.0 and abs(pitch_rad) < math.pi / 2.0):
            raise ValueError(f"tilted by {pitch_rad:g} and {roll_rad:g} rad, centre at {self.height_m:g} m")
        # What gravity pulls along the floor, ahead and to the left.
        self._along: Final = -STANDARD_GRAVITY * math.sin(pitch_rad)
        self._across: Final = -STANDARD_GRAVITY * math.cos(pitch_rad) * math.sin(roll_rad)
        self._edges: Final = tuple(_edges(corners, x, y))

    def margin(self, ahead: float = 0.0, left: float = 0.0) -> float:
        """Return the distance in m of the ZMP inside the nearest edge, negative outside.

        `ahead` and `left`: the acceleration of the robot along its axes, m/s2.
        """
        lever = self.height_m / self._normal
        along, across = lever * (self._along - ahead), lever * (self._across - left)
        return min(room + inward_x * along + inward_y * across for inward_x, inward_y, room in self._edges)

    def accelerations(self, left: float, least_m: float) -> tuple[float, float]:
        """Return the lowest and the highest acceleration ahead, m/s2, that leave so much margin.

        At an acceleration to the left. The lowest is above the highest where no acceleration does.
        """
        return self._bounds(least_m, across=left)

    def turns(self, ahead: float, least_m: float) -> tuple[float, float]:
        """Return the lowest and the highest acceleration to the left, m/s2, that leave so much margin.

        As `accelerations`, at an acceleration ahead.
        """
        return self._bounds(least_m, along=ahead)

    def highest(self, least_m: float) -> float:
        """Return the height of the centre of mass, m, up to which it stands with so much margin."""
        top = math.inf
        for inward_x, inward_y, room in self._edges:
            pulls = -(inward_x * self._along + inward_y * self._across) / self._normal
            if pulls > 0.0:
                top = min(top, (room - least_m) / pulls)
            elif room < least_m:
                return 0.0
        return top

    def friction(self, holding_m: float, rolling_m: float) -> float:
        """Return the friction coefficient that keeps it at rest; inf where none does.

        Only the axle at `holding_m` ahead holds it along, the one at `rolling_m` rolls; across both do.
        """
        ahead = self._x + self.height_m * self._along / self._normal
        share = (ahead - rolling_m) / (holding_m - rolling_m)
        return math.hypot(self._along / share, self._across) / self._normal if share > 0.0 else math.inf

    def highest_held(self, friction: float, holding_m: float, rolling_m: float) -> float:
        """Return the height of the centre of mass, m, up to which so much friction keeps it at rest.

        As `friction`; inf where any height does, 0 where none.
        """
        bears = (friction * self._normal) ** 2 - self._across**2
        if bears <= 0.0:
            return 0.0
        least = abs(self._along) / math.sqrt(bears)
        low = (self._x - rolling_m) / (holding_m - rolling_m)
        # The holding axle's share of the weight changes so much with each meter of height.
        change = self._along / self._normal / (holding_m - rolling_m)
        if change >= 0.0:
            return math.inf if low + change * self.height_m >= least else 0.0
        return max((low - least) / -change, 0.0)

    def safe_speed(self, direction: float) -> float:
        """Return the speed in m/s at which not even a stop at once could tip it; ahead for a positive one.

        The kinetic energy of its motion across each edge ahead of it would be less than lifts its centre of
        mass over that edge.
        """
        slowest, way = math.inf, math.copysign(1.0, direction)
        for inward_x, inward_y, room in self._edges:
            across = -inward_x * way
            if across > _LEVEL:
                energy = self._energy(inward_x, inward_y, room)
                slowest = min(slowest, math.sqrt(2.0 * energy) / across)
        return slowest

    def _bounds(
        self, least_m: float, *, along: float | None = None, across: float = 0.0
    ) -> tuple[float, float]:
        """Return the bounds of the acceleration ahead, or where that is given of the one to the left."""
        low, high = -math.inf, math.inf
        lever = self.height_m / self._normal
        for inward_x, inward_y, room in self._edges:
            # room + inward_x lever (along - a) + inward_y lever (across - b) >= least, for a or for b.
            if along is None:
                rest = room + inward_y * lever * (self._across - across) - least_m
                share, pull = inward_x * lever, self._along
            else:
                rest = room + inward_x * lever * (self._along - along) - least_m
                share, pull = inward_y * lever, self._across
            if share > _LEVEL:
                high = min(high, pull + rest / share)
            elif share < -_LEVEL:
                low = max(low, pull + rest / share)
            elif rest < 0.0:
                return math.inf, -math.inf
        return low, high

    def _energy(self, inward_x: float, inward_y: float, room: float) -> float:
        """Return the work for each kilogram, J/kg, to turn it over an edge; 0 where it turns by itself."""
        outward = -(inward_x * self._along + inward_y * self._across)
        # In the plane across the edge: the lever of the centre of mass, and gravity.
        held = self._normal * room - outward * self.height_m
        if held <= 0.0:
            return 0.0
        pull, lever = math.hypot(self._normal, outward), math.hypot(room, self.height_m)
        return pull * lever - (self._normal * self.height_m + outward * room)


def _edges(corners: Sequence[Corner], x: float, y: float) -> Iterator[tuple[float, float, float]]:
    """Yield the inward direction of each edge, and the distance of a point inside it."""
    for (from_x, from_y), (to_x, to_y) in pairwise((*corners, corners[0])):
        length = math.hypot(to_x - from_x, to_y - from_y)
        inward_x, inward_y = (from_y - to_y) / length, (to_x - from_x) / length
        yield inward_x, inward_y, inward_x * (x - from_x) + inward_y * (y - from_y)
