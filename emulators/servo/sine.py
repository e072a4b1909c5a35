"""The sin2 profile of one axis, one millisecond at a time: from one velocity to the next along a sin2.

A profile is a chain of at most four legs, each from one velocity to another in an odd number of ms (a leg at
constant velocity in any number): `emulators.servo.sine_plan` makes them. The second half of a leg mirrors the
first, so that its way is known exactly beforehand, whatever is rounded.
"""

from typing import Final

from emulators.servo.axis import MOVE, ServoAxis

SHARE_PLACES: Final = 31
# (1 - cos(pi x)) / 2 in powers of x2, alternating; SHARE_PLACES binary places. Up to x = 1/2 exact to 2^-30.
SINE_1: Final = 5_298_703_516
SINE_2: Final = 4_358_008_962
SINE_3: Final = 1_433_727_481
SINE_4: Final = 252_684_340
SINE_5: Final = 27_709_939
SINE_6: Final = 2_071_865
SINE_7: Final = 112_354


def share(part: int) -> int:
    """Return sin2(pi x/2) for x up to 1/2; both in SHARE_PLACES binary places."""
    square = part * part >> SHARE_PLACES
    rest = SINE_7
    rest = SINE_6 - (rest * square >> SHARE_PLACES)
    rest = SINE_5 - (rest * square >> SHARE_PLACES)
    rest = SINE_4 - (rest * square >> SHARE_PLACES)
    rest = SINE_3 - (rest * square >> SHARE_PLACES)
    rest = SINE_2 - (rest * square >> SHARE_PLACES)
    rest = SINE_1 - (rest * square >> SHARE_PLACES)
    return rest * square >> SHARE_PLACES


def risen(change: int, at: int, length: int) -> int:
    """Return how much of a leg's change of velocity is there after `at` of `length` ms, in its first half."""
    return change * share((at << SHARE_PLACES) // length) >> SHARE_PLACES


def legs(axis: ServoAxis) -> bool:
    """Step the demand along the legs; say whether their end is reached, and with a move the target."""
    if axis.leg_at == axis.leg_ms and axis.leg_2_ms:
        axis.leg_from, axis.leg_to, axis.leg_ms = axis.leg_to, axis.leg_2_to, axis.leg_2_ms
        axis.leg_2_to, axis.leg_2_ms = axis.leg_3_to, axis.leg_3_ms
        axis.leg_3_to, axis.leg_3_ms = axis.leg_4_to, axis.leg_4_ms
        axis.leg_4_ms = 0
        axis.leg_at = 0
    if axis.leg_at < axis.leg_ms:
        axis.leg_at += 1
    at, length, change = axis.leg_at, axis.leg_ms, axis.leg_to - axis.leg_from
    if at == length or change == 0:
        following = axis.leg_to
    elif 2 * at < length:
        following = axis.leg_from + risen(change, at, length)
    else:
        following = axis.leg_to - risen(change, length - at, length)
    if axis.leg_spare > 0:
        axis.leg_spare -= 1
        following += 1
    elif axis.leg_spare < 0:
        axis.leg_spare += 1
        following -= 1
    axis.acceleration_demand = following - axis.velocity_demand
    axis.velocity_demand = following
    axis.position_demand += following
    ended = at == length and axis.leg_2_ms == 0
    return ended and (axis.profile != MOVE or axis.position_demand == axis.target_position)
