"""Profiles of one axis, one millisecond at a time: a ramp to a velocity, a trapezoid to a position.

The next velocity is found from what is left to go, so that targets, speeds and accelerations may change at
any time. A move ends exactly at its target: the last step is what is left.
"""

from math import isqrt

from emulators.servo.axis import ServoAxis


def ramp(axis: ServoAxis) -> bool:
    """Step the demand towards the target velocity; say whether it is there.

    Away from standstill with the acceleration, towards it with the deceleration; a reversal passes through 0.
    """
    speed = axis.velocity_demand
    target = axis.target_velocity
    if speed < target:
        if speed < 0:
            following = min(speed + axis.deceleration, target, 0)
        else:
            following = min(speed + axis.acceleration, target)
    elif speed > target:
        if speed > 0:
            following = max(speed - axis.deceleration, target, 0)
        else:
            following = max(speed - axis.acceleration, target)
    else:
        following = target
    axis.acceleration_demand = following - speed
    axis.velocity_demand = following
    axis.position_demand += following
    return following == target


def move(axis: ServoAxis) -> bool:
    """Step the demand towards the target position; say whether it has come to rest there.

    With velocity v now and d less in each later ms, the way to rest is v^2/(2d) + v/2. Solved for v with the
    way that is left, this is the fastest allowed velocity.
    """
    left = axis.target_position - axis.position_demand
    forward = left >= 0
    way = left if forward else -left
    speed = axis.velocity_demand if forward else -axis.velocity_demand
    slowing = axis.deceleration
    if way >= axis.stopping_distance:
        command = axis.cruise
    elif way <= slowing:
        command = min(way, axis.cruise)
    else:
        # The positive root of v^2 + d v - 2 d way, in integers: isqrt rounds down, to the safe side.
        command = min((isqrt(8 * slowing * way + slowing * slowing) - slowing) >> 1, axis.cruise)
    if speed < 0:
        following = min(speed + slowing, 0)
    elif speed < command:
        following = min(speed + axis.acceleration, command)
    else:
        following = max(speed - slowing, command)
    axis.acceleration_demand = following - speed if forward else speed - following
    axis.velocity_demand = following if forward else -following
    axis.position_demand += axis.velocity_demand
    return following == 0 and way == 0


def stopping_distance(speed: int, deceleration: int) -> int:
    """Return the way from `speed` to rest, in position units; from here on a move may have to slow down."""
    return speed * speed // (2 * deceleration) + speed + deceleration
