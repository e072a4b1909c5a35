"""The axis's own interlocks and limits, beside the common ones of `firmware_bridge.safety.common`."""

import math
from collections.abc import Callable
from typing import Final, TypeAlias

from firmware_bridge.robot import CommandForm
from firmware_bridge.robots.servo_axis.geometry import AxisGeometry
from firmware_bridge.robots.servo_axis.kinematics import AXIS
from firmware_bridge.robots.servo_axis.motion import AxisMotion, AxisState
from firmware_bridge.safety import interlock
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.limits import bounded
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

View: TypeAlias = interlock.View[AxisGeometry, AxisMotion, AxisState]
Interlock: TypeAlias = interlock.Interlock[AxisGeometry, AxisMotion, AxisState]
Limit: TypeAlias = interlock.Limit[AxisGeometry, AxisMotion, AxisState]

CLEARS_AFTER: Final[Nanoseconds] = 300 * MILLISECOND
OUTSIDE: Final = 0.02
"""Share of its travel beyond an end at which the axis is where no command put it."""
LAG_S: Final = 0.2
"""Time from a lower set-point to an axis that slows down (assumed): above the 0.15 s of a regulator's lag."""
TOLERANCE: Final = 1e-4
"""Share of the speed limit by which the ramp may shorten a step without a report."""


def _position_unknown(view: View) -> str | None:
    position = view.body.position
    known = position is not None and math.isfinite(position)
    return None if known else "the position of the axis is not known"


def _outside(view: View) -> str | None:
    axis, position = view.robot.axis(AXIS), view.body.position
    # Of an axis whose zero is lost no one knows where it is: one cause, one interlock.
    if axis.travel is None or position is None or view.facts.axes[axis.name].reference_lost:
        return None
    low, high = axis.travel
    slack = OUTSIDE * (high - low)
    # Written so that a NaN trips.
    if low - slack <= position <= high + slack:
        return None
    return f"the axis stands at {position:.4g} {axis.unit}, its travel is {low:.4g} to {high:.4g} {axis.unit}"


INTERLOCKS: Final = (
    Interlock(
        "position unknown",
        _position_unknown,
        "look whether the drive reports",
        clear_after=CLEARS_AFTER,
        severity=Severity.CRITICAL,
        disarms=True,
    ),
    Interlock(
        "axis outside",
        _outside,
        "look where the axis stands, and confirm it or home it; or take it back without power",
        clear_after=CLEARS_AFTER,
        severity=Severity.CRITICAL,
        disarms=True,
    ),
)


def slowed(view: View, share: float) -> tuple[AxisMotion, str | None]:
    """Clip the speed to a share of its top."""
    motion, unit = view.allowed, view.robot.axis(AXIS).unit
    speed, reason = bounded(motion.speed, share * view.geometry.limits.speed, f"{unit}/s")
    return AxisMotion(speed, motion.target), reason


def _stops_within(distance: float, acceleration: float) -> float:
    """Return the highest speed from which the axis stops within a distance, after the lag of its drive."""
    lag = LAG_S * acceleration
    return math.sqrt(lag * lag + 2.0 * acceleration * distance) - lag if distance > 0.0 else 0.0


def _travel_by_speed(view: View) -> tuple[AxisMotion, str | None]:
    """Clip the speed so that the axis stops at its end."""
    motion, axis, position = view.allowed, view.robot.axis(AXIS), view.body.position
    if motion.target is not None:
        return AxisMotion(), "an axis that is commanded by speed goes to no position"
    if axis.travel is None or position is None:
        return motion, None
    low, high = axis.travel
    left = high - position if motion.speed > 0.0 else position - low
    speed, reason = bounded(
        motion.speed, _stops_within(left, view.geometry.limits.acceleration), f"{axis.unit}/s"
    )
    return AxisMotion(speed), reason


def _travel(view: View) -> tuple[AxisMotion, str | None]:
    """Clip a target to the travel, and let no speed lead further out than its end."""
    motion, axis = view.allowed, view.robot.axis(AXIS)
    if axis.command is CommandForm.SPEED:
        return _travel_by_speed(view)
    # The robot file gives every axis by position its travel.
    low, high = axis.travel or (-math.inf, math.inf)
    if motion.target is not None:
        target = min(max(motion.target, low), high)
        if target == motion.target:
            return motion, None
        reason = f"requested {motion.target:.4g} {axis.unit}, allowed is {target:.4g} {axis.unit}"
        return AxisMotion(motion.speed, target), reason
    position = view.body.position
    if position is None or motion.speed == 0.0:
        return motion, None
    ahead = motion.speed * to_seconds(view.robot.cycle)
    if low <= position + ahead <= high or (position > high) is (ahead < 0.0) is (position > low):
        return motion, None
    end = high if ahead > 0.0 else low
    return AxisMotion(math.copysign(view.geometry.limits.speed, motion.speed), end), (
        f"the axis is at the end of its travel, {end:.4g} {axis.unit}"
    )


def _acceleration(view: View) -> tuple[AxisMotion, str | None]:
    """Clip nothing, the ramp does; report where it will take more than one cycle."""
    motion, axis, limits = view.allowed, view.robot.axis(AXIS), view.geometry.limits
    # Towards a target the speed is the limit's, and the ramp is meant.
    if motion.target is not None:
        return motion, None
    change = abs(motion.speed - view.seen.commanded.speed)
    if change <= limits.acceleration * to_seconds(view.robot.cycle) + TOLERANCE * limits.speed:
        return motion, None
    return motion, f"requested a change of {change:.3g} {axis.unit}/s at once"


def _limit(
    name: str,
    clip: Callable[[View], tuple[AxisMotion, str | None]],
    remedy: str,
    severity: Severity = Severity.WARNING,
) -> Limit:
    return Limit(name, clip, remedy, clear_after=CLEARS_AFTER, severity=severity)


LIMITS: Final = (
    _limit("speed limit", lambda view: slowed(view, 1.0), "reduce the speed"),
    _limit("travel limit", _travel, "take the axis back inside"),
    _limit("acceleration limit", _acceleration, "change the speed more slowly", Severity.INFO),
)
"""Applied in this order; a later one sees what an earlier one left."""
