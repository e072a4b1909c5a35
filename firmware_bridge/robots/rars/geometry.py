"""RARS's table of geometry and limits in its robot file (A. P. Das, PhD thesis, IIT Delhi, 2018)."""

import math
from typing import Annotated

from pydantic import Field

from firmware_bridge import renamed
from firmware_bridge.motion.davis import DavisBase, steer_from_curvature
from firmware_bridge.motion.scissor import ScissorLift
from firmware_bridge.robot.table import NonNegative, Positive, Table
from firmware_bridge.units import STANDARD_GRAVITY


class RarsLimits(Table):
    """The limits that the interlocks enforce, whatever the operator commands (thesis 2.3.1, 4.2.1)."""

    speed_mps: Positive
    acceleration_g: Positive
    steer_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    turn_radius_m: Positive
    lift_retracted_m: NonNegative
    lift_rate_mps: Positive

    @property
    def acceleration_mps2(self) -> float:
        """The acceleration limit in m/s2."""
        return self.acceleration_g * STANDARD_GRAVITY

    @property
    def steer_angle_rad(self) -> float:
        """The largest angle of the inner front wheel."""
        return math.radians(self.steer_angle_deg)


class Degraded(Table):
    """Narrower limits after an actuator failure, for the way home."""

    speed_mps: Positive
    acceleration_g: Positive
    steer_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    """Limit where one wheel drives alone."""
    wheel_steering: Annotated[float, Field(gt=0, le=1)]
    """With the rack stuck: share of the wheels' curvature, from the rack's on, that the robot turns by."""
    wheel_curvature_per_m: Positive
    """The largest curvature to either side of the rack's that the wheels steer to then."""


class RarsGeometry(Table):
    """Steered base, lift on it, and their limits."""

    base: DavisBase
    lift: ScissorLift
    limits: RarsLimits
    degraded: Degraded

    @property
    def narrowed(self) -> RarsLimits:
        """The limits after a failure."""
        degraded, whole = self.degraded, self.limits
        changed = {
            "speed_mps": min(degraded.speed_mps, whole.speed_mps),
            "acceleration_g": min(degraded.acceleration_g, whole.acceleration_g),
        }
        return whole.model_copy(update=changed)

    @property
    def tightest_steer_rad(self) -> float:
        """The inner wheel's angle of the tightest turn, 58.95 degrees for 415 mm (2.13)."""
        return steer_from_curvature(self.base, 1.0 / self.limits.turn_radius_m)


__getattr__ = renamed.module(
    __name__, __name__, Geometry="RarsGeometry", Limits="RarsLimits", Limp="Degraded"
)
