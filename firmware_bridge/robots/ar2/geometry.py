"""The arm's limits, workspace and control in its robot file; its links are those of `robots.ar2.arm`."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from firmware_bridge import renamed
from firmware_bridge.robot.table import Finite, NonNegative, Positive, Table


class Ar2Limits(Table):
    """The limits that the interlocks enforce, whatever the operator commands."""

    speed_mps: Positive
    """Of the tool."""
    acceleration_mps2: Positive
    turn_rate_rad_s: Positive
    """Of the tool about any axis."""
    turn_acceleration_rad_s2: Positive
    joint_margin_deg: NonNegative
    """So far before the ends of a joint's travel it stops."""


class Workspace(Table):
    """Workspace of the tool, m in the frame of the arm's foot, z from the floor that it stands on."""

    lowest_m: Annotated[tuple[Finite, Finite, Finite], Field(strict=False)]
    highest_m: Annotated[tuple[Finite, Finite, Finite], Field(strict=False)]
    """The corners of a box; its lower side keeps the floor."""
    base_radius_m: Positive
    """Around its first axis; the tool stays outside of it ..."""
    base_height_m: Positive
    """... up to this height."""

    @model_validator(mode="after")
    def _is_a_box(self) -> Self:
        if any(low >= high for low, high in zip(self.lowest_m, self.highest_m, strict=True)):
            raise ValueError("highest_m must be above lowest_m in each of x, y and z")
        return self


class Ar2Gains(Table):
    """Gains of the law (3.16), (3.21) to (3.23): x' = x_d' + K_p e + K_i int e + K_d e' for the tool."""

    kp_per_s: NonNegative
    """Of the tool's position; with 0, and without `ki_per_s2` and `kd`, the loop is open."""
    ko_per_s: NonNegative
    """Of its orientation."""
    ki_per_s2: NonNegative = 0.0
    """Of the position's integral."""
    kd: Annotated[NonNegative, Field(lt=1.0)] = 0.0
    """Of the position's derivative, which is taken from two cycles: from 1 on it would grow by itself."""


class Ar2Control(Ar2Gains):
    """Gains of all path followers but those that have their own; the print has none (Fig. 3.9 to 3.11)."""

    ramp_open: Ar2Gains = Ar2Gains(kp_per_s=0.0, ko_per_s=0.0)
    """The ramp in open loop."""
    sine_pi: Ar2Gains = Ar2Gains(kp_per_s=3.0, ko_per_s=1.5, ki_per_s2=1.0)
    """The sine by PI."""
    orbit_z: Ar2Gains = Ar2Gains(kp_per_s=3.0, ko_per_s=1.5, ki_per_s2=1.0, kd=0.2)
    """The height of the orbit by PID."""


class ToolPose(Table):
    """The path follower `pose`: from the tool's place to one beside, turned by less than 90 degrees."""

    by_m: Annotated[tuple[Finite, Finite, Finite], Field(strict=False)]
    tilt_deg: Annotated[tuple[Finite, Finite, Finite], Field(strict=False)]
    """About x, y and z of the foot's frame, together: the length is the angle."""


class Courses(Table):
    """Heights of the path followers `ramp`, (3.24), and `sine`, (3.25): mm by context, 60 s."""

    height_m: Positive = 0.08
    ramp_s: Positive = 60.0
    orbit_m_per_du: Positive = 0.9
    """Height of 1 DU for the path follower `orbit_z`, z of the orbit (4.10); 1 TU is 1 s."""
    pose: ToolPose


class Ar2Geometry(Table):
    """The arm's part of a robot file beside its joints."""

    limits: Ar2Limits
    workspace: Workspace
    control: Ar2Control
    courses: Courses


__getattr__ = renamed.module(__name__, __name__, Geometry="Ar2Geometry")
