"""The tank's surface as the bridge knows it: unrolled, and how two wheels turn on it.

A cylinder unrolls without stretching, so a pose on it is a pose on a plane: x is the arc, y the height, the
heading counts from the arc towards the axis, seen from outside. Only the track is another one: wheels that
stand on a bent surface touch it nearer to each other than their axle is long, the more the joint is turned.
"""

import math
from typing import Final

from firmware_bridge.drivers.driver import SeenPose
from firmware_bridge.motion.captured import Source
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robots.climber.geometry import ClimberGeometry
from firmware_bridge.robots.climber.motion import ClimberMotion, ClimberState
from firmware_bridge.safety.snapshot import Snapshot

FLAT_PER_M: Final = 1e-6
"""Below this curvature along the axle the track is that of a plane."""


def unrolled(geometry: ClimberGeometry, seen: SeenPose, near: Pose) -> Pose:
    """Return the pose on the unrolled surface of a robot that cameras see in the room.

    The arc is that of the turn round the tank which is nearest to the robot's assumed position. How far off
    the tank's axis its body is does not matter: it stands on the surface, wherever its pivot is above it.
    """
    tank = geometry.tank
    x, y, height = seen.position
    round_it = math.atan2(y - tank.axis_y_m, x - tank.axis_x_m)
    # The cameras see the angle only; how often the robot went round follows from where it is assumed.
    turns = math.tau * round((near.x_m / tank.radius_m - round_it) / math.tau)
    # The way ahead in the room, along the arc and along the axis.
    qx, qy, qz, qw = seen.attitude
    ahead = 1.0 - 2.0 * (qy * qy + qz * qz), 2.0 * (qx * qy + qz * qw), 2.0 * (qx * qz - qy * qw)
    along = ahead[1] * math.cos(round_it) - ahead[0] * math.sin(round_it)
    return Pose(tank.radius_m * (round_it + turns), height, math.atan2(ahead[2], along))


def place_of(geometry: ClimberGeometry, seen: Snapshot[ClimberMotion, ClimberState]) -> Pose | None:
    """Return its pose on the unrolled tank; None where that is the cameras', and they have not seen it."""
    located = seen.located
    if located is None:
        return placed(geometry, seen.pose)
    return None if located.source is Source.UNSEEN else located.pose


def track_on(geometry: ClimberGeometry, heading_rad: float, joint_rad: float | None = None) -> float:
    """Return the track in m, along the surface, of a robot that looks so and whose joint is at an angle.

    Across the robot the surface is a circle of radius r = r_c / sin^2(heading). Each half, turned by half of
    the joint's angle j, puts the middle of its wheel's cross-section (r_t thick, its centers on a ring of
    r_m) at x = b cos(j / 2) - r_m sin(j / 2) from the robot's middle; the contact is at
    asin(x / (r + r_t)) round.
    Without an angle both wheels stand upright.
    """
    base = geometry.base
    half, crown = 0.5 * base.track_m, base.crown_radius_m
    bend = math.sin(heading_rad) ** 2 / geometry.tank.radius_m
    lean = (
        # Upright on a bent surface each wheel leans by half of the angle between both.
        math.atan(half * bend / (1.0 + base.wheel_radius_m * bend)) if joint_rad is None else 0.5 * joint_rad
    )
    x = half * math.cos(lean) - (base.wheel_radius_m - crown) * math.sin(lean)
    # On a plane both formulas give the same, and the other one divides 0 by 0.
    if bend < FLAT_PER_M:
        return 2.0 * x
    return 2.0 * math.asin(x * bend / (1.0 + crown * bend)) / bend


def planar_motion(
    geometry: ClimberGeometry, speed_mps: float, turn_rad_s: float, heading_rad: float, joint_rad: float
) -> tuple[float, float]:
    """Return the speed and turn rate on a plane whose wheel speeds give the chassis these on the tank.

    Ahead the surface bends by k = cos^2(heading) / r_c. The axle's middle, r_w above it, is faster than the
    contacts by 1 + r_w k. The chassis leans aside by half of the joint's angle j, so the turn k v about its
    axle, with which it follows the surface, has a part about its up; the heading makes up for it. Terms of
    second order, as of the pitch, are left out: on 20 half tracks it is within 0.8 % of exact rolling.
    """
    bend = math.cos(heading_rad) ** 2 / geometry.tank.radius_m
    speed = speed_mps / (1.0 + geometry.base.wheel_radius_m * bend)
    lean = 0.5 * joint_rad
    turn = (turn_rad_s + geometry.joint.place * math.sin(lean) * speed * bend) / math.cos(lean)
    return speed, turn * track_on(geometry, heading_rad, joint_rad) / geometry.base.track_m


def placed(geometry: ClimberGeometry, rolled: Pose) -> Pose:
    """Return the pose on the unrolled surface of a robot with the robot file's start pose."""
    start = geometry.start
    turn = start.heading_rad
    cosine, sine = math.cos(turn), math.sin(turn)
    return Pose(
        rolled.x_m * cosine - rolled.y_m * sine,
        start.height_m + rolled.x_m * sine + rolled.y_m * cosine,
        rolled.heading_rad + turn,
    )
