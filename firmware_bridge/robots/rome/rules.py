"""ROME's own interlock and limits, beside the common ones of `firmware_bridge.safety.common`."""

import math
from collections.abc import Callable
from typing import Final, TypeAlias

from firmware_bridge.families.motor_shield.settings import ShieldAxis, ShieldLink
from firmware_bridge.motion.omni import BodyTwist, rims, shortened
from firmware_bridge.robot import Robot
from firmware_bridge.robots.rome.geometry import RomeGeometry
from firmware_bridge.robots.rome.kinematics import ramp_of, with_twist
from firmware_bridge.robots.rome.motion import RomeMotion, RomeState
from firmware_bridge.safety import interlock
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.limits import ROUNDING, bounded
from firmware_bridge.units import MILLISECOND, Nanoseconds

View: TypeAlias = interlock.View[RomeGeometry, RomeMotion, RomeState]
Interlock: TypeAlias = interlock.Interlock[RomeGeometry, RomeMotion, RomeState]
Limit: TypeAlias = interlock.Limit[RomeGeometry, RomeMotion, RomeState]

SPIN: Final = 1.5
"""Factor above its limit at which a base turns without a command."""
CLEARS_AFTER: Final[Nanoseconds] = 300 * MILLISECOND
TOLERANCE: Final = 1e-4
"""A step that the ramp shortens by less, in m/s or rad/s, is not reported."""


def _turns_too_fast(view: View) -> str | None:
    limit, turn = view.geometry.limits.turn_rate_rad_s, view.body.turn_rad_s
    # Trips above a multiple of the limit and clears at the limit itself, so that it does not flicker.
    if abs(turn) <= (limit if view.was_active else SPIN * limit):
        return None
    return f"the base turns with {turn:.2f} rad/s, limit {limit:.2f} rad/s"


def _pose_lost(view: View) -> str | None:
    """Judge where a path follower needs the pose, or a wheel whose encoder is not read.

    An operator sees the base himself, but not that such a wheel slips or stands.
    """
    located = view.seen.located
    if located is None or located.reason is None:
        return None
    return located.reason if view.seen.command.path_s is not None or _uncounted(view.robot) else None


def _uncounted(robot: Robot[RomeGeometry]) -> bool:
    return any(ShieldAxis.of(axis).port > ShieldLink.of_link(robot, axis.link).counted for axis in robot.axes)


def _slips(view: View) -> str | None:
    """Judge the cameras' velocity against the wheels', or, without an encoder, their set-points'."""
    located, known = view.seen.located, view.robot.located_by
    if located is None or known is None or located.slip_mps <= known[1].slip_mps:
        return None
    bound = known[1].slip_mps
    return f"the base moves {located.slip_mps:.2f} m/s apart from its wheels' speed, limit {bound:.2f} m/s"


INTERLOCKS: Final = (
    Interlock(
        "base slips",
        _slips,
        "look for a wheel that is blocked, lifted or without its motor, then arm",
        clear_after=CLEARS_AFTER,
        severity=Severity.CRITICAL,
        disarms=True,
    ),
    Interlock(
        "pose lost",
        _pose_lost,
        "look what hides it from the cameras; where it was carried elsewhere, set its home again",
        clear_after=CLEARS_AFTER,
        severity=Severity.CRITICAL,
        blocks_arming=False,
    ),
    Interlock(
        "turns too fast",
        _turns_too_fast,
        "look for a wheel that is blocked or lifted, then arm",
        clear_after=CLEARS_AFTER,
        severity=Severity.CRITICAL,
        disarms=True,
    ),
)


def slowed(view: View, share: float) -> tuple[RomeMotion, str | None]:
    """Clip the speed to a share of its top; to turn takes the base nowhere."""
    motion, high = view.allowed, share * view.geometry.limits.setpoint_mps
    speed = math.hypot(motion.ahead_mps, motion.left_mps)
    allowed, reason = bounded(speed, high, "m/s")
    # Both components by one share, so that the direction stays.
    share = allowed / speed if speed > high else 1.0
    wanted = BodyTwist(share * motion.ahead_mps, share * motion.left_mps, motion.turn_rad_s)
    return with_twist(motion, wanted), reason


def _turn(view: View) -> tuple[RomeMotion, str | None]:
    motion = view.allowed
    allowed, reason = bounded(motion.turn_rad_s, view.geometry.limits.turn_rate_rad_s, "rad/s")
    return with_twist(motion, motion.twist._replace(turn=allowed)), reason


def _rim(view: View) -> tuple[RomeMotion, str | None]:
    motion, high = view.allowed, view.geometry.limits.rim_mps
    distance = view.geometry.base.wheel_distance_m
    fastest = max(map(abs, rims(motion.twist, distance)))
    allowed = with_twist(motion, shortened(motion.twist, distance, high))
    if fastest <= high * (1.0 + ROUNDING):
        return allowed, None
    return allowed, f"requested {fastest:.2f} m/s at a wheel, allowed is {high:.2f} m/s"


def _acceleration(view: View) -> tuple[RomeMotion, str | None]:
    """Clip nothing, the ramp does; say where it will take more than one cycle."""
    commanded, requested = view.seen.commanded, view.allowed
    near = ramp_of(view.robot).step(commanded.twist, requested.twist, view.robot.cycle)
    if max(abs(new - old) for old, new in zip(near, requested.twist, strict=True)) <= TOLERANCE:
        return requested, None
    return requested, f"requested a step from {_text_of(commanded)} to {_text_of(requested)} at once"


def _text_of(motion: RomeMotion) -> str:
    return f"({motion.ahead_mps:.2f}, {motion.left_mps:.2f}) m/s and {motion.turn_rad_s:.2f} rad/s"


def _limit(
    name: str,
    clip: Callable[[View], tuple[RomeMotion, str | None]],
    remedy: str,
    severity: Severity = Severity.WARNING,
) -> Limit:
    return Limit(name, clip, remedy, clear_after=CLEARS_AFTER, severity=severity)


LIMITS: Final = (
    _limit("speed limit", lambda view: slowed(view, 1.0), "reduce the speed"),
    _limit("turn rate limit", _turn, "turn more slowly"),
    _limit("rim limit", _rim, "reduce turn rate or speed"),
    _limit("acceleration limit", _acceleration, "change speed and turn more slowly", Severity.INFO),
)
"""Applied in this order; a later one sees what an earlier one left."""
