"""Tables of a robot file that give the lengths of a base or a lift; lengths in m, angles in degrees.

Apart from what is computed with them, which runs again and again.
"""

from typing import Annotated, Self

from pydantic import Field, model_validator

from firmware_bridge.robot.table import Positive, Table


class DavisBase(Table):
    """Davis-steered platform, lengths in meters (thesis 2.4, Tab. 3.1)."""

    wheel_radius_m: Positive
    rear_track_m: Positive
    wheelbase_m: Positive
    kingpin_distance_m: Positive
    davis_h_m: Positive
    pinion_diameter_m: Positive
    half_support_width_m: Positive
    centre_of_gravity_height_m: Positive
    centre_offset_m: Positive = 0.220
    """Rear axle to centre of mass: 0.220 by Tab. 3.1, 0.141 by 2.3.1 of the thesis."""

    @property
    def davis_b_m(self) -> float:
        """Half the tie rod's offset, from 2 b / h = a_k / w (2.12)."""
        return self.davis_h_m * self.kingpin_distance_m / (2.0 * self.wheelbase_m)


class DifferentialBase(Table):
    """Two driven wheels on one axle."""

    wheel_radius_m: Positive
    track_m: Positive
    """From wheel to wheel, where they touch the floor."""


class ScissorLift(Table):
    """Scissor lift on a screw: N stages of equal links, driven along the base."""

    stages: Annotated[int, Field(ge=1, le=20)]
    link_length_m: Positive
    collapsed_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    extended_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    screw_pitch_m: Positive

    @model_validator(mode="after")
    def _extends_upwards(self) -> Self:
        if self.extended_angle_deg <= self.collapsed_angle_deg:
            raise ValueError("extended_angle_deg must be larger than collapsed_angle_deg")
        return self
