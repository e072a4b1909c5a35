"""The climbing robot once more, by another way: pose in space, contacts by geometry, eleven unknowns.

It shares no line with the plant: chassis twist, joint's rate, caster's swivel and spin follow from nine
linear equations, the velocity of the material at each of three contacts; where a wheel touches is searched
for at each instant. On cylinders. Given are both wheels' spins, or, as in the cases of the source, the speed
ahead and the turn rate of the chassis, of which spins follow.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt

from validation.studies.solve import integrate

Vector: TypeAlias = npt.NDArray[np.float64]
Speed: TypeAlias = Callable[[float], float]


SEARCHES: Final = 40
FOUND_RAD: Final = 1e-16
FOUND: Final = 1e-14
"""m, and of the sine by which the wheels lean against each other."""


@dataclass(frozen=True)
class Touch:
    """Point of a wheel nearest to the cylinder: its middle and axle, the point, the normal, the distance."""

    middle: Vector
    axle: Vector
    point: Vector
    normal: Vector
    gap: float

    @property
    def tube(self) -> float:
        """Angle of the axle off the surface, rad."""
        return math.asin(-float(self.normal @ self.axle))

    def psi(self) -> float:
        """Direction of the axle's trace, from round the cylinder towards its axis."""
        around = np.array([-self.normal[1], self.normal[0], 0.0])
        return math.atan2(self.axle[2], float(self.axle @ around)) % (2 * math.pi)


def touch(middle: Vector, axle: Vector, crown: float, wheel: float, tank: float) -> Touch:
    """Find where a torus is nearest to a cylinder about the third axis."""
    turn = math.atan2(middle[1], middle[0])
    for _ in range(SEARCHES):
        normal = np.array([math.cos(turn), math.sin(turn), 0.0])
        spoke = (normal @ axle) * axle - normal
        centre = middle + (wheel - crown) * spoke / math.sqrt(spoke @ spoke)
        before, turn = turn, math.atan2(centre[1], centre[0])
        if abs(turn - before) < FOUND_RAD:
            break
    return Touch(middle, axle, centre - crown * normal, normal, math.hypot(*centre[:2]) - crown - tank)


@dataclass
class Robot:
    """Pose of the robot: middle, the chassis's directions as rows (ahead, left, up), joint, swivel.

    The joint is in the left wheel's chain, or with `joint_side` = -1 in the right one's.
    """

    p: Mapping[str, float]
    middle: Vector
    frame: Vector
    joint: float = 0.0
    swivel: float = 0.0

    @classmethod
    def standing(
        cls, p: Mapping[str, float], heading: float, swivel: float = 0.0, lean: float = 0.0
    ) -> "Robot":
        """Put it on the cylinder: all three wheels touch, both driven ones stand upright but for `lean`."""
        sine, cosine = math.sin(heading), math.cos(heading)
        base = np.array([[0.0, cosine, sine], [0.0, -sine, cosine], [1.0, 0.0, 0.0]])

        def put(x: Vector) -> Robot:
            roll, pitch = x[1:3]
            rolled = [[1, 0, 0], [0, math.cos(roll), math.sin(roll)], [0, -math.sin(roll), math.cos(roll)]]
            pitched = [
                [math.cos(pitch), 0, math.sin(pitch)],
                [0, 1, 0],
                [-math.sin(pitch), 0, math.cos(pitch)],
            ]
            middle = np.array([p["tank_radius"] + x[0], 0.0, 0.0])
            return cls(p, middle, np.array(pitched) @ np.array(rolled) @ base, float(x[3]), swivel)

        def off(x: Vector) -> Vector:
            left, right, caster = put(x).touches()
            leaning = math.sin(left.tube) - math.sin(right.tube) - 2 * math.sin(lean / 2)
            return np.array([left.gap, right.gap, caster.gap, leaning])

        x = np.array([p["wheel_radius"], 0.0, 0.0, 0.0])
        for _ in range(30):
            now = off(x)
            slope = np.array([(off(x + 1e-7 * each) - now) / 1e-7 for each in np.eye(4)]).T
            x = x - np.linalg.solve(slope, now)
            if np.abs(now).max() < FOUND:
                break
        return put(x)

    @classmethod
    def placed(cls, p: Mapping[str, float], read: Mapping[str, float]) -> "Robot":
        """Put it where the contact of the chassis's wheel and the angles place it; other wheels follow."""
        side, to_left = ("right", 1.0) if p["joint_side"] > 0.0 else ("left", -1.0)
        turn, tube, psi, pitch = (
            read[f"arc_{side}"] / p["tank_radius"],
            *(read[each] for each in (f"tube_{side}", f"psi_{side}", "pitch")),
        )
        normal = np.array([math.cos(turn), math.sin(turn), 0.0])
        around, along = np.array([-normal[1], normal[0], 0.0]), np.array([0.0, 0.0, 1.0])
        left = math.cos(psi) * around + math.sin(psi) * along
        way = math.sin(psi) * around - math.cos(psi) * along
        axle = math.cos(tube) * left - math.sin(tube) * normal
        spoke = math.cos(tube) * normal + math.sin(tube) * left
        middle = (p["tank_radius"] + p["crown_radius"]) * normal + read[f"height_{side}"] * along
        middle = middle + (p["wheel_radius"] - p["crown_radius"]) * spoke
        ahead = math.cos(pitch) * way + math.sin(pitch) * np.cross(way, axle)
        frame = np.array([ahead, axle, np.cross(ahead, axle)])
        return cls(p, middle + to_left * p["half_track"] * axle, frame, read["joint"], read["swivel"])

    @property
    def joints(self) -> tuple[float, float]:
        """How far the left and the right wheel's half turn with each rad of the joint."""
        return (-1.0, 0.0) if self.p["joint_side"] > 0.0 else (0.0, 1.0)

    def touches(self) -> tuple[Touch, Touch, Touch]:
        """Return where left wheel, right wheel and caster are nearest to the cylinder."""
        p = self.p
        ahead, left, up = self.frame
        left_axle, right_axle = (
            math.cos(part * self.joint) * left + math.sin(part * self.joint) * up for part in self.joints
        )
        axle = math.cos(self.swivel) * left - math.sin(self.swivel) * ahead
        way = math.cos(self.swivel) * ahead + math.sin(self.swivel) * left
        behind = p["caster_distance"] * ahead + p["caster_offset"] * way
        caster = self.middle - behind - (p["wheel_radius"] - p["caster_radius"]) * up
        wheel = p["crown_radius"], p["wheel_radius"], p["tank_radius"]
        small = p["caster_crown"], p["caster_radius"], p["tank_radius"]
        return (
            touch(self.middle + p["half_track"] * left_axle, left_axle, *wheel),
            touch(self.middle - p["half_track"] * right_axle, right_axle, *wheel),
            touch(caster, axle, *small),
        )

    def rates(self, left_spin: float, right_spin: float) -> Vector:
        """Return the velocity of the middle, the angular velocity, the rates of joint, swivel, caster."""
        matrix = self._contacts()
        given = matrix[:, 9:] @ np.array([left_spin, right_spin])
        return np.asarray(np.linalg.solve(matrix[:, :9], -given))

    def held(self, speed: float, turn: float) -> Vector:
        """Return the same and both spins for a speed ahead and a turn rate of the chassis, about its up."""
        ahead, _, up = self.frame
        inputs = np.zeros((2, 11))
        inputs[0, :3], inputs[1, 3:6] = ahead, up
        matrix = np.vstack([self._contacts(), inputs])
        return np.asarray(np.linalg.solve(matrix, np.array([0.0] * 9 + [speed, turn])))

    def spins(self, speed: float, turn: float) -> tuple[float, float]:
        """Return the spins of the left and the right wheel for a motion of the chassis, rad/s."""
        left, right = self.held(speed, turn)[9:]
        return float(left), float(right)

    def forces(self, weight: Vector, place: Vector, joint: float) -> Vector:
        """Return the forces on left wheel, right wheel and caster, as rows, by virtual work.

        `weight` is a force at `place`, ahead, left and up of the middle; `joint` a torque on the right half.
        """
        matrix = self._contacts()[:, :9]
        loads = np.concatenate([weight, np.cross(place @ self.frame, weight), [joint, 0.0, 0.0]])
        return np.asarray(np.linalg.solve(matrix.T, -loads)).reshape(3, 3)

    def _contacts(self) -> Vector:
        """Return the velocities of the material at the contacts, for each of eleven unknowns."""
        touches = self.touches()
        ahead, _, up = self.frame
        pivot = self.middle - self.p["caster_distance"] * ahead
        matrix = np.zeros((9, 11))
        for row, (each, part) in enumerate(zip(touches, (*self.joints, 0.0), strict=True)):
            place = slice(3 * row, 3 * row + 3)
            matrix[place, :3] = np.eye(3)
            x, y, z = each.point - self.middle
            matrix[place, 3:6] = [[0, z, -y], [-z, 0, x], [y, -x, 0]]
            matrix[place, 6] = part * np.cross(ahead, each.point - self.middle)
            matrix[place, (9, 10, 8)[row]] = np.cross(each.axle, each.point - each.middle)
        matrix[6:9, 7] = np.cross(up, touches[2].point - pivot)
        return matrix

    def _as_vector(self) -> Vector:
        return np.concatenate([self.middle, self.frame.ravel(), [self.joint, self.swivel]])

    def _of(self, x: Vector) -> "Robot":
        return Robot(self.p, x[:3], x[3:12].reshape(3, 3), float(x[12]), float(x[13]))

    def driven(self, left: Speed, right: Speed, seconds: float, step: float) -> list["Robot"]:
        """Return it at every step of a run at these wheel speeds in rad/s, by Runge's and Kutta's method."""
        return self._carried(lambda t, robot: robot.rates(left(t), right(t)), seconds, step)

    def steered(self, speed: float, turn: float, seconds: float, step: float) -> list["Robot"]:
        """Return it at every step of a run at which the chassis has this speed ahead and this turn rate."""
        return self._carried(lambda _, robot: robot.held(speed, turn), seconds, step)

    def _carried(
        self, rates_at: Callable[[float, "Robot"], Vector], seconds: float, step: float
    ) -> list["Robot"]:
        def slope(t: float, at: Vector) -> Vector:
            robot = self._of(at)
            rates = rates_at(t, robot)
            turned = np.cross(rates[3:6], robot.frame).ravel()
            return np.concatenate([rates[:3], turned, rates[6:8]])

        times = np.linspace(0.0, round(seconds / step) * step, round(seconds / step) + 1)
        rows = integrate(slope, self._as_vector(), times)
        return [self, *map(self._of, rows[1:])]

    def readings(self) -> dict[str, float]:
        """Return what the plant calls so; arcs within half a turn of 0."""
        tank = self.p["tank_radius"]
        found = {"joint": self.joint, "swivel": self.swivel}
        for side, each in zip(("left", "right", "caster"), self.touches(), strict=True):
            turn = math.atan2(each.point[1], each.point[0])
            found |= {
                f"tube_{side}": each.tube,
                f"arc_{side}": turn * tank,
                f"height_{side}": float(each.point[2]),
                f"psi_{side}": each.psi(),
            }
        return found
