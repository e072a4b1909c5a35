"""Chassis, a half on a joint, two wheels and a caster: what moves when wheels turn, what forces hold it.

Eleven unknowns: the chassis's six, the joint's rate, both wheels' spins, the caster's swivel and spin. Nine
equations: the material of each wheel stands still where it touches, or slides there as commanded. Wheels'
spins are given, so nine unknowns remain; forces at the contacts follow from the transpose of the same matrix.
Both are solved here by elimination, in closed form. Not known here: motors, magnets and springs.
"""

from dataclasses import dataclass

import sympy as sp

from fmu.climber.contact import Contact
from fmu.climber.vectors import Vector, cross, dot, kept, plus
from fmu.export.functions import named
from fmu.export.model import Expression
from fmu.parts.symbols import HALF

STILL: Vector = (sp.S.Zero, sp.S.Zero, sp.S.Zero)


@dataclass(frozen=True, slots=True)
class Sizes:
    """Dimensions of the robot, in m; `caster_drop` is the caster's middle below the axles."""

    track: Expression
    caster_behind: Expression
    caster_drop: Expression
    trail: Expression


@dataclass(frozen=True, slots=True)
class JointSide:
    """The side of the half that the joint moves: `left` and `right` are 1 and 0, or 0 and 1.

    With factors of 0 and 1 a sum is exact: one set of equations has both robots, each other's mirror image.
    """

    left: Expression
    right: Expression

    @classmethod
    def of(cls, sign: Expression) -> "JointSide":
        """Return it by 1 for the left half, -1 for the right one."""
        return cls(named((1 + sign) * HALF), named((1 - sign) * HALF))

    def fixed(self, left: Expression, right: Expression) -> Expression:
        """Return the value of the wheel whose axle is fixed in the chassis."""
        return named(self.right * left + self.left * right)

    def fixed_vector(self, left: Vector, right: Vector) -> Vector:
        """Return the same of vectors."""
        return kept(plus((self.right, left), (self.left, right)))

    def moved_vector(self, left: Vector, right: Vector) -> Vector:
        """Return the vector of the wheel that the joint moves."""
        return kept(plus((self.left, left), (self.right, right)))


@dataclass(frozen=True, slots=True)
class ChassisMotion:
    """Angular velocity of the chassis, the rates of joint, swivel and caster, all in rad/s.

    `carried` is the velocity of the chassis in m/s, where its wheel touches.
    """

    turning: Vector
    joint: Expression
    swivel: Expression
    caster: Expression
    carried: Vector

    def plus(self, other: "ChassisMotion") -> "ChassisMotion":
        """Return both together."""
        return ChassisMotion(
            kept(plus((1, self.turning), (1, other.turning))),
            named(self.joint + other.joint),
            named(self.swivel + other.swivel),
            named(self.caster + other.caster),
            kept(plus((1, self.carried), (1, other.carried))),
        )


class Chassis:
    """The chassis with one wheel's axle and the caster's pivot; the other wheel's half turns on the joint.

    The joint's axis is longitudinal, through the middle O between the wheels; the swivel's goes up, through
    the joint's axis. `pitch` is the chassis's angle about its axle, nose up positive.
    """

    def __init__(
        self,
        contacts: tuple[Contact, Contact, Contact],
        pitch: Expression,
        sizes: Sizes,
        side: JointSide,
    ) -> None:
        self.left, self.right, self.caster = contacts
        self.sizes, self.side = sizes, side
        left, right = self.left, self.right
        axle = side.fixed_vector(left.axle, right.axle)
        way = side.fixed_vector(left.ahead, right.ahead)
        self.ahead = kept(plus((sp.cos(pitch), way), (sp.sin(pitch), cross(way, axle))))
        self.up = kept(cross(self.ahead, axle))
        # The axle points to the left: to the middle from the right wheel, away from it from the left one.
        self._to_left = named(side.left - side.right)
        self.middle = kept(
            plus((1, side.fixed_vector(left.middle, right.middle)), (self._to_left * sizes.track, axle))
        )
        self._fixed = side.fixed_vector(left.point, right.point)
        self._between = kept(plus((1, right.point), (-1, left.point)))
        moved = side.moved_vector(left.point, right.point)
        self._joint_arm = kept(cross(self.ahead, plus((1, moved), (-1, self.middle))))
        self._per_size = named(1 / dot(self._between, self._between))
        self._leverage = named(dot(self._joint_arm, self._between))
        caster = self.caster
        pivot = self.at(-sizes.caster_behind, sp.S.Zero)
        self._to_caster = kept(plus((1, caster.point), (-1, self._fixed)))
        self._swivel_arm = kept(cross(self.up, plus((1, caster.point), (-1, pivot))))
        # What the caster hinders: all but rolling on and swivelling.
        self._sideways = named(dot(self._swivel_arm, caster.left))
        slant = dot(self._swivel_arm, caster.normal) / self._sideways
        self._hindered = kept(plus((1, caster.normal), (-slant, caster.left)))
        self._tipping_arm = kept(cross(self._between, self._to_caster))
        self._tipping = named(dot(self._hindered, self._tipping_arm))

    def at(self, ahead: Expression, up: Expression) -> Vector:
        """Return the point of the chassis that lies so far ahead of the middle, and above it."""
        return plus((1, self.middle), (ahead, self.ahead), (up, self.up))

    def rolling(self, left_spin: Expression, right_spin: Expression) -> ChassisMotion:
        """Return the motion of these wheel speeds, forwards in rad/s, without slip."""
        left, right = (
            kept(plus((spin * contact.width, contact.ahead)))
            for spin, contact in ((left_spin, self.left), (right_spin, self.right))
        )
        return self._motion(left, right, STILL)

    def sliding(self, left: Vector, right: Vector, caster: Vector) -> ChassisMotion:
        """Return the motion that comes with material of the wheels sliding so at the contacts."""
        return self._motion(left, right, caster)

    def _motion(self, left: Vector, right: Vector, caster: Vector) -> ChassisMotion:
        """Solve V + W x r = what the contacts allow; h: what the right one has more than the left.

        W x e = h - sigma' g. Its part along e gives sigma', its part across e all of W but the pitch about e;
        that follows from the caster.
        """
        # W x e has no part along e: that of h is the joint's alone.
        e, h = self._between, kept(plus((1, right), (-1, left)))
        carried = self.side.fixed_vector(left, right)
        joint = named(dot(h, e) / self._leverage)
        turning = plus((self._per_size, cross(e, plus((1, h), (-joint, self._joint_arm)))))
        turning = kept(turning)
        speed = kept(plus((1, carried), (1, cross(turning, self._to_caster)), (-1, caster)))
        pitch = named(-dot(self._hindered, speed) / self._tipping)
        speed = kept(plus((1, speed), (pitch, self._tipping_arm)))
        swivel = named(-dot(self.caster.left, speed) / self._sideways)
        rolling = dot(self.caster.ahead, speed) + swivel * dot(self.caster.ahead, self._swivel_arm)
        return ChassisMotion(
            kept(plus((1, turning), (pitch, e))), joint, swivel, rolling / self.caster.width, carried
        )

    def turnings(
        self, motion: ChassisMotion, spins: tuple[Expression, Expression]
    ) -> tuple[Vector, Vector, Vector]:
        """Return the angular velocities of both wheels and of the caster's."""
        whole, side = motion.turning, self.side
        # The joint's angle is the right half's against the left, whichever of them is the chassis.
        return (
            plus((1, whole), (-side.left * motion.joint, self.ahead), (spins[0], self.left.axle)),
            plus((1, whole), (side.right * motion.joint, self.ahead), (spins[1], self.right.axle)),
            plus((1, whole), (motion.swivel, self.up), (motion.caster, self.caster.axle)),
        )

    def forces(self, weight: Vector, place: Vector, joint: Expression) -> tuple[Vector, Vector, Vector]:
        """Return what the surface does to wheels and caster, in N, while nothing accelerates.

        `weight` is a force at `place` in the chassis, `joint` the torque on the right half about its axis.
        The caster swivels and rolls freely.
        """
        e = self._between
        moment = cross(plus((1, place), (-1, self._fixed)), weight)
        # Moment about the line through both wheels' contacts: the caster alone can bear it.
        caster = kept(plus((-dot(e, moment) / self._tipping, self._hindered)))
        moment = kept(plus((1, moment), (1, cross(self._to_caster, caster))))
        # From the chassis's wheel to the other one: e, or turned round where that is the left wheel.
        moved = kept(plus((-self._to_left * self._per_size, cross(e, moment))))
        # The joint transmits only its own torque: that fixes the part along e.
        along = named((self._to_left * joint - dot(self._joint_arm, moved)) / self._leverage)
        moved = kept(plus((1, moved), (along, e)))
        fixed = kept(plus((-1, weight), (-1, moved), (-1, caster)))
        left, right = self.side.moved_vector(moved, fixed), self.side.moved_vector(fixed, moved)
        return left, right, caster
