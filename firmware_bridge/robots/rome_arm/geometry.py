"""ROME's two halves in its robot file, how one bears the other, and its orbit."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from firmware_bridge.robot.table import Finite, Positive, Table
from firmware_bridge.robots.ar2 import geometry as arm
from firmware_bridge.robots.rome import geometry as base


class Balance(Table):
    """Where the masses are: the common centre of gravity stays inside the wheels' triangle."""

    base_kg: Positive
    """With what of the arm does not turn."""
    base_height_m: Positive
    """Of the base's middle of mass above the floor."""
    arm_height_m: Positive
    """Of the arm's foot, which stands at the base's middle."""
    link_kg: Annotated[tuple[Positive, ...], Field(strict=False, min_length=6, max_length=6)]
    """Each in the middle between its joints."""
    margin_m: Positive
    """So far inside the triangle it stays."""
    tool_distance_m: Positive
    """The base drives while the tool is no further from the first axis."""


class Orbit(Table):
    """Guide `orbit`: a body about the Earth, with x and y on the floor and z by the arm (2.4)."""

    start_du: Annotated[tuple[Finite, Finite, Finite], Field(strict=False)]
    speed_du_tu: Annotated[tuple[Finite, Finite, Finite], Field(strict=False)]
    m_per_du: Positive
    height_per_du: Positive
    s_per_tu: Positive = 1.0
    """Where the base cannot follow so fast, time is stretched."""
    sideways_m: Annotated[tuple[Finite, Finite], Field(strict=False)] = (0.0, 0.0)
    """From where the orbit begins to where the base stands then."""

    @model_validator(mode="after")
    def _is_no_centre(self) -> Self:
        if not any(self.start_du):
            raise ValueError("start_du: an orbit's body is not at its centre")
        return self


class Formation(Table):
    """Guide `formation`: how one body moves as another on a circle sees it (Clohessy and Wiltshire)."""

    half_width_m: Positive
    """Of its ellipse, half its width away from the centre; along its way it is twice as long."""
    height_m: Positive
    turn_s: Positive


class Pose(Table):
    """Guide `pose`: to where the base goes, while the tool goes to its own (`arm.courses.pose`)."""

    by_m: Annotated[tuple[Finite, Finite], Field(strict=False)]
    turn_deg: Finite


class Geometry(Table):
    """All that a robot file says of both."""

    base: base.Geometry
    arm: arm.Geometry
    balance: Balance
    orbit: Orbit
    formation: Formation
    pose: Pose
