"""The limit of RARS without slip: two equations in closed form, in plain numbers.

The plant has tyres; this is what it must come near to as they stiffen, and what torques for a path are
planned with. [R] 3.3 and 3.4.5.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

GRAVITY: Final = 9.81


@dataclass(frozen=True, slots=True)
class Rolling:
    """Inertias of the rolling robot, without rotors: kg, kg m, kg m2."""

    radius: float
    track: float
    mass: float
    offset: float
    about_axle: float
    rim: float

    @classmethod
    def of(cls, p: Mapping[str, float]) -> "Rolling":
        """Take them from the plant's parameters."""
        mass, track = p["platform_mass"], p["rear_track"]
        about_axle = p["yaw_inertia"] + 2 * p["wheel_yaw_inertia"] + mass * p["centre_offset"] ** 2
        about_axle += 2 * p["wheel_mass"] * (track / 2) ** 2
        return cls(
            p["wheel_radius"],
            track,
            mass + 2 * p["wheel_mass"],
            mass * p["centre_offset"],
            about_axle,
            2 * p["wheel_spin_inertia"] / p["wheel_radius"] ** 2,
        )

    def torques(
        self,
        speed: float,
        yaw_rate: float,
        change: float,
        turning: float,
        *,
        slope: float = 0.0,
        heading: float = 0.0,
    ) -> tuple[float, float]:
        """Return the wheel torques, left and right, in N.m for v, W and their rates.

        (3.44) with the convective terms that 3.3.2 takes as zero, - m_p a W2 and + m_p a v W, and with the
        slope in rad, uphill at heading 0: the mass that it lacks, and its moment about the axle.
        """
        push = (self.mass + self.rim) * change - self.offset * yaw_rate**2
        push += self.mass * GRAVITY * math.sin(slope) * math.cos(heading)
        twist = (self.about_axle + self.rim * self.track**2 / 4) * turning + self.offset * speed * yaw_rate
        twist -= self.offset * GRAVITY * math.sin(slope) * math.sin(heading)
        return (
            self.radius * (push / 2 - twist / self.track),
            self.radius * (push / 2 + twist / self.track),
        )

    def rates(
        self,
        speed: float,
        yaw_rate: float,
        left: float,
        right: float,
        *,
        slope: float = 0.0,
        heading: float = 0.0,
    ) -> tuple[float, float]:
        """Return the rates of v and W under wheel torques."""
        push = (left + right) / self.radius + self.offset * yaw_rate**2
        push -= self.mass * GRAVITY * math.sin(slope) * math.cos(heading)
        twist = self.track / 2 * (right - left) / self.radius - self.offset * speed * yaw_rate
        twist += self.offset * GRAVITY * math.sin(slope) * math.sin(heading)
        return push / (self.mass + self.rim), twist / (self.about_axle + self.rim * self.track**2 / 4)


def quintic(time: float, whole: float = 60.0) -> tuple[float, float, float]:
    """Return the angle of (3.41) in rad, its rate and acceleration: a full circle in `whole` seconds."""
    s = time / whole
    angle = math.pi * (20 * s**3 - 30 * s**4 + 12 * s**5)
    rate = math.pi * 60 * (s * (1 - s)) ** 2 / whole
    return angle, rate, math.pi * 120 * s * (1 - s) * (1 - 2 * s) / whole**2
