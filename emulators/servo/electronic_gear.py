"""The electronic gear: following the digital position input, one millisecond at a time, in whole numbers.

Source: EPOS2 EDS (0x2300). The demand keeps to the limits of velocity and acceleration, so that it may fall
behind; it then closes up like a move to a target that itself moves. Assumed: what it follows ends at the
software position limits, and the input's way beyond them is not lost.
"""

from math import isqrt
from typing import Final

from emulators.servo.axis import ServoAxis

FASTEST_INPUT: Final = 1 << 31
"""Limit of the input per ms, in counts and velocity units, beyond which it does not count: 4 x 25 000 rpm."""


def electronic_gear(axis: ServoAxis) -> bool:
    """Step the demand after the input's count; say whether it has caught up."""
    steps = max(-FASTEST_INPUT, min(FASTEST_INPUT, axis.master - axis.gear_counted))
    axis.gear_counted = axis.master
    counted = axis.gear_rest + steps * axis.gear_numerator
    # Floor division with its rest: no count is lost, forwards or backwards.
    whole = counted // axis.gear_denominator
    axis.gear_rest = counted - whole * axis.gear_denominator
    fastest = FASTEST_INPUT >> axis.fraction
    before = max(axis.lowest, min(axis.highest, axis.target_position))
    axis.target_position += max(-fastest, min(fastest, whole)) << axis.fraction
    target = max(axis.lowest, min(axis.highest, axis.target_position))
    ahead = target - before
    # The input's own step is fed forward: only what is behind it is closed up by a ramp.
    command = ahead + closing_speed(axis, before - axis.position_demand)
    command = max(-axis.cruise, min(axis.cruise, command))
    speed = axis.velocity_demand
    following = max(speed - axis.deceleration, min(speed + axis.acceleration, command))
    position = axis.position_demand + following
    axis.acceleration_demand = following - speed
    axis.velocity_demand = following
    axis.position_demand = position
    return position == target


def closing_speed(axis: ServoAxis, behind: int) -> int:
    """Return the fastest velocity from which the axis comes to rest `behind` position units further."""
    way = behind if behind >= 0 else -behind
    slowing = axis.deceleration
    if way >= axis.stopping_distance:
        speed = axis.cruise
    elif way <= slowing:
        speed = way
    else:
        # v^2/(2 d) + v/2 = way, solved for v: see `emulators.servo.profile.move`.
        speed = (isqrt(8 * slowing * way + slowing * slowing) - slowing) >> 1
    return speed if behind >= 0 else -speed
