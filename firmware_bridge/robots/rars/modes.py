"""RARS after an actuator has failed (A. P. Das, PhD thesis, IIT Delhi, 2018, 2.2), a mode for each.

The thesis names two: a failed steering leaves the two rear wheels (differential drive), a failed traction
motor the other one and the steering ("bicycle mode"). The rack stays where it is, held by a gear of 159: the
wheels steer against it. To let the front wheels go would take a trail of the kingpins, which the thesis does
not give.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from firmware_bridge.drivers.driver import Feedback, Reading, SetPoint, Speed
from firmware_bridge.motion import davis
from firmware_bridge.motion.odometry import moved
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.robot_type import RobotMode
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rars.kinematics import (
    LEFT_WHEEL,
    RIGHT_WHEEL,
    SCREW,
    STEERING,
    Rars,
    steered,
)
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.robots.rars.rules import (
    INTERLOCKS,
    LIMIT_CLEARS_AFTER,
    Limit,
    View,
    clip_steer,
    limits_by,
)
from firmware_bridge.units import Nanoseconds, to_seconds

STEERS_PER_M_S: Final = 0.5
"""Rate of the curvature to which the wheels steer, 1/(m s): a step would pull the motors past their ramp."""


class Failed(Rars):
    """A body of which one axis is left out: within the narrowed limits."""

    role: str
    """Role of that axis."""

    def __init__(self, robot: Robot[RarsGeometry]) -> None:
        super().__init__(robot, robot.geometry.narrowed)
        self._out: Final = robot.axis(self.role).name

    def set_points(self, motion: RarsMotion, state: RarsState) -> Mapping[str, SetPoint]:
        """Return the set-points of the axes that are left."""
        # Without a set-point the excluded axis is sent the power-off of every cycle.
        return {
            name: set_point
            for name, set_point in super().set_points(motion, state).items()
            if name != self._out
        }


class SteeringFailed(Failed):
    """The rack stays where it is, and the rear wheels steer against it (thesis 2.2, differential drive).

    Wheels that drive another curvature than the rack's slip and drag the front wheels aside. The robot turns
    by the rack's curvature and a share of the difference; pose and yaw rate follow from that share, too.
    """

    role = STEERING

    def __init__(self, robot: Robot[RarsGeometry]) -> None:
        super().__init__(robot)
        self._share: Final = robot.geometry.degraded.wheel_steering

    def sensed(self, axes: Mapping[str, Feedback], sensors: Mapping[str, Reading]) -> RarsState:
        """Return the state, with an angle as long as its drive has kept its zero."""
        state = super().sensed(axes, sensors)
        # A drive that has lost its reference may stand anywhere: unknown, the base does not move.
        if axes[self._out].reference_lost:
            return replace(state, steer_rad=None)
        stuck = davis.curvature(self._base, steered(state)) * state.speed_mps
        return replace(state, yaw_rate_rad_s=stuck + self._share * (state.yaw_rate_rad_s - stuck))

    def set_points(self, motion: RarsMotion, state: RarsState) -> Mapping[str, SetPoint]:
        """Return the wheels' set-points for the curvature that is commanded, and the lift's."""
        rack = davis.curvature(self._base, steered(state))
        goal = rack if motion.steer_rad is None else davis.curvature(self._base, motion.steer_rad)
        wheels = rack + (goal - rack) / self._share
        return {**super().set_points(motion, state), **self._wheels(motion.speed_mps, wheels)}

    def ramped(
        self, commanded: RarsMotion, allowed: RarsMotion, state: RarsState, elapsed: Nanoseconds
    ) -> RarsMotion:
        """Return the next set-point: the curvature goes to the commanded one at a rate, too."""
        motion = super().ramped(commanded, allowed, state, elapsed)
        if allowed.steer_rad is None:
            return motion
        rack = steered(state)
        before = rack if commanded.steer_rad is None else commanded.steer_rad
        bend, goal = (davis.curvature(self._base, angle) for angle in (before, allowed.steer_rad))
        step = STEERS_PER_M_S * to_seconds(elapsed)
        bend += min(max(goal - bend, -step), step)
        return replace(motion, steer_rad=davis.steer_from_curvature(self._base, bend))

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        _sensors: Mapping[str, Reading],
    ) -> Pose:
        """Return the pose after both rear wheels rolled on, turned by their share."""
        base = self._base
        left, right = (
            (after[name].position - before[name].position) * base.wheel_radius_m for name in self.rolling
        )
        rack = davis.curvature(base, davis.steer_from_pinion(base, after[self._steering].position))
        middle, stuck = (left + right) / 2.0, rack * (left + right) / 2.0 * base.rear_track_m
        apart = (stuck + self._share * (right - left - stuck)) / 2.0
        return moved(pose, middle - apart, middle + apart, base.rear_track_m)


class LiftFailed(Failed):
    """The platform stays where it is: the screw locks itself (thesis 2.5)."""

    role = SCREW

    def sensed(self, axes: Mapping[str, Feedback], sensors: Mapping[str, Reading]) -> RarsState:
        """Return the state, with a height as long as its drive has kept its zero."""
        state = super().sensed(axes, sensors)
        return replace(state, lift_m=None) if axes[self._out].reference_lost else state


class OneWheel(Failed):
    """One rear wheel drives, and the other one is driven back through its gear.

    Pose and speed follow from the driven wheel and the angle that is steered.
    """

    side: int
    """1 where the right wheel drives, -1 where the left one does."""

    def __init__(self, robot: Robot[RarsGeometry]) -> None:
        super().__init__(robot)
        self._driven: Final = self._right if self.side > 0 else self._left
        self.rolling = (self._driven,)

    def sensed(self, axes: Mapping[str, Feedback], sensors: Mapping[str, Reading]) -> RarsState:
        """Return the state; speed and yaw rate as the driven wheel has them in the turn that is steered."""
        state = super().sensed(axes, sensors)
        # The driven wheel rolls on a wider or narrower circle than the middle of the axle.
        speed = axes[self._driven].velocity * self._base.wheel_radius_m / self._share(steered(state))
        return replace(
            state, speed_mps=speed, yaw_rate_rad_s=speed * davis.curvature(self._base, steered(state))
        )

    def set_points(self, motion: RarsMotion, state: RarsState) -> Mapping[str, SetPoint]:
        """Return the steering's set-point, and that of the wheel that drives."""
        rolling = motion.speed_mps / self._base.wheel_radius_m
        return {
            **super().set_points(motion, state),
            self._driven: Speed(rolling * self._share(steered(state))),
        }

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        _sensors: Mapping[str, Reading],
    ) -> Pose:
        """Return the pose after the driven wheel rolled on, in the turn that is steered now.

        The dead wheel's count, where there is one, makes it worse: one wheel is driven and the other one
        dragged, each slips its own way by a percent or two, and over the track that is a turn.
        """
        base = self._base
        rolled = (after[self._driven].position - before[self._driven].position) * base.wheel_radius_m
        share = self._share(davis.steer_from_pinion(base, after[self._steering].position))
        # The shares of both wheels add up to 2.
        other = rolled * (2.0 - share) / share
        left, right = (other, rolled) if self.side > 0 else (rolled, other)
        return moved(pose, left, right, base.rear_track_m)

    def _share(self, steer_rad: float) -> float:
        """Return how much faster than the axle's middle the driven wheel rolls in this turn; above 0."""
        return 1.0 + self.side * davis.curvature(self._base, steer_rad) * self._base.rear_track_m / 2.0


class LeftFailed(OneWheel):
    """The right wheel drives."""

    role = LEFT_WHEEL
    side = 1


class RightFailed(OneWheel):
    """The left wheel drives."""

    role = RIGHT_WHEEL
    side = -1


def _little_steer(view: View) -> tuple[RarsMotion, str | None]:
    return clip_steer(view, math.radians(view.geometry.degraded.steer_angle_deg))


def curvatures(robot: Robot[RarsGeometry], values: Mapping[str, float]) -> tuple[float, float]:
    """Return the curvatures to which the wheels steer against the stuck rack, by its reported angle."""
    stuck = davis.curvature(robot.geometry.base, math.radians(values["STEER"]))
    most = robot.geometry.degraded.wheel_curvature_per_m
    return stuck - most, stuck + most


def _steers_by_wheels(view: View) -> tuple[RarsMotion, str | None]:
    """Keep the curvature within what the rear wheels steer to; report that where another is commanded."""
    motion, base = view.allowed, view.geometry.base
    if motion.steer_rad is None:
        return motion, None
    rack, most = steered(view.body), view.geometry.degraded.wheel_curvature_per_m
    stuck = davis.curvature(base, rack)
    bend = davis.curvature(base, motion.steer_rad)
    within = min(max(bend, stuck - most), stuck + most)
    # A limit reports what is beyond it by more than a millionth.
    if abs(within - bend) <= 1e-6 * most:
        return motion, None
    return replace(motion, steer_rad=davis.steer_from_curvature(base, within)), (
        f"requested a curvature of {bend:.2f} 1/m; with the rack at {math.degrees(rack):.0f} deg the wheels "
        f"steer from {stuck - most:.2f} to {stuck + most:.2f} 1/m"
    )


def _lift_stays(view: View) -> tuple[RarsMotion, str | None]:
    """Keep the lift; report that where it is commanded to move."""
    motion = view.allowed
    if motion.lift_m is None and motion.lift_rate_mps == 0.0:
        return motion, None
    return replace(motion, lift_m=None, lift_rate_mps=0.0), "the lift stays where it is"


def _limits(*more: Limit) -> tuple[Limit, ...]:
    return (*more, *limits_by(lambda geometry: geometry.narrowed))


STEERING_STAYS: Final = Limit(
    "steering out of use", _steers_by_wheels, "steer less", clear_after=LIMIT_CLEARS_AFTER
)
LIFT_STAYS: Final = Limit(
    "lift out of use", _lift_stays, "return the lift's stick to neutral", clear_after=LIMIT_CLEARS_AFTER
)
LITTLE_STEER: Final = Limit(
    "steer angle after a failure", _little_steer, "steer less", clear_after=LIMIT_CLEARS_AFTER
)

MODES: Final[Mapping[str, RobotMode[RarsGeometry, RarsMotion, RarsState]]] = {
    "steering_failed": RobotMode(
        without=frozenset({STEERING}),
        kinematics=SteeringFailed,
        interlocks=INTERLOCKS,
        limits=_limits(STEERING_STAYS),
        curvatures=curvatures,
    ),
    "left_failed": RobotMode(
        without=frozenset({LEFT_WHEEL}),
        kinematics=LeftFailed,
        interlocks=INTERLOCKS,
        limits=_limits(LITTLE_STEER),
    ),
    "right_failed": RobotMode(
        without=frozenset({RIGHT_WHEEL}),
        kinematics=RightFailed,
        interlocks=INTERLOCKS,
        limits=_limits(LITTLE_STEER),
    ),
    "lift_failed": RobotMode(
        without=frozenset({SCREW}), kinematics=LiftFailed, interlocks=INTERLOCKS, limits=_limits(LIFT_STAYS)
    ),
}
