"""A torus that rolls on a cylinder without slip: contact equations (15)-(17) of [C], corrected.

Coordinates: u, v on the wheel (tube angle, wheel angle), s, z on the cylinder (arc, along the axis), and psi
between both frames: x_W = cos psi x_S + sin psi y_S along the wheel's axle to the left, y_W = sin psi x_S -
cos psi y_S along the rolling direction, z_W out of the wheel, into the surface; (4)-(7) of [C].
"""

import sympy as sp

from fmu.climber.vectors import Vector, cross, dot, plus
from fmu.export.model import Expression


class Contact:
    """Where a wheel stands, and how the place changes; vectors in a frame of the caller's choice.

    `place` is the contact point, `turn` the angle round the cylinder's axis (the frame's third), both
    measured in that frame.
    """

    def __init__(
        self,
        tube: Expression,
        psi: Expression,
        place: Vector,
        turn: Expression,
        radii: tuple[Expression, Expression, Expression],
    ) -> None:
        self.crown, wheel, self.tank = radii
        self.ring = wheel - self.crown  # R_m of the torus
        self.tube, self.psi, self.place = tube, psi, place
        sine, cosine = sp.sin(psi), sp.cos(psi)
        self.normal: Vector = (sp.cos(turn), sp.sin(turn), sp.S.Zero)
        around: Vector = (-sp.sin(turn), sp.cos(turn), sp.S.Zero)
        along: Vector = (sp.S.Zero, sp.S.Zero, sp.S.One)
        self.left = plus((cosine, around), (sine, along))
        self.ahead = plus((sine, around), (-cosine, along))
        # The wheel's axle and its radius to the contact, by the tube angle.
        self.axle = plus((sp.cos(tube), self.left), (-sp.sin(tube), self.normal))
        spoke = plus((-sp.cos(tube), self.normal), (-sp.sin(tube), self.left))
        self.arm = plus((self.ring, spoke), (-self.crown, self.normal))  # wheel's middle to contact
        self.middle = plus((1, place), (-1, self.arm))

    def rates(self, turning: Vector) -> dict[str, Expression]:
        """Return the rates of u, v, s, z, psi for the wheel's angular velocity against the surface.

        (17) corrected: the sign of the whole is minus, for (5) is Montana's frame with psi turned round.
        """
        sine, cosine = sp.sin(self.psi), sp.cos(self.psi)
        width = self.ring + self.crown * sp.cos(self.tube)
        curved = (1 / self.crown, sp.cos(self.tube) / width)  # K_W
        bend = 1 / self.tank
        # K_W + R' K_S R with K_S = diag(1 / r_c, 0)
        k11, k12, k22 = curved[0] + bend * cosine**2, bend * sine * cosine, curved[1] + bend * sine**2
        determinant = k11 * k22 - k12**2
        across, rolling, spin = (
            dot(turning, self.left),
            dot(turning, self.ahead),
            -dot(turning, self.normal),
        )
        first = (-k22 * rolling - k12 * across) / determinant
        second = (k12 * rolling + k11 * across) / determinant
        torsion = -sp.sin(self.tube) / width
        return {
            "tube": first / self.crown,
            "wheel": second / width,
            "arc": cosine * first + sine * second,
            "height": sine * first - cosine * second,
            "psi": -(spin + torsion * second),
        }

    def upright(self) -> Vector:
        """Return the direction up from the wheel, across its axle and its way."""
        return cross(self.ahead, self.axle)
