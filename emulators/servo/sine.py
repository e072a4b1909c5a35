"""The sin2 profile of one axis: its legs are planned beforehand, and run one millisecond at a time.

A profile is a chain of at most four legs, each from one velocity to another along a sin2, in an odd number of
ms (a leg at constant velocity in any number). The second half of a leg mirrors the first, so that its
distance is known exactly beforehand, in spite of rounding: the legs end exactly at their target.

A leg's peak acceleration is the one that was given, so that it takes pi/2 times as long as a trapezoid's ramp
(assumed: no document states if maxon's sin2 profile keeps the peak or the mean acceleration; the peak is the
limit that the mechanics know). A profile that is changed under way goes on from the present velocity with a
new leg (assumed): the velocity is continuous, and the acceleration within its limits.
"""

from dataclasses import dataclass
from typing import Final

from emulators.servo.axis import MOVE, SINE, ServoAxis

SHARE_PLACES: Final = 31
# (1 - cos(pi x)) / 2 in powers of x2, alternating; SHARE_PLACES binary places. Up to x = 1/2 exact to 2^-30.
SINE_1: Final = 5_298_703_516
SINE_2: Final = 4_358_008_962
SINE_3: Final = 1_433_727_481
SINE_4: Final = 252_684_340
SINE_5: Final = 27_709_939
SINE_6: Final = 2_071_865
SINE_7: Final = 112_354

_HALF_PI: Final = 1_686_629_713
_HALF_PI_PLACES: Final = 30
ROUNDING: Final = 4
"""Reserve for the effect of rounding on a leg's acceleration, in acceleration units (some 0.2 rpm/s)."""
_SPLITS: Final = 16
_ATTEMPTS: Final = 8
_MOST_LEGS: Final = 4


@dataclass(frozen=True, slots=True)
class ProfileLeg:
    """A part of the profile: the velocity at its end, in velocity units, and how long it takes, in ms."""

    to: int
    ms: int


@dataclass(frozen=True, slots=True)
class Plan:
    """Consecutive legs; in the first `spare` ms one unit is added (taken off where it is negative).

    Straight ahead it is taken off: a limit of the velocity is not passed by a single unit.
    """

    legs: tuple[ProfileLeg, ...]
    spare: int = 0

    def mirrored(self) -> "Plan":
        """Return the same in the other direction."""
        return Plan(tuple(ProfileLeg(-leg.to, leg.ms) for leg in self.legs), -self.spare)


@dataclass(frozen=True, slots=True)
class ProfileLimits:
    """Limits of a move, in velocity units and acceleration units."""

    cruise: int
    acceleration: int
    deceleration: int


def duration(change: int, acceleration: int) -> int:
    """Return the ms of a leg that changes the velocity so much with this peak acceleration: an odd number."""
    # The peak of a sin2 ramp is pi/2 times its mean: in fixed point, rounded up, made odd by `| 1`.
    usable = max(1, acceleration - ROUNDING) << _HALF_PI_PLACES
    return max(1, -(-abs(change) * _HALF_PI // usable)) | 1


def ramp(speed: int, target: int, limits: ProfileLimits) -> Plan:
    """Plan the way from one velocity to another; a reversal passes through 0."""
    if speed == target:
        return Plan(())
    if (speed < 0) != (target < 0) and speed and target:
        down = ProfileLeg(0, duration(speed, limits.deceleration))
        return Plan((down, ProfileLeg(target, duration(target, limits.acceleration))))
    slower = abs(target) < abs(speed)
    return Plan(
        (
            ProfileLeg(
                target, duration(target - speed, limits.deceleration if slower else limits.acceleration)
            ),
        )
    )


def move(way: int, speed: int, limits: ProfileLimits) -> Plan:
    """Plan the way to rest exactly `way` position units from here, beginning with this speed.

    Where the way is too short to brake, or leads back, the axis comes to rest first and returns.
    """
    if way < 0 or (way == 0 and speed < 0):
        return move(-way, -speed, limits).mirrored()
    if limits.cruise == 0:
        return ramp(speed, 0, limits)
    if speed == 0:
        return _approach(way, 0, limits) if way else Plan(())
    braking = duration(speed, limits.deceleration)
    covered = braking // 2 * speed
    if speed > 0 and covered == way:
        return Plan((ProfileLeg(0, braking),))
    if speed > 0 and covered < way:
        plan = _approach(way, speed, limits)
        if plan.legs:
            return plan
    back = move(way - covered, 0, limits)
    return Plan((ProfileLeg(0, braking), *back.legs), back.spare)


def _approach(way: int, speed: int, limits: ProfileLimits) -> Plan:
    """Plan a move straight ahead; no legs where none are found."""
    top = limits.cruise
    if speed <= top:
        top = _fastest(way, speed, top, limits)
    splits = (speed * part // _SPLITS for part in reversed(range(_SPLITS))) if speed else ()
    for height in (top, speed, *splits):
        plan = _fitted(way, speed, max(1, height), limits)
        if plan is not None:
            return plan
    return Plan(())


def _fastest(way: int, speed: int, top: int, limits: ProfileLimits) -> int:
    """Return the fastest cruise between `speed` and `top` from which the way suffices to brake."""
    low, high = speed, top
    while low < high:
        middle = (low + high + 1) // 2
        rise = duration(middle - speed, limits.acceleration)
        fall = duration(middle, limits.deceleration)
        # A leg of 2 n + 1 ms covers n times the sum of its end velocities, and its end itself.
        if rise // 2 * (speed + middle) + middle + fall // 2 * middle <= way:
            low = middle
        else:
            high = middle - 1
    return low


def _fitted(way: int, speed: int, top: int, limits: ProfileLimits) -> Plan | None:
    """Lower the cruise from `top` until rise, cruise and fall pass the way by less than one unit per ms."""
    height, rise, fall = top, 1, 1
    for _ in range(_ATTEMPTS):
        # Legs only grow from one attempt to the next, or two lengths could alternate for ever.
        rise = max(
            rise,
            duration(height - speed, limits.acceleration if height > speed else limits.deceleration),
        )
        fall = max(fall, duration(height, limits.deceleration))
        left = way - rise // 2 * speed
        if left < 0:
            return None
        weight = rise // 2 + 1 + fall // 2
        flat = max(0, -(-left // top) - weight)
        before, height = height, -(-left // (weight + flat))
        if (
            duration(height - speed, limits.acceleration if height > speed else limits.deceleration) <= rise
            and duration(height, limits.deceleration) <= fall
        ):
            level = (ProfileLeg(height, flat),) if flat else ()
            return Plan(
                (ProfileLeg(height, rise), *level, ProfileLeg(0, fall)), left - height * (weight + flat)
            )
        height = min(before, height)
    return None


def load(axis: ServoAxis) -> None:
    """Plan the axis' requested ramp or move, and give it the legs."""
    limits = ProfileLimits(axis.cruise, axis.acceleration, axis.deceleration)
    if axis.profile == MOVE:
        plan = move(axis.target_position - axis.position_demand, axis.velocity_demand, limits)
    else:
        plan = ramp(axis.velocity_demand, axis.target_velocity, limits)
    axis.shape = SINE
    empty = ProfileLeg(axis.velocity_demand, 0)
    first, second, third, fourth = (*plan.legs, *(empty,) * (_MOST_LEGS - len(plan.legs)))
    axis.leg_from, axis.leg_at = axis.velocity_demand, 0
    axis.leg_to, axis.leg_ms = first.to, first.ms
    axis.leg_2_to, axis.leg_2_ms = second.to, second.ms
    axis.leg_3_to, axis.leg_3_ms = third.to, third.ms
    axis.leg_4_to, axis.leg_4_ms = fourth.to, fourth.ms
    axis.leg_spare = plan.spare


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
