"""RARS's own interlocks and limits, beside the common ones of `firmware_bridge.safety.common`.

Sources: A. P. Das, PhD thesis, IIT Delhi, 2018, 2.3.1 (tipping, acceleration), 4.2, 4.2.1 and Tab. 2.1
(speed, turn, lift); the times are choices of this project.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final, TypeAlias

from firmware_bridge.motion import davis, scissor
from firmware_bridge.robot import Robot
from firmware_bridge.robots.rars.geometry import RarsGeometry, RarsLimits
from firmware_bridge.robots.rars.governor import Governor
from firmware_bridge.robots.rars.kinematics import BASE, BASE_MOVES_MPS, LIFT, known, ramp_of, rolls, steered
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.safety import interlock
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.limits import bounded
from firmware_bridge.units import MILLISECOND, STANDARD_GRAVITY, Nanoseconds

View: TypeAlias = interlock.View[RarsGeometry, RarsMotion, RarsState]
Interlock: TypeAlias = interlock.Interlock[RarsGeometry, RarsMotion, RarsState]
Limit: TypeAlias = interlock.Limit[RarsGeometry, RarsMotion, RarsState]

LIFT_CLEARS_AFTER: Final[Nanoseconds] = 200 * MILLISECOND
"""Longer than a set-point takes to become a measured speed, so that lift and wheels never overlap."""
RETRACTED_SHARE: Final = 0.8
"""An extended lift counts as retracted again below this share of the height at which it tripped."""
LIFT_MOVES_RAD_S: Final = 0.10
"""Speed of the screw that counts as moving: one turn a minute, 24 um/s at the foot."""
LIFT_STANDSTILL_RAD_S: Final = 0.05
BASE_STANDSTILL_MPS: Final = 0.005
LIMIT_CLEARS_AFTER: Final[Nanoseconds] = 300 * MILLISECOND
"""A limit is reported for at least this long, so that a stick at its edge does not flicker."""
SPEED_TOLERANCE_MPS: Final = 1e-4
"""A step that the ramp shortens by less is not reported; the drives' speed comes in whole rpm, 0.2 mm/s."""
_DEGREES: Final = 180.0 / math.pi


def _steer_unknown(view: View) -> str | None:
    return None if known(view.body.steer_rad) else "the actual steer angle is not known"


def _lift_unknown(view: View) -> str | None:
    return None if known(view.body.lift_m) else "the actual lift height is not known"


def _tilt_unknown(view: View) -> str | None:
    balance = view.geometry.balance
    if balance is None or view.body.tilt_rad is not None:
        return None
    return f"its tilt is not known: no reading of '{balance.pitch}' and '{balance.roll}'"


def _load_implausible(view: View) -> str | None:
    """Judge the mass by currents and IMU: every margin rests on what the robot file states of the load."""
    balance, mass = view.geometry.balance, view.body.mass_kg
    if balance is None or balance.weighing is None or mass is None:
        return None
    most = (1.0 + balance.weighing.tolerance) * balance.heaviest_kg
    if mass <= most:
        return None
    return (
        f"by currents and IMU it weighs {mass:.0f} kg, with payload_kg {balance.heaviest_kg:.1f} kg; "
        f"limit {most:.0f} kg"
    )


def _lift_extended(view: View) -> str | None:
    if view.geometry.balance is not None and view.geometry.balance.lift_while_driving:
        return None
    height, limit = view.body.lift_m, view.geometry.limits.lift_retracted_m
    if height is None or height <= (RETRACTED_SHARE * limit if view.was_active else limit):
        return None
    return f"the lift stands at {1000.0 * height:.0f} mm, retracted is below {1000.0 * limit:.0f} mm"


def _lift_moves(view: View) -> str | None:
    # From the command on, before the screw is measured to turn: lift and base never overlap.
    if view.before is not None and LIFT in view.before.requested:
        return "the lift has been commanded to move"
    limit = LIFT_STANDSTILL_RAD_S if view.was_active else LIFT_MOVES_RAD_S
    turning = view.body.screw_rad_s
    if turning is None or abs(turning) <= limit:
        return None
    return f"the lift's screw turns with {turning:.2f} rad/s"


def _base_drives(view: View) -> str | None:
    """Judge a lift that is commanded to move, once it is known how fast the base may drive now."""
    if LIFT not in view.requested:
        return None
    speed = rolls(view.geometry.base, view.body)
    # Written so that a NaN trips.
    if not abs(speed) <= (BASE_STANDSTILL_MPS if view.was_active else BASE_MOVES_MPS):
        return f"the robot drives with {speed:.2f} m/s"
    if view.seen.commanded.speed_mps != 0.0:
        return f"the robot is commanded to drive with {view.seen.commanded.speed_mps:.2f} m/s"
    if view.allowed.speed_mps != 0.0:
        return f"the robot is requested to drive with {view.allowed.speed_mps:.2f} m/s"
    return None


INTERLOCKS: Final = (
    Interlock(
        "steer angle unknown",
        _steer_unknown,
        "wait for the steering drive's position",
        severity=Severity.ERROR,
    ),
    Interlock(
        "lift height unknown", _lift_unknown, "wait for the lift drive's position", severity=Severity.ERROR
    ),
    Interlock(
        "tilt unknown", _tilt_unknown, "check the IMU, its power and its cable", severity=Severity.ERROR
    ),
    Interlock(
        "load implausible",
        _load_implausible,
        "take the load off, or state it as geometry.balance.payload_kg; then arm",
        clear_after=LIMIT_CLEARS_AFTER,
        severity=Severity.CRITICAL,
        disarms=True,
    ),
    Interlock(
        "lift extended",
        _lift_extended,
        "retract the lift",
        stops=frozenset({BASE}),
        # A lift that stands extended comes down only when the robot is armed.
        blocks_arming=False,
    ),
    Interlock(
        "lift moving",
        _lift_moves,
        "let the lift come to rest at the requested height",
        stops=frozenset({BASE}),
        clear_after=LIFT_CLEARS_AFTER,
        blocks_arming=False,
    ),
    Interlock(
        "lift refused",
        _base_drives,
        "stop the robot before the lift moves",
        stops=frozenset({LIFT}),
        clear_after=LIFT_CLEARS_AFTER,
        blocks_arming=False,
        after_limits=True,
    ),
)


def tipping_speed(robot: Robot[RarsGeometry], steer_rad: float) -> float:
    """Return the speed in m/s at which the turn tips the robot over, sqrt(R g d / Zcg) (2.7)."""
    base = robot.geometry.base
    radius = davis.turn_radius(base, steer_rad)
    return math.sqrt(
        radius * STANDARD_GRAVITY * (base.half_support_width_m / base.centre_of_gravity_height_m)
    )


def _tipping_speed(view: View) -> float:
    # The turn actually steered, not the one commanded: the wheels may still be on their way.
    steer = view.body.steer_rad
    return tipping_speed(view.robot, steer) if steer is not None and math.isfinite(steer) else 0.0


def _clip(
    motion: RarsMotion, field: str, high: float, unit: str, *, low: float | None = None, scale: float = 1.0
) -> tuple[RarsMotion, str | None]:
    """Return the motion with one of its numbers within bounds, the same where it is; see `bounded`."""
    requested: float | None = getattr(motion, field)
    if requested is None:
        return motion, None
    allowed, reason = bounded(requested, high, unit, low=low, scale=scale)
    # The same object where nothing was clipped: the evaluation compares by identity.
    clipped: dict[str, Any] = {} if allowed == requested else {field: allowed}
    return (replace(motion, **clipped) if clipped else motion), reason


def clip_speed(view: View, high: float) -> tuple[RarsMotion, str | None]:
    """Clip the base's speed, in m/s."""
    return _clip(view.allowed, "speed_mps", high, "m/s")


def slowed(view: View, share: float) -> tuple[RarsMotion, str | None]:
    """Clip the base's speed to a share of its top; the lift stays where the robot is."""
    return clip_speed(view, share * view.geometry.limits.speed_mps)


def clip_steer(view: View, high: float) -> tuple[RarsMotion, str | None]:
    """Clip the steer angle, in rad."""
    return _clip(view.allowed, "steer_rad", high, "deg", scale=_DEGREES)


def _margin(view: View) -> tuple[RarsMotion, str | None]:
    """Clip the speed to what the standing margin allows, at rest and in the turn that is steered."""
    motion = view.allowed
    if view.geometry.balance is None or motion.speed_mps == 0.0:
        return motion, None
    bend = davis.curvature(view.geometry.base, steered(view.body))
    governor = Governor(view.geometry)
    high = governor.top_speed(view.body, motion.speed_mps, bend)
    if abs(motion.speed_mps) <= high:
        return motion, None
    margin = view.body.margin_m
    stands = "" if margin is None else f"the standing margin is {1000.0 * margin:.0f} mm"
    reason = f"requested {motion.speed_mps:.2f} m/s, allowed is {high:.2f} m/s"
    why = governor.slides(view.body) or stands
    slower = replace(motion, speed_mps=math.copysign(high, motion.speed_mps))
    return slower, f"{reason}, {why}" if why else reason


def _lift_margin(view: View) -> tuple[RarsMotion, str | None]:
    """Clip what raises the table beyond where the robot still stands firmly; down it may always go."""
    motion, now = view.allowed, view.body.lift_m
    if view.geometry.balance is None:
        return motion, None
    highest = Governor(view.geometry).highest_lift(view.body)
    if now is None or highest == math.inf:
        return motion, None
    reason = f"the table may rise to {1000.0 * max(highest, 0.0):.0f} mm here, it is at {1000.0 * now:.0f} mm"
    if motion.lift_m is not None and motion.lift_m > max(highest, now):
        return replace(motion, lift_m=max(min(highest, motion.lift_m), now)), reason
    if motion.lift_rate_mps > 0.0 and now >= highest:
        return replace(motion, lift_rate_mps=0.0), reason
    return motion, None


def _lift_rate(view: View, high: float) -> tuple[RarsMotion, str | None]:
    return _clip(view.allowed, "lift_rate_mps", high, "m/s")


def _lift_range(view: View) -> tuple[RarsMotion, str | None]:
    return _clip(view.allowed, "lift_m", scissor.highest(view.geometry.lift), "m", low=0.0)


def _acceleration(view: View, limits: RarsLimits) -> tuple[RarsMotion, str | None]:
    """Clip nothing, the ramp does; say where it will take more than one cycle."""
    commanded, speed = view.seen.commanded.speed_mps, view.allowed.speed_mps
    ramp = ramp_of(view.robot, limits)
    bend = davis.curvature(view.geometry.base, steered(view.body))
    # Reported where the ramp cannot get there in one cycle; the ramp itself limits.
    if abs(speed - ramp.step(commanded, speed, bend, ramp.longest_step)) <= SPEED_TOLERANCE_MPS:
        return view.allowed, None
    limit = limits.acceleration_mps2
    return (
        view.allowed,
        f"requested a step from {commanded:.2f} to {speed:.2f} m/s at once, limit {limit:.2f} m/s2",
    )


def _limit(
    name: str,
    clip: Callable[[View], tuple[RarsMotion, str | None]],
    remedy: str,
    severity: Severity = Severity.WARNING,
) -> Limit:
    return Limit(name, clip, remedy, clear_after=LIMIT_CLEARS_AFTER, severity=severity)


def limits_by(of: Callable[[RarsGeometry], RarsLimits]) -> tuple[Limit, ...]:
    """Return the limits in the order in which they are applied; a later one sees what an earlier one left."""

    def limits(view: View) -> RarsLimits:
        return of(view.geometry)

    return (
        _limit("speed limit", lambda view: clip_speed(view, limits(view).speed_mps), "reduce the speed"),
        _limit(
            "tipping limit",
            lambda view: clip_speed(view, _tipping_speed(view)),
            "reduce steer angle or speed",
        ),
        _limit(
            "steer angle limit", lambda view: clip_steer(view, limits(view).steer_angle_rad), "steer less"
        ),
        _limit(
            "turn radius limit", lambda view: clip_steer(view, view.geometry.tightest_steer_rad), "steer less"
        ),
        _limit(
            "lift rate limit",
            lambda view: _lift_rate(view, limits(view).lift_rate_mps),
            "reduce the lift rate",
        ),
        _limit("lift range limit", _lift_range, "request a height within reach"),
        _limit("lift margin limit", _lift_margin, "lower the table, or stand on flatter floor"),
        _limit("margin limit", _margin, "drive the other way, steer less, or lower the table"),
        _limit(
            "acceleration limit",
            lambda view: _acceleration(view, limits(view)),
            "change the speed more slowly",
            Severity.INFO,
        ),
    )


LIMITS: Final = limits_by(lambda geometry: geometry.limits)
