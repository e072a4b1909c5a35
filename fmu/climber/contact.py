"""A torus that rolls on a surface: Montana's contact equations (15)-(17) of [C], corrected.

Coordinates: u, v on the wheel (tube angle, wheel angle), s, z on the surface, and psi between both frames:
x_W = cos psi x_S + sin psi y_S along the wheel's axle to the left, y_W = sin psi x_S - cos psi y_S along the
rolling direction, z_W out of the wheel, into the surface; (4)-(7) of [C].
"""

from dataclasses import dataclass

import sympy as sp

from fmu.climber.surfaces import SurfacePoint
from fmu.climber.vectors import Vector, cross, dot, kept, plus
from fmu.export.functions import named
from fmu.export.model import Expression


@dataclass(frozen=True, slots=True)
class Torus:
    """A wheel: `crown` is the radius of its cross-section, `radius` that of the whole; in m."""

    crown: Expression
    radius: Expression

    @property
    def ring(self) -> Expression:
        """The radius of the cross-section's centers."""
        return self.radius - self.crown


class Contact:
    """Contact point of a wheel, and its motion; vectors in the world's frame."""

    def __init__(self, tube: Expression, psi: Expression, place: SurfacePoint, wheel: Torus) -> None:
        self.place, self.wheel = place, wheel
        self.point, self.normal = kept(place.point), kept(place.normal)
        self._sine, self._cosine = named(sp.sin(psi)), named(sp.cos(psi))
        lean, upright = named(sp.sin(tube)), named(sp.cos(tube))
        self.left = kept(plus((self._cosine, place.along_s), (self._sine, place.along_z)))
        self.ahead = kept(plus((self._sine, place.along_s), (-self._cosine, place.along_z)))
        # The tube's angle leans the axle against the surface.
        self.axle = kept(plus((upright, self.left), (-lean, self.normal)))
        # Wheel's middle to contact: down the spoke, then down the cross-section.
        down = wheel.ring * upright + wheel.crown
        self.middle = kept(plus((1, self.point), (down, self.normal), (wheel.ring * lean, self.left)))
        self.width = named(wheel.ring + wheel.crown * upright)
        """Contact to axle: the rim at the contact is pushed backwards by this for each rad/s ahead."""
        self._curvature = (1 / wheel.crown, upright / self.width)  # K_W
        self._torsion = -lean / self.width

    def rates(self, turning: Vector, sliding: Vector | None = None) -> dict[str, Expression]:
        """Return the rates of u, v, s, z, psi for the wheel's angular velocity against the surface.

        `sliding` is the velocity of the wheel's material at the contact, in the surface; else it rolls.
        (17) corrected: the sign of the whole is minus, for (5) is Montana's frame with psi turned round.
        """
        sine, cosine = self._sine, self._cosine
        ss, sz, zz = self.place.curvature
        # R' K_S R with R = [[cos, sin], [sin, -cos]]
        t11 = ss * cosine**2 + 2 * sz * sine * cosine + zz * sine**2
        t12 = (ss - zz) * sine * cosine + sz * (sine**2 - cosine**2)
        t22 = ss * sine**2 - 2 * sz * sine * cosine + zz * cosine**2
        k1, k2 = self._curvature
        # K_W + K~ is positive unless a hollow is sharper than the wheel, which would touch it twice.
        determinant = named((k1 + t11) * (k2 + t22) - t12**2)
        across, rolling = dot(turning, self.left), dot(turning, self.ahead)
        spin = -dot(turning, self.normal)
        first, second = self._solved((-rolling, across), (k1 + t11, t12, k2 + t22), determinant)
        on_wheel = on_surface = (first, second)
        if sliding is not None:
            aside, along = named(dot(sliding, self.left)), named(dot(sliding, self.ahead))
            both = (k1 + t11, t12, k2 + t22)
            given = self._solved((k1 * aside, k2 * along), both, determinant)
            on_surface = (first + given[0], second + given[1])
            # (K_W + K~)^-1 K~ v = v - (K_W + K~)^-1 K_W v
            on_wheel = (on_surface[0] - aside, on_surface[1] - along)
        way_s = named(cosine * on_surface[0] + sine * on_surface[1])
        way_z = named(sine * on_surface[0] - cosine * on_surface[1])
        turned = self.place.torsion[0] * way_s + self.place.torsion[1] * way_z
        return {
            "tube": on_wheel[0] / self.wheel.crown,
            "wheel": on_wheel[1] / self.width,
            "arc": way_s / self.place.metric[0],
            "height": way_z / self.place.metric[1],
            "psi": -(spin + self._torsion * on_wheel[1] + turned),
        }

    def upright(self) -> Vector:
        """Return the direction up from the wheel, across its axle and its way."""
        return kept(cross(self.ahead, self.axle))

    @staticmethod
    def _solved(
        of: tuple[Expression, Expression],
        matrix: tuple[Expression, Expression, Expression],
        determinant: Expression,
    ) -> tuple[Expression, Expression]:
        k11, k12, k22 = matrix
        return (
            named((k22 * of[0] - k12 * of[1]) / determinant),
            named((k11 * of[1] - k12 * of[0]) / determinant),
        )
