"""The climber's own interlocks and limits, beside the common ones of `firmware_bridge.safety.common`."""

import math
from dataclasses import replace
from typing import Final, TypeAlias

from firmware_bridge.differential.robot import CLEARS_AFTER
from firmware_bridge.motion.pose import Pose
from firmware_bridge.motion.ramp import MARGIN
from firmware_bridge.robots.climber.geometry import ClimberGeometry
from firmware_bridge.robots.climber.kinematics import CLIMBER
from firmware_bridge.robots.climber.motion import ClimberMotion, ClimberState
from firmware_bridge.robots.climber.surface import place_of
from firmware_bridge.safety import interlock
from firmware_bridge.safety.interlock_base import Severity

View: TypeAlias = interlock.View[ClimberGeometry, ClimberMotion, ClimberState]
Interlock: TypeAlias = interlock.Interlock[ClimberGeometry, ClimberMotion, ClimberState]
Limit: TypeAlias = interlock.Limit[ClimberGeometry, ClimberMotion, ClimberState]

ON_WALL: Final = 0.9
"""The share of the magnets' switches below which one is off."""


def _pose_lost(view: View) -> str | None:
    """Judge where a path follower needs the pose: an operator sees the robot himself."""
    located = view.seen.located
    if located is None or located.reason is None or view.seen.command.path_s is None:
        return None
    return located.reason


def _slips(view: View) -> str | None:
    """Judge the cameras' velocity against the wheels'."""
    located, known = view.seen.located, view.robot.located_by
    if located is None or known is None or located.slip_mps <= known[1].slip_mps:
        return None
    return (
        f"the robot moves {located.slip_mps:.3f} m/s apart from its wheels' speed, "
        f"limit {known[1].slip_mps:.3f} m/s"
    )


def _off_the_wall(view: View) -> str | None:
    on_wall = view.body.on_wall
    if on_wall is None:
        return "no sensor reports whether its magnets are on the wall"
    if on_wall >= ON_WALL:
        return None
    return f"{on_wall:.0%} of its magnets are on the wall"


INTERLOCKS: Final = (
    Interlock(
        "off the wall",
        _off_the_wall,
        "stand clear; put it back on the wall, then arm",
        clear_after=CLEARS_AFTER,
        severity=Severity.EMERGENCY,
        disarms=True,
    ),
    Interlock(
        "robot slips",
        _slips,
        "look whether it still holds to the wall, then arm",
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
    CLIMBER.turns_too_fast,
)


def _joint(view: View) -> tuple[ClimberMotion, str | None]:
    """Clip the speed the way in which the joint's angle grows; the other way it decays."""
    motion, joint = view.allowed, view.body.joint_rad
    high = view.geometry.joint.share(joint, motion.speed_mps) * view.geometry.limits.speed_mps
    if abs(motion.speed_mps) <= high:
        return motion, None
    known = "not known" if joint is None else f"{math.degrees(joint):.1f} deg"
    first = "nose" if motion.speed_mps > 0.0 else "tail"
    return replace(motion, speed_mps=math.copysign(high, motion.speed_mps)), (
        f"the joint's angle is {known}: requested {abs(motion.speed_mps):.3f} m/s {first} first, "
        f"allowed is {high:.3f} m/s"
    )


def _place(view: View) -> Pose | None:
    return place_of(view.geometry, view.seen)


def _place_unknown(view: View) -> tuple[ClimberMotion, str | None]:
    """Keep it where it is: how high it is, and how far its cable is drawn, no limit behind this one knows."""
    motion = view.allowed
    if _place(view) is not None or motion.speed_mps == 0.0:
        return motion, None
    speed = abs(motion.speed_mps)
    return replace(motion, speed_mps=0.0), (
        f"the cameras have not seen the robot yet: requested {speed:.3f} m/s, allowed is 0.000 m/s"
    )


def _braked(left_m: float, view: View) -> float:
    """Return the speed at which the robot comes to standstill within a way; 0 where nothing is left of it."""
    # v squared = 2 a s, with the share of the acceleration that the ramp uses.
    return math.sqrt(2.0 * MARGIN * view.geometry.limits.acceleration_mps2 * max(left_m, 0.0))


def _towards(view: View, share: float, left_m: float) -> ClimberMotion:
    """Return the motion that stops before a bound; it comes nearer with this share of the speed ahead."""
    motion = view.allowed
    if share * motion.speed_mps <= _braked(left_m, view):
        return motion
    # Share and speed have the same sign here, so the share is not 0.
    return replace(motion, speed_mps=_braked(left_m, view) / share)


def _height(view: View) -> tuple[ClimberMotion, str | None]:
    return _no_higher(view, view.geometry.limits.lowest_m, view.geometry.limits.highest_m, "")


def _adhesion(view: View) -> tuple[ClimberMotion, str | None]:
    """Stop where magnets and friction hold no more than the least margin of robot and cable."""
    wall = view.geometry.wall
    return _no_higher(
        view, -math.inf, wall.highest_m, f": the magnets hold {wall.heaviest_kg:.1f} kg, cable included"
    )


def _no_higher(view: View, low: float, high: float, why: str) -> tuple[ClimberMotion, str | None]:
    place, motion = _place(view), view.allowed
    if place is None:
        return motion, None
    up = math.sin(place.heading_rad)
    bound, share, left = (
        # Tail first it climbs while it looks down: heading and direction of travel decide together.
        (high, up, high - place.y_m) if up * motion.speed_mps > 0.0 else (low, -up, place.y_m - low)
    )
    allowed = _towards(view, share, left)
    if allowed is motion:
        return motion, None
    return allowed, f"it is {place.y_m:.2f} m high, and may not pass {bound:.2f} m{why}"


def _cable(view: View) -> tuple[ClimberMotion, str | None]:
    """Clip what draws the cable taut; it lies straight on the tank, from where arc and height are 0."""
    place, length = _place(view), view.geometry.wall.cable_m
    drawn = 0.0 if place is None else math.hypot(place.x_m, place.y_m)
    # At the origin no direction draws the cable.
    if place is None or drawn == 0.0:
        return view.allowed, None
    # The part of the speed that leads straight away from where the cable begins.
    share = (place.x_m * math.cos(place.heading_rad) + place.y_m * math.sin(place.heading_rad)) / drawn
    allowed = _towards(view, share, length - drawn)
    if allowed is view.allowed:
        return allowed, None
    return allowed, f"{drawn:.2f} m of the cable are drawn, it is {length:.2f} m long"


def _coupled(view: View) -> tuple[ClimberMotion, str | None]:
    motion = view.allowed
    if not view.geometry.base.coupled or motion.turn_rad_s == 0.0:
        return motion, None
    return replace(motion, turn_rad_s=0.0), (
        f"requested a turn of {motion.turn_rad_s:.2f} rad/s: one shaft turns both wheels"
    )


LIMITS: Final = (
    CLIMBER.speed_limit,
    Limit("joint limit", _joint, "drive the other way, or turn round", clear_after=CLEARS_AFTER),
    Limit("coupled wheels", _coupled, "drive straight, nose first or tail first", clear_after=CLEARS_AFTER),
    Limit(
        "place unknown",
        _place_unknown,
        "look what hides it from the cameras; or drive it without them, by its odometry",
        clear_after=CLEARS_AFTER,
    ),
    Limit("height limit", _height, "drive the other way", clear_after=CLEARS_AFTER),
    Limit("adhesion limit", _adhesion, "drive down, or take weight off its cable", clear_after=CLEARS_AFTER),
    Limit("cable limit", _cable, "drive back, or give it a longer cable", clear_after=CLEARS_AFTER),
    CLIMBER.turn_rate_limit,
    CLIMBER.sideways_limit,
    CLIMBER.acceleration_limit,
)
"""Applied in this order; a later one sees what an earlier one left."""
