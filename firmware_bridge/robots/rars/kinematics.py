"""RARS's kinematic model: axes to the robot's state, and a motion to the axes' set-points (thesis 4.2).

The steer set-point follows from what is allowed; the wheel speeds follow from the ACTUAL steer angle.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

from firmware_bridge.drivers.driver import Feedback, Position, Reading, SetPoint, Speed
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.motion import davis, scissor
from firmware_bridge.motion.odometry import moved
from firmware_bridge.motion.pose import Pose
from firmware_bridge.motion.ramp import MARGIN, Ramp
from firmware_bridge.motion.tables import DavisBase
from firmware_bridge.robot import Robot
from firmware_bridge.robots.rars.geometry import RarsGeometry, RarsLimits
from firmware_bridge.robots.rars.governor import Governor
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.robots.rars.weighing import Weigher
from firmware_bridge.units import Nanoseconds, to_seconds

BASE: Final = "base"
LIFT: Final = "lift"
LEFT_WHEEL: Final = "left_wheel"
RIGHT_WHEEL: Final = "right_wheel"
STEERING: Final = "steering"
SCREW: Final = "lift"
GROUPS: Final = {BASE: frozenset({LEFT_WHEEL, RIGHT_WHEEL, STEERING}), LIFT: frozenset({SCREW})}
LED: Final = {STEERING: frozenset({LEFT_WHEEL, RIGHT_WHEEL})}
"""The wheels follow the angle that is steered, between the cycles too."""
GIVES_BACK: Final = 0.03
"""A turn that straightens gives its energy back to the wheels, which their regulators take up: the base grew
faster by 2.4 % of the change of its outer wheel's way against its own, measured on the plant at 0.5 m/s."""
GIVES_BACK_LEAST: Final = 0.012
"""Least share of the top speed that is kept for it while the turn straightens: with the rack at 49 mm/s the
base grew faster by up to 1.4 %, most at the end."""
STRAIGHTENS_FROM: Final = 0.004
"""Change of the outer wheel's way against the base's from which on a turn straightens: 0.02 1/m."""
TURNS_FOR_S: Final = 0.05
"""Time over which the change of the turn is taken: one cycle."""
TURNS_FROM_PER_M: Final = 0.02
"""Change of the curvature in that time from which on a turn counts as changing; a stick trembles by less."""
NOTHING: Final[frozenset[str]] = frozenset()

BASE_MOVES_MPS: Final = 0.010
"""Speed at which the base counts as driving; its encoders resolve 0.1 mm/s."""
LIFT_TOLERANCE_M: Final = 0.001
"""A lift this near to its commanded height has arrived: it holds its target, it does not move."""
LEASH_S: Final = 0.3
"""Largest lead of the lift's target, in seconds at the highest rate.

Near the top the screw is slower than the rate, and a target that ran away would go on after the stick is
neutral.
"""


def ramp_of(robot: Robot[RarsGeometry], limits: RarsLimits | None = None) -> Ramp:
    """Return the bounds of the base's speed, by these limits or by those of the whole robot."""
    limits, base = limits or robot.geometry.limits, robot.geometry.base
    return Ramp(MARGIN * limits.acceleration_mps2, base.rear_track_m / 2.0, robot.cycle)


class Rack:
    """The steering's way to its set-point: at its drive's profile velocity."""

    def __init__(self, robot: Robot[RarsGeometry]) -> None:
        steering = robot.axis(STEERING)
        self._base: Final = robot.geometry.base
        self.pinion_rad_s: Final = steering.settings.cruise(steering.ratio)

    def turning(self, steer_rad: float, bend_per_m: float, goal_rad: float | None) -> float:
        """Return how fast the curvature changes from an angle and its curvature to a goal, 1/(m s)."""
        if goal_rad is None:
            return 0.0
        base, most = self._base, self.pinion_rad_s * TURNS_FOR_S
        pinion, goal = (davis.pinion_from_steer(base, angle) for angle in (steer_rad, goal_rad))
        onward = davis.steer_from_pinion(base, pinion + min(max(goal - pinion, -most), most))
        change = abs(davis.curvature(base, onward) - bend_per_m)
        return 0.0 if change < TURNS_FROM_PER_M else change / TURNS_FOR_S


class Rars:
    """A `firmware_bridge.robot_type.Body`."""

    def __init__(self, robot: Robot[RarsGeometry], limits: RarsLimits | None = None) -> None:
        """Take the robot, and what narrows its limits."""
        limits = limits or robot.geometry.limits
        self._base = robot.geometry.base
        self._lift = robot.geometry.lift
        self._highest_m = scissor.highest(self._lift)
        self._rate_mps = limits.lift_rate_mps
        self._ramp = ramp_of(robot, limits)
        self._rack = Rack(robot)
        self._governor = Governor(robot.geometry)
        balance = robot.geometry.balance
        weighing = None if balance is None else balance.weighing
        self._top_mps = limits.speed_mps
        self._left = robot.axis(LEFT_WHEEL).name
        self._right = robot.axis(RIGHT_WHEEL).name
        self._weigher = None if weighing is None else Weigher(weighing, self._left, self._right)
        self._steering = robot.axis(STEERING).name
        self._screw = robot.axis(SCREW).name
        self.rolling: tuple[str, ...] = (self._left, self._right)
        """The axes from whose positions the pose is carried on."""

    def sensed(self, axes: Mapping[str, Feedback], sensors: Mapping[str, Reading]) -> RarsState:
        """Return angle, height, speeds and tilt."""
        steering, screw = axes[self._steering], axes[self._screw]
        left = axes[self._left].velocity * self._base.wheel_radius_m
        right = axes[self._right].velocity * self._base.wheel_radius_m
        steer = lift = turning = None
        # Before the first report the position is 0 by default, which is not a measured angle.
        if steering.received_at != NEVER_RECEIVED:
            steer = davis.steer_from_pinion(self._base, steering.position)
        if screw.received_at != NEVER_RECEIVED:
            lift = scissor.height_from_screw(self._lift, screw.position)
            turning = screw.velocity
        speed, yaw_rate = (left + right) / 2.0, (right - left) / self._base.rear_track_m
        tilt, mass = self._governor.tilt(sensors), None
        if self._weigher is not None:
            self._weigher.take(axes, sensors, speed)
            mass = self._weigher.mass_kg
        margin = self._governor.margin(lift, tilt)
        return RarsState(steer, lift, turning, speed, yaw_rate, tilt_rad=tilt, margin_m=margin, mass_kg=mass)

    def requested(self, motion: RarsMotion, state: RarsState) -> frozenset[str]:
        """Return the groups that the motion commands to move; a base that only steers is at standstill."""
        base = BASE if motion.speed_mps != 0.0 else ""
        lift = LIFT if _lift_requested(motion, state.lift_m) else ""
        return frozenset(group for group in (base, lift) if group)

    def moving(self, state: RarsState) -> frozenset[str]:
        """Return the base where a wheel of it rolls; the lift is judged by interlocks of its own."""
        return NOTHING if abs(rolls(self._base, state)) < BASE_MOVES_MPS else frozenset({BASE})

    def at_standstill(self, motion: RarsMotion, groups: frozenset[str]) -> RarsMotion:
        """Return the motion with base, lift or both at standstill: speed 0; the rest stays where it is."""
        if BASE in groups:
            motion = replace(motion, speed_mps=0.0, steer_rad=None)
        if LIFT in groups:
            motion = replace(motion, lift_m=None, lift_rate_mps=0.0)
        return motion

    def ramped(
        self, commanded: RarsMotion, allowed: RarsMotion, state: RarsState, elapsed: Nanoseconds
    ) -> RarsMotion:
        """Return the next set-point: the speed on its ramp in the turn actually steered, a near height."""
        bend = davis.curvature(self._base, steered(state))
        # Slower while the turn straightens: the energy of the turn goes into the base's speed.
        straightens = self._straightens(allowed, bend)
        kept = max(GIVES_BACK * straightens, GIVES_BACK_LEAST) if straightens > STRAIGHTENS_FROM else 0.0
        top = self._top_mps * (1.0 - kept)
        speed = min(max(allowed.speed_mps, -top), top)
        turning = self._rack.turning(steered(state), bend, allowed.steer_rad)
        before = commanded.speed_mps
        ramped = self._ramp.step(before, speed, bend, elapsed, turning)
        speed = self._governor.ramped(before, ramped, state, bend, to_seconds(elapsed))
        height = self._next_height(commanded.lift_m, allowed, state.lift_m, to_seconds(elapsed))
        return replace(allowed, speed_mps=speed, lift_m=height, lift_rate_mps=0.0)

    def set_points(self, motion: RarsMotion, state: RarsState) -> Mapping[str, SetPoint]:
        """Return the steering's set-point first, as in the thesis; the wheels follow the actual angle."""
        set_points: dict[str, SetPoint] = {}
        if motion.steer_rad is not None:
            set_points[self._steering] = Position(davis.pinion_from_steer(self._base, motion.steer_rad))
        set_points |= self._wheels(motion.speed_mps, davis.curvature(self._base, steered(state)))
        if motion.lift_m is not None:
            set_points[self._screw] = Position(scissor.screw_from_height(self._lift, motion.lift_m))
        return set_points

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        _sensors: Mapping[str, Reading],
    ) -> Pose:
        """Return the pose after both rear wheels rolled on."""
        left, right = (after[name].position - before[name].position for name in self.rolling)
        radius = self._base.wheel_radius_m
        return moved(pose, left * radius, right * radius, self._base.rear_track_m)

    def _wheels(self, speed_mps: float, bend_per_m: float) -> dict[str, SetPoint]:
        """Return the wheels' set-points for a curvature; each brakes by itself in proportion to its speed."""
        left, right = davis.wheel_speeds(self._base, speed_mps, bend_per_m)
        outer = max(abs(left), abs(right))
        # So a stop of the drives keeps the ratio, too.
        return {
            name: Speed(speed, abs(speed) / outer if outer else 1.0)
            for name, speed in ((self._left, left), (self._right, right))
        }

    def _straightens(self, allowed: RarsMotion, bend_per_m: float) -> float:
        """Return by how much less the outer wheel will go before the base than in the turn steered now."""
        if allowed.steer_rad is None:
            return 0.0
        # With the sign of the present turn: a turn to the other side counts as straight here.
        goal = math.copysign(1.0, bend_per_m) * davis.curvature(self._base, allowed.steer_rad)
        return max(abs(bend_per_m) - max(goal, 0.0), 0.0) * self._base.rear_track_m / 2.0

    def _next_height(
        self, before_m: float | None, allowed: RarsMotion, height_m: float | None, seconds: float
    ) -> float | None:
        """Return where the lift shall be now: a target that travels at its rate, near the platform."""
        if height_m is None or (allowed.lift_m is None and allowed.lift_rate_mps == 0.0):
            return None
        start = height_m if before_m is None else before_m
        if allowed.lift_m is None:
            target = start + allowed.lift_rate_mps * seconds
        else:
            reach = self._rate_mps * seconds
            target = min(max(allowed.lift_m, start - reach), start + reach)
        leash = self._rate_mps * LEASH_S
        # A target far ahead of the platform would go on after the stick is released.
        target = min(max(target, height_m - leash), height_m + leash)
        return min(max(target, 0.0), self._highest_m)


def reach(robot: Robot[RarsGeometry]) -> Iterator[tuple[RarsMotion, RarsState]]:
    """Yield full speed both ways at both full locks, straight ahead, and the lift at its ends."""
    geometry = robot.geometry
    lock = min(geometry.limits.steer_angle_rad, geometry.tightest_steer_rad)
    for steer in (-lock, 0.0, lock):
        for speed in (-geometry.limits.speed_mps, geometry.limits.speed_mps):
            for height in (0.0, scissor.highest(geometry.lift)):
                state = RarsState(steer, height, 0.0, speed, speed * davis.curvature(geometry.base, steer))
                yield RarsMotion(speed, steer, height), state


def _lift_requested(motion: RarsMotion, height_m: float | None) -> bool:
    if motion.lift_m is None:
        return motion.lift_rate_mps != 0.0
    # Written so that NaN counts as a motion.
    return height_m is None or not abs(motion.lift_m - height_m) <= LIFT_TOLERANCE_M


def rolls(base: DavisBase, state: RarsState) -> float:
    """Return the speed in m/s of the rear wheel that rolls faster, the way the base drives positive."""
    # The faster wheel of both: half the track times the turn always adds to the base's speed.
    return state.speed_mps + math.copysign(state.yaw_rate_rad_s * base.rear_track_m / 2.0, state.speed_mps)


def known(value: float | None) -> bool:
    """Return whether a sensed value is a finite number."""
    return value is not None and math.isfinite(value)


def steered(state: RarsState) -> float:
    """Return the angle that the inner wheel has; 0 while it is not known, and an interlock holds."""
    steer = state.steer_rad
    return steer if steer is not None and math.isfinite(steer) else 0.0
