"""Contacts of wheels and caster at the start: Newton's method, written out, for any place and heading.

Given are the middle's place on the surface, heading, swivel and the joint's angle beyond upright wheels.
Unknown are height, roll and pitch of the chassis, the joint, and three places of contact.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import sympy as sp

from fmu.climber.chassis import JointSide, Sizes
from fmu.climber.contact import Torus
from fmu.climber.surfaces import Surface, SurfacePoint
from fmu.climber.vectors import Vector, cross, dot, kept, plus
from fmu.export.functions import angle, named
from fmu.export.model import Expression

LEANING: Final = 3
"""Rounds of Newton's method that turn the joint, too: until wheels are upright within some 1e-6 rad."""
ROUNDS: Final = 4
"""All rounds; a test shows that they do for every tank of the sets."""
TOLERANCE: Final = sp.Float(1e-9)
"""m that a wheel may be off the surface; beyond it, there is no start."""


@dataclass(frozen=True, slots=True)
class Given:
    """The requested start: m and rad."""

    arc: Expression
    height: Expression
    heading: Expression
    swivel: Expression
    joint: Expression


@dataclass(frozen=True, slots=True)
class _Pose:
    """The chassis: height over its place, roll, nose up; and the joint."""

    lift: Expression
    roll: Expression
    pitch: Expression
    joint: Expression


class _Foot:
    """Place of one wheel, given by middle and axle, near the surface: at s and z."""

    def __init__(self, surface: Surface, at: tuple[Expression, Expression], wheel: Torus) -> None:
        self.at, self.wheel, self._surface = at, wheel, surface
        self.place: SurfacePoint = surface(*at)

    def meets(self, middle: Vector, axle: Vector) -> None:
        """Measure how far the wheel's point whose normal is the surface's is off this place."""
        place, wheel = self.place, self.wheel
        normal = place.normal
        self.sine = named(-dot(normal, axle))
        self.cosine = named(sp.sqrt(1 - self.sine**2))
        self.left = kept(plus((1 / self.cosine, axle), (self.sine / self.cosine, normal)))
        self.ahead = kept(cross(self.left, normal))
        down = wheel.ring * self.cosine + wheel.crown
        touching = plus((1, middle), (-down, normal), (-wheel.ring * self.sine, self.left))
        off = kept(plus((1, touching), (-1, place.point)))
        self.touching = kept(touching)
        self.gap = named(dot(off, normal))
        self.off = off
        self._cosine = named(dot(self.left, place.along_s))
        self._sine = named(dot(self.left, place.along_z))
        ss, sz, zz = place.curvature
        self._across = named(ss * self._cosine**2 + 2 * sz * self._sine * self._cosine + zz * self._sine**2)

    def leaning(self, turning: Vector, moving: Vector) -> Expression:
        """Return how the axle rises against the surface when the wheel turns so, and moves where it touches.

        By (16), the surface below turns with the contact that moves sideways.
        """
        curved = 1 / self.wheel.crown
        turned = dot(turning, self.ahead) + self._across * dot(moving, self.left)
        return curved / (curved + self._across) * turned

    def moved(self) -> "_Foot":
        """Return the place that fits better: the point of the surface below the wheel."""
        place, wheel = self.place, self.wheel
        cosine, sine = self._cosine, self._sine
        ss, sz, zz = place.curvature
        k1, k2 = 1 / wheel.crown, self.cosine / (wheel.ring + wheel.crown * self.cosine)
        t12 = (ss - zz) * sine * cosine + sz * (sine**2 - cosine**2)
        t22 = ss * sine**2 - 2 * sz * sine * cosine + zz * cosine**2
        aside, along = dot(self.off, self.left), dot(self.off, self.ahead)
        step = _solved(((k1 + self._across, t12), (t12, k2 + t22)), (k1 * aside, k2 * along))
        s, z = self.at
        s += (cosine * step[0] + sine * step[1]) / place.metric[0]
        z += (sine * step[0] - cosine * step[1]) / place.metric[1]
        return _Foot(self._surface, (named(s), named(z)), wheel)


@dataclass(frozen=True, slots=True)
class _Body:
    """Directions and middles that follow from a pose."""

    left: Vector
    ahead: Vector
    up: Vector
    middle: Vector
    axles: tuple[Vector, Vector]
    """Of the left and the right wheel."""
    joints: tuple[Vector, Vector]
    """How the left and the right wheel turn with the joint."""


class Start:
    """The contacts at the start: tube, arc, height, psi of left, right, caster; pitch, joint."""

    def __init__(
        self, surface: Surface, given: Given, sizes: Sizes, side: JointSide, wheels: Sequence[Torus]
    ) -> None:
        self._given, self._sizes, self._side = given, sizes, side
        self._base = surface(given.arc, given.height)
        sine, cosine = named(sp.sin(given.heading)), named(sp.cos(given.heading))
        base = self._base
        self._ahead = kept(plus((cosine, base.along_s), (sine, base.along_z)))
        self._left = kept(plus((-sine, base.along_s), (cosine, base.along_z)))
        self._swing = named(sp.sin(given.swivel)), named(sp.cos(given.swivel))
        pose = _Pose(wheels[0].radius, sp.S.Zero, sp.S.Zero, given.joint)
        swing = self._swing
        behind = sizes.caster_behind + sizes.trail * swing[1]
        guesses = (
            (sp.S.Zero, sizes.track),
            (sp.S.Zero, -sizes.track),
            (-behind, -sizes.trail * swing[0]),
        )
        feet = [
            _Foot(
                surface,
                (
                    named(given.arc + (ahead * cosine - left * sine) / base.metric[0]),
                    named(given.height + (ahead * sine + left * cosine) / base.metric[1]),
                ),
                wheel,
            )
            for (ahead, left), wheel in zip(guesses, wheels, strict=True)
        ]
        # Newton's steps, unrolled into the equations: a start value has no loop in an FMU.
        for count in range(ROUNDS):
            body = self._meet(pose, feet)
            # The joint first comes to its angle with all four unknowns, and is left there afterwards.
            pose = self._stepped(pose, body, feet, 4 if count < LEANING else 3)
            self._meet(pose, feet)
            feet = [foot.moved() for foot in feet]
        body = self._meet(pose, feet)
        self._off = sum(dot(foot.off, foot.off) for foot in feet)
        self._read(pose, body, feet)

    def _body(self, pose: _Pose) -> _Body:
        base = self._base
        sine, cosine = named(sp.sin(pose.roll)), named(sp.cos(pose.roll))
        left = kept(plus((cosine, self._left), (sine, base.normal)))
        raised = plus((-sine, self._left), (cosine, base.normal))
        sine, cosine = named(sp.sin(pose.pitch)), named(sp.cos(pose.pitch))
        ahead = kept(plus((cosine, self._ahead), (sine, raised)))
        up = kept(plus((-sine, self._ahead), (cosine, raised)))
        middle = kept(plus((1, base.point), (pose.lift, base.normal)))
        # The joint's angle is the right half's against the left; the chassis's half does not turn.
        parts = -self._side.left, self._side.right
        angles = [part * pose.joint for part in parts]
        axles = [kept(plus((sp.cos(angle), left), (sp.sin(angle), up))) for angle in angles]
        joints = [kept(plus((part, ahead))) for part in parts]
        return _Body(left, ahead, up, middle, (axles[0], axles[1]), (joints[0], joints[1]))

    def _meet(self, pose: _Pose, feet: Sequence[_Foot]) -> _Body:
        body, sizes = self._body(pose), self._sizes
        sine, cosine = self._swing
        axle = plus((cosine, body.left), (-sine, body.ahead))
        way = plus((cosine, body.ahead), (sine, body.left))
        caster = plus(
            (1, body.middle),
            (-sizes.caster_behind, body.ahead),
            (-sizes.caster_drop, body.up),
            (-sizes.trail, way),
        )
        middles = (
            plus((1, body.middle), (sizes.track, body.axles[0])),
            plus((1, body.middle), (-sizes.track, body.axles[1])),
            caster,
        )
        for foot, middle, each in zip(feet, middles, (*body.axles, axle), strict=True):
            foot.meets(kept(middle), kept(each))
        return body

    def _stepped(self, pose: _Pose, body: _Body, feet: Sequence[_Foot], unknown: int) -> _Pose:
        """Return the pose whose wheels touch where they are nearest, and lean by the requested angle.

        With three unknowns, the joint stays as it is.

        Gaps change as the material at the contacts moves along the normal: to lift, to roll about the way
        ahead, to pitch about the axle, and at the wheel that it moves to the joint.
        """
        nothing = (sp.S.Zero, sp.S.Zero, sp.S.Zero)
        back = plus((-1, body.left))
        rows, offs, leans = [], [], []
        for foot, joint in zip(feet, (*body.joints, nothing), strict=True):
            arm = plus((1, foot.touching), (-1, body.middle))
            turns = (nothing, self._ahead, back, joint)
            moves = [kept(cross(turn, arm)) for turn in turns]
            moves[0] = self._base.normal
            rows.append([dot(foot.place.normal, move) for move in moves])
            offs.append(-foot.gap)
            leans.append([foot.leaning(*each) for each in zip(turns, moves, strict=True)])
        # Lean against each other: sine of the left wheel's minus that of the right one's.
        rows.append([one - other for one, other in zip(leans[0], leans[1], strict=True)])
        left, right = feet[0].place.normal, feet[1].place.normal
        lean = -2 * sp.sin(self._given.joint / 2)
        offs.append(lean - dot(left, body.axles[0]) + dot(right, body.axles[1]))
        step = _solved([row[:unknown] for row in rows[:unknown]], offs[:unknown])
        step += [sp.S.Zero] * (4 - unknown)
        was = (pose.lift, pose.roll, pose.pitch, pose.joint)
        return _Pose(*(named(old + change) for old, change in zip(was, step, strict=True)))

    def _read(self, pose: _Pose, body: _Body, feet: Sequence[_Foot]) -> None:
        given = self._given
        self.rows: dict[str, Expression] = {}
        left = given.heading + sp.pi / 2
        for side, foot, near in zip(
            ("left", "right", "caster"), feet, (left, left, left + given.swivel), strict=True
        ):
            sine, cosine = sp.sin(near), sp.cos(near)
            along = plus((cosine, foot.place.along_s), (sine, foot.place.along_z))
            across = plus((-sine, foot.place.along_s), (cosine, foot.place.along_z))
            self.rows |= {
                f"tube_{side}": angle(foot.sine, foot.cosine),
                f"arc_{side}": foot.at[0],
                f"height_{side}": foot.at[1],
                f"psi_{side}": near + angle(dot(foot.left, across), dot(foot.left, along)),
            }
        way = self._side.fixed_vector(feet[0].ahead, feet[1].ahead)
        self.rows["pitch"] = angle(dot(body.ahead, cross(way, body.left)), dot(body.ahead, way))
        # No number where the wheels do not touch: the plant refuses to start. Else it adds nothing.
        refusal = sp.sqrt(TOLERANCE**2 - self._off)
        self.rows["joint"] = named(pose.joint) + TOLERANCE * TOLERANCE * refusal


def _solved(rows: Sequence[Sequence[Expression]], right: Sequence[Expression]) -> list[Expression]:
    """Solve linear equations by elimination, their order being such that no pivot is near 0."""
    matrix = [[*map(named, row), named(value)] for row, value in zip(rows, right, strict=True)]
    count = len(matrix)
    for pivot in range(count):
        for row in range(pivot + 1, count):
            # No row exchange: symbols have no size to choose a pivot by.
            factor = named(matrix[row][pivot] / matrix[pivot][pivot])
            matrix[row] = [
                named(value - factor * above) for value, above in zip(matrix[row], matrix[pivot], strict=True)
            ]
    found: list[Expression] = [sp.S.Zero] * count
    for row in reversed(range(count)):
        rest = sum(matrix[row][other] * found[other] for other in range(row + 1, count))
        found[row] = named((matrix[row][count] - rest) / matrix[row][row])
    return found
