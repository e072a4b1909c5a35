"""RARS's table of geometry and limits in its robot file (A. P. Das, PhD thesis, IIT Delhi, 2018)."""

import math
from typing import Annotated

from pydantic import Field

from firmware_bridge import renamed
from firmware_bridge.motion.davis import steer_from_curvature
from firmware_bridge.motion.tables import DavisBase, ScissorLift
from firmware_bridge.robot.table import NonNegative, Positive, SensorName, Table
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


class Weighing(Table):
    """What its motors' currents and the IMU show of its load."""

    acceleration: SensorName
    """The name of the sensor of its specific force ahead, m/s2."""
    newton_per_ampere: Positive
    """Force on the floor for each ampere of the sum of both driving motors' currents."""
    resistance_n: NonNegative
    """Force that drives it on the level."""
    tolerance: Positive = 0.2
    """Share by which the estimate may be above the mass with `payload_kg`."""


class Balance(Table):
    """What keeps the base from tipping over: its masses, its tilt by an IMU, the margin that is kept.

    The height of its centre of mass is assumed as in the plant that tips over: with h, the table's height
    over the floor, z = (m z_0 + m_s (h - h_0) / 2 + m_p h) / (m + m_p).
    """

    pitch: SensorName
    """The name of the sensor of its pitch, rad, positive with the nose up."""
    roll: SensorName
    """The name of the sensor of its roll, rad, positive with the left side up."""
    mass_kg: Positive
    """Without payload."""
    scissor_kg: NonNegative
    """Part of `mass_kg` that rises with the lift, by half of its way."""
    table_height_m: Positive
    """Over the floor, retracted."""
    payload_kg: NonNegative
    """The heaviest that is put on: every margin is judged with it, as it raises the centre of mass."""
    floor_friction: Positive
    """The least of the floors that it drives on: its driven wheels have to hold it on a slope."""
    payload_aside_m: NonNegative = 0.0
    """The farthest that it stands beside the centre of mass, in any direction."""
    least_margin_m: Positive = 0.010
    """Least distance of the zero-moment point inside the support (2.3.1)."""
    tilt_error_deg: NonNegative = 1.0
    """Error of the IMU's pitch and roll that is allowed for."""
    weighing: Weighing | None = None
    """None: that no more than `payload_kg` is on it is not checked."""
    lift_while_driving: bool = False
    """Drive with the lift extended, too; [R] forbids it."""

    def height(self, base: DavisBase, lift_m: float) -> float:
        """Return the height of the centre of mass over the floor, m, with the heaviest payload."""
        up = self.table_height_m + lift_m
        raised = self.mass_kg * base.centre_of_gravity_height_m + self.scissor_kg * lift_m / 2.0
        return (raised + self.payload_kg * up) / (self.mass_kg + self.payload_kg)

    def lift_for(self, base: DavisBase, height_m: float) -> float:
        """Return the lift's height above retracted, m, at which the centre of mass is so high."""
        total = self.mass_kg + self.payload_kg
        still = self.mass_kg * base.centre_of_gravity_height_m + self.payload_kg * self.table_height_m
        return (height_m * total - still) / (self.scissor_kg / 2.0 + self.payload_kg)

    @property
    def heaviest_kg(self) -> float:
        """The mass with the heaviest payload."""
        return self.mass_kg + self.payload_kg

    def needed(self, height_m: float) -> float:
        """Return the margin in m that is kept by a robot as it is measured."""
        aside = self.payload_kg * self.payload_aside_m / (self.mass_kg + self.payload_kg)
        return self.least_margin_m + aside + height_m * math.tan(math.radians(self.tilt_error_deg))


class RarsGeometry(Table):
    """Steered base, lift on it, and their limits."""

    base: DavisBase
    lift: ScissorLift
    limits: RarsLimits
    degraded: Degraded
    balance: Balance | None = None
    """None: no IMU measures a slope, and the limits are those of a level floor."""

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
