"""The spline of interpolated position mode: segments made from knots, run one millisecond at a time.

Source: application note Interpolation Position Mode, December 2008: cubic splines through position, velocity
and time. Whole numbers only. A segment's position is `linear` t/T + `square` (t/T)2 + `cube` (t/T)3 beyond
its knot. Reckoned from the inside out with one division by T each, it is exact at t = T, so that nothing adds
up over a thousand knots. The axis has the next segment beforehand: it goes on by itself, and reports it.
"""

from dataclasses import dataclass

from emulators.servo.axis import SPLINE, ServoAxis
from emulators.servo.commands import judge_again, regulate_position


@dataclass(frozen=True, slots=True)
class Knot:
    """A position in position units, and the velocity there in velocity units."""

    position: int
    velocity: int


@dataclass(frozen=True, slots=True)
class SplineSegment:
    """A knot, and the way to the next in `ms`: linear t/T + square (t/T)2 + cube (t/T)3; position units."""

    start: int
    linear: int
    square: int
    cube: int
    ms: int

    def fastest(self) -> int:
        """Return the largest velocity on the way, in velocity units, rounded up."""
        ends = (self.linear, self.linear + 2 * self.square + 3 * self.cube)
        largest = max(map(abs, ends))
        # Between its ends the velocity turns where 2 square + 6 cube t/T is 0.
        if self.cube and 0 < -self.square * (1 if self.cube > 0 else -1) < 3 * abs(self.cube):
            largest = max(
                largest, -(-abs(3 * self.cube * self.linear - self.square**2) // abs(3 * self.cube))
            )
        return -(-largest // self.ms)

    def sharpest(self) -> int:
        """Return the largest acceleration on the way, in acceleration units, rounded up."""
        largest = max(abs(2 * self.square), abs(2 * self.square + 6 * self.cube))
        return -(-largest // self.ms**2)


def segment(start: Knot, end: Knot, ms: int) -> SplineSegment:
    """Return the cubic that has position and velocity of both knots; `ms` is at least 1."""
    way = end.position - start.position
    first, last = start.velocity * ms, end.velocity * ms
    return SplineSegment(start.position, first, 3 * way - 2 * first - last, first + last - 2 * way, ms)


def begin(axis: ServoAxis, first: SplineSegment) -> None:
    """Run a segment from the next ms on; the position regulator takes over."""
    regulate_position(axis)
    axis.profile = SPLINE
    axis.knot, axis.spline_at = first.start, 0
    axis.spline_linear, axis.spline_square, axis.spline_cube = first.linear, first.square, first.cube
    axis.spline_ms = first.ms
    axis.next_ms = 0
    judge_again(axis, there=False)


def prepare(axis: ServoAxis, following: SplineSegment) -> None:
    """Prepare the segment that starts at the end of the present one."""
    axis.next_linear, axis.next_square, axis.next_cube = following.linear, following.square, following.cube
    axis.next_ms = following.ms


def spline(axis: ServoAxis) -> bool:
    """Step the demand along the present segment; without one stand still, and say so."""
    length = axis.spline_ms
    if length == 0:
        axis.acceleration_demand = -axis.velocity_demand
        axis.velocity_demand = 0
        return True
    axis.spline_at += 1
    at = axis.spline_at
    gone = axis.spline_square + axis.spline_cube * at // length
    gone = axis.spline_linear + gone * at // length
    position = axis.knot + gone * at // length
    speed = position - axis.position_demand
    axis.acceleration_demand = speed - axis.velocity_demand
    axis.velocity_demand = speed
    axis.position_demand = position
    if at == length:
        axis.knot, axis.spline_at = position, 0
        axis.spline_linear, axis.spline_square = axis.next_linear, axis.next_square
        axis.spline_cube, axis.spline_ms = axis.next_cube, axis.next_ms
        axis.next_ms = 0
        axis.splines_done += 1
        # Each end of a segment is an event: the mode drops its record, and prepares the next one.
        axis.call = 1
    return False
