"""The climber's geometry, tank, limits, control and paths in its robot file.

[C] is Qualls, Canfield, Shibakov, JAMRIS 10(3), 2016. Lengths on the tank are those of its unrolled surface:
the arc round it, to the right of a robot that looks up, and the height along its axis.
"""

import math
from typing import Annotated, Final, Literal, Self

from pydantic import Field, model_validator

from firmware_bridge import renamed
from firmware_bridge.differential import geometry
from firmware_bridge.motion.tables import DifferentialBase
from firmware_bridge.robot.table import Finite, Positive, SensorName, Table

GRAVITY: Final = 9.81


class Base(DifferentialBase):
    """Two driven wheels on a joint between them."""

    crown_radius_m: Positive
    """Of a wheel's cross-section, which is round."""
    coupled: bool = False
    """One shaft turns both wheels, as in the laboratory of [C] 5: the robot cannot turn then."""

    @property
    def coupling(self) -> float:
        """The same as the plant has it: 1 coupled, 0 not."""
        return float(self.coupled)


class Tank(Table):
    """A standing cylinder, seen by cameras whose room has z upwards."""

    radius_m: Positive
    axis_x_m: Finite = 0.0
    """Position of its axis in the room. The arc is 0 at its +x side."""
    axis_y_m: Finite = 0.0


class Start(Table):
    """Start pose of the robot on the tank; it counts where no cameras see it."""

    heading_deg: Finite = 90.0
    """From the arc towards the axis: 90 looks up."""
    height_m: Finite = 0.0

    @property
    def heading_rad(self) -> float:
        """The same in rad."""
        return math.radians(self.heading_deg)


class Joint(Table):
    """The joint between both halves, and how its angle is measured; angles either way from flat."""

    side: Literal["left", "right"] = "left"
    """The half that it moves, in [C] the left one; axle and caster of the other are fixed in the chassis."""
    sensor: SensorName
    """The name of the sensor that measures it, in rad."""
    rest: Finite
    """The sensor's reading where the joint is flat, rad."""
    turns_round_deg: Positive
    """A path follower turns round there."""
    slow_deg: Positive
    """From there on the robot drives slower the way in which the angle grows, the nearer to the bound the
    slower."""
    bound_deg: Positive
    """There it does not drive that way any more."""
    sensor_bound_deg: Positive
    """An angle beyond it, which is beyond the stops, is a sensor whose wire is off."""

    @property
    def place(self) -> float:
        """The same as the plant has it: 1 left, -1 right."""
        return 1.0 if self.side == "left" else -1.0

    @model_validator(mode="after")
    def _in_this_order(self) -> Self:
        if not self.turns_round_deg <= self.slow_deg < self.bound_deg < self.sensor_bound_deg:
            raise ValueError("turns_round_deg, slow_deg, bound_deg, sensor_bound_deg must grow in this order")
        return self

    def read(self, reading_rad: float) -> float | None:
        """Return the angle of a sensor's reading; None where it cannot be that."""
        # An open wire reads at one end of the scale, which is beyond the joint's stops.
        angle = reading_rad - self.rest
        return angle if abs(angle) <= math.radians(self.sensor_bound_deg) else None

    def share(self, joint_rad: float | None, way: float) -> float:
        """Return the share of its speed that it may have nose first, or where `way` is negative tail first.

        An angle to the one side grows nose first and decays tail first, to the other side the other way
        round: on the plant, at each heading and from each angle. 0 where no one knows the angle.
        """
        if joint_rad is None:
            return 0.0
        slow, bound = math.radians(self.slow_deg), math.radians(self.bound_deg)
        # Written so that NaN gives no number, too.
        left = (bound - math.copysign(1.0, way) * joint_rad) / (bound - slow)
        return min(left, 1.0) if left > 0.0 else 0.0


class Wall(Table):
    """The adhesion of the robot to the tank, and the cable that hangs from it."""

    sensor: SensorName
    """The name of the sensor that measures the share of its magnets on the wall."""
    wheel_n: Positive
    """Pull-off force of a wheel's magnet."""
    caster_n: Positive
    friction: Positive
    """Between wheel and wall."""
    mass_kg: Positive
    mass_height_m: Positive
    """Its center of mass off the wall."""
    length_m: Positive
    """Between the axle and the caster's contact."""
    least_margin: Annotated[float, Field(ge=1.0)]
    """Least ratio of the magnets' force to the weight."""
    cable_m: Positive
    """From where the robot is put on to where the cable is taut."""
    cable_kg_per_m: Positive

    @property
    def held_n(self) -> float:
        """The weight that magnets and friction hold, whatever way the robot looks.

        Along the wall friction holds it. Off the wall the weight's lever is the height of its center; the
        caster's magnet has to bear that alone where the robot looks down.
        """
        # Along the wall the weight is held by friction at both wheels and the caster.
        along = self.friction * (2.0 * self.wheel_n + self.caster_n)
        off = self.caster_n * self.length_m / self.mass_height_m
        return min(along, off)

    @property
    def heaviest_kg(self) -> float:
        """The mass that is held with the least margin, cable included."""
        return self.held_n / (self.least_margin * GRAVITY)

    def margin(self, height_m: float) -> float:
        """Return the ratio of what is held to the weight of robot and cable at a height."""
        hanging = self.cable_kg_per_m * max(height_m, 0.0)
        return self.held_n / ((self.mass_kg + hanging) * GRAVITY)

    @property
    def highest_m(self) -> float:
        """Height at which its cable becomes too heavy."""
        return (self.heaviest_kg - self.mass_kg) / self.cable_kg_per_m

    @model_validator(mode="after")
    def _holds_at_all(self) -> Self:
        if not self.heaviest_kg > self.mass_kg:
            raise ValueError(
                f"the magnets hold {self.heaviest_kg:.2f} kg with least_margin, mass_kg is {self.mass_kg:g}"
            )
        return self


class ClimberLimits(geometry.Limits):
    """The limits that the interlocks enforce, with the highest and lowest height."""

    lowest_m: Finite
    """The height along the tank's axis, above where the robot is put on or as the cameras see it."""
    highest_m: Finite


class ClimberGains(Table):
    """Gains of the polar law (27) to (29) of [C], with the signs under which it is stable."""

    k_rho_per_s: Positive
    k_alpha_per_s: Positive
    k_beta_per_s: Annotated[float, Field(lt=0.0)]
    speed_mps: Positive
    """Along paths."""

    @model_validator(mode="after")
    def _is_stable(self) -> Self:
        # Stable for k_rho > 0, k_beta < 0 and k_alpha > k_rho (Siegwart and Nourbakhsh).
        if self.k_alpha_per_s <= self.k_rho_per_s:
            raise ValueError("k_alpha_per_s must be larger than k_rho_per_s: the law is not stable else")
        return self


class Paths(Table):
    """Sizes of the paths on the unrolled surface."""

    side_m: Positive = 1.0
    """Of triangle, square and diamond."""
    length_m: Positive = 1.0
    """Of vertical, horizontal and spiral."""
    radius_m: Positive = 0.5
    """Of the circle."""


class ClimberGeometry(geometry.Geometry):
    """The robot, its tank, its limits, its control and its paths."""

    base: Base
    tank: Tank
    start: Start = Start()
    joint: Joint
    wall: Wall
    limits: ClimberLimits
    control: ClimberGains
    paths: Paths = Paths()

    @model_validator(mode="after")
    def _paths_are_no_faster_than_the_robot(self) -> Self:
        if self.control.speed_mps > self.limits.speed_mps:
            raise ValueError(
                f"control.speed_mps is {self.control.speed_mps:g}, limits.speed_mps only "
                f"{self.limits.speed_mps:g}"
            )
        return self


__getattr__ = renamed.module(__name__, __name__, Geometry="ClimberGeometry")
