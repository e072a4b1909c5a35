"""The spline of interpolated position mode, one millisecond at a time: cubic segments from knot to knot.

A segment's position is `linear` t/T + `square` (t/T)2 + `cube` (t/T)3 beyond its knot. Reckoned from the
inside out with one division by T each, it is exact at t = T, so that nothing adds up over a thousand knots.
The axis has the segment after the present one beforehand: it goes on by itself, and tells.
"""

from emulators.servo.axis import ServoAxis


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
        axis.call = 1
    return False
