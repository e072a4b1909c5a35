"""Two wheels, a ball caster and the joint between both halves: angular velocities from the wheels' spins.

The equations (10) of [C] in another form: the material of each wheel stands still where it touches, the
caster's ball keeps its distance from the surface. Refuses to know motors and weight.
"""

from dataclasses import dataclass

from fmu.climber.contact import Contact
from fmu.climber.vectors import Vector, cross, dot, plus
from fmu.export.model import Expression


@dataclass(frozen=True, slots=True)
class Motion:
    """What one unit of wheel speeds does: angular velocity of the left half, the joint's rate."""

    turning: Vector
    joint: Expression
    slip: Vector
    """Velocity that the left wheel's spin gives to the chassis at its contact."""


class Chassis:
    """The left half with the caster on the joint's axis; the right half turns on that axis.

    The axis is longitudinal, through the middle O; `pitch` is the left half's angle about its axle.
    """

    def __init__(self, left: Contact, right: Contact, longitudinal: Vector, track: Expression) -> None:
        self.left, self.right = left, right
        self.longitudinal = longitudinal
        self.middle = plus((1, left.middle), (-track, left.axle))
        self.between = plus((1, right.place), (-1, left.place))
        self._joint_arm = cross(longitudinal, plus((1, right.place), (-1, self.middle)))

    def motion(self, left_spin: Expression, right_spin: Expression, caster: Expression) -> Motion:
        """Return the motion of these wheel speeds, with the ball `caster` behind the middle.

        Both contacts at rest: W x e = h - sigma' g. Its part along e gives sigma', its part across e all of W
        but the pitch about e; that follows from the caster.
        """
        e = self.between
        pushed = cross(self.left.axle, self.left.arm)
        h = plus((left_spin, pushed), (-right_spin, cross(self.right.axle, self.right.arm)))
        joint = dot(h, e) / dot(self._joint_arm, e)
        across = cross(e, plus((1, h), (-joint, self._joint_arm)))
        size = dot(e, e)
        turning = plus((1 / size, across))
        ball = self.behind(caster)
        place = plus((1, ball), (-1, self.left.place))
        # The caster's middle moves on a cylinder of its own: no speed along its radius.
        radius: Vector = (self.left.tank + ball[0], ball[1], 0 * ball[0])
        speed = plus((1, cross(turning, place)), (-left_spin, pushed))
        pitch = -dot(radius, speed) / dot(radius, cross(e, place))
        return Motion(plus((1, turning), (pitch, e)), joint, plus((-left_spin, pushed)))

    def behind(self, distance: Expression) -> Vector:
        """Return the point of the joint's axis this far behind the middle."""
        return plus((1, self.middle), (-distance, self.longitudinal))

    def velocity(self, motion: Motion, distance: Expression) -> Vector:
        """Return the velocity of that point."""
        arm = plus((1, self.behind(distance)), (-1, self.left.place))
        return plus((1, cross(motion.turning, arm)), (1, motion.slip))
