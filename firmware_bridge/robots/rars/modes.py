"""RARS after an actuator has failed (A. P. Das, PhD thesis, IIT Delhi, 2018, 2.2), a mode for each.

The thesis names two: a failed steering leaves the two rear wheels, a failed traction motor the other one and
the steering ("bicycle mode"). Here its rack stays where it is, held by a gear of 159: that leaves the arcs of
one radius. To let the front wheels go would take a trail of the kingpins, which the thesis does not give.
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

STAYS_WITHIN_RAD: Final = math.radians(1.0)
"""Largest difference of a command from the fixed angle without a report to the station in control."""


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
    """The rack stays where it is: the wheels follow its angle, as ever, and nothing changes it."""

    role = STEERING

    def sensed(self, axes: Mapping[str, Feedback], sensors: Mapping[str, Reading]) -> RarsState:
        """Return the state, with an angle as long as its drive has kept its zero."""
        state = super().sensed(axes, sensors)
        # A drive that has lost its reference may stand anywhere: unknown, the base does not move.
        return replace(state, steer_rad=None) if axes[self._out].reference_lost else state


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


def _steering_stays(view: View) -> tuple[RarsMotion, str | None]:
    """Keep the steering angle; report that where another one is commanded."""
    # None leaves the rack where it is: its drive is without power in this mode.
    motion, angle = view.allowed, steered(view.body)
    if motion.steer_rad is None:
        return motion, None
    kept = replace(motion, steer_rad=None)
    if abs(motion.steer_rad - angle) <= STAYS_WITHIN_RAD:
        return kept, None
    return kept, f"the steering stays at {math.degrees(angle):.0f} deg"


def _lift_stays(view: View) -> tuple[RarsMotion, str | None]:
    """Keep the lift; report that where it is commanded to move."""
    motion = view.allowed
    if motion.lift_m is None and motion.lift_rate_mps == 0.0:
        return motion, None
    return replace(motion, lift_m=None, lift_rate_mps=0.0), "the lift stays where it is"


def _limits(*more: Limit) -> tuple[Limit, ...]:
    return (*more, *limits_by(lambda geometry: geometry.narrowed))


STEERING_STAYS: Final = Limit(
    "steering out of use", _steering_stays, "return the steering to neutral", clear_after=LIMIT_CLEARS_AFTER
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
