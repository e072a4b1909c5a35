"""Motion model of RARS: the speed at its ramp, the rack at its top rate, turning as steered."""

import math
from typing import Final

from firmware_bridge.motion import davis
from firmware_bridge.motion.model import Moving, arc
from firmware_bridge.robot import Robot
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rars.kinematics import Rack, ramp_of
from firmware_bridge.units import from_seconds

STANDSTILL_MPS: Final = 0.02
"""Speed below which a yaw rate gives no steering angle."""


class RarsModel:
    """A `firmware_bridge.motion.model.MotionModel`."""

    def __init__(self, robot: Robot[RarsGeometry]) -> None:
        self._base: Final = robot.geometry.base
        self._ramp: Final = ramp_of(robot)
        self._rack: Final = Rack(robot)
        self.tightest_per_m: float = 1.0 / robot.geometry.limits.turn_radius_m

    def step(self, moving: Moving, speed_mps: float, yaw_rate_rad_s: float, seconds: float) -> Moving:
        """Return its motion after some time of these set-points."""
        base, steer = self._base, self._steer(moving)
        turning = 0.0
        # At a standstill any angle gives yaw rate 0, so the steering stays where it is.
        if abs(speed_mps) >= STANDSTILL_MPS:
            steers = davis.steer_from_curvature(base, yaw_rate_rad_s / speed_mps)
            turning = self._rack.turning(steer, davis.curvature(base, steer), steers)
            goal = davis.pinion_from_steer(base, steers)
            pinion, most = davis.pinion_from_steer(base, steer), self._rack.pinion_rad_s * seconds
            steer = davis.steer_from_pinion(base, pinion + min(max(goal - pinion, -most), most))
        bend = davis.curvature(base, steer)
        speed = self._ramp.step(moving.speed_mps, speed_mps, bend, from_seconds(seconds), turning)
        turn = speed * bend
        return Moving(arc(moving.pose, speed, turn, seconds), speed, turn, steer)

    def _steer(self, moving: Moving) -> float:
        if moving.steer_rad is not None:
            return moving.steer_rad
        if abs(moving.speed_mps) < STANDSTILL_MPS:
            return 0.0
        # Noise of the yaw rate at a low speed would give a curvature that the rack cannot steer; sign as in v
        # = w R.
        bend = math.copysign(
            min(abs(moving.yaw_rate_rad_s / moving.speed_mps), self.tightest_per_m),
            moving.yaw_rate_rad_s * moving.speed_mps,
        )
        return davis.steer_from_curvature(self._base, bend)
