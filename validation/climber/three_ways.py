"""Fig. 6 of the climber's paper: three ways on one unrolled picture; and (30), chains closed step by step.

The ways: the planar model (1)-(3), the plant in place of what was measured, and the non-planar model, which
is exact rolling as eleven unknowns under nine constraints. (30) closes three chains from the surface to the
chassis by Gauss's and Newton's method. Its base's axes are not printed: see `Chains`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from validation.climber.constraints import Robot, Touch
from validation.climber.equal_speeds import JOINT_STOP_DEG
from validation.climber.plant import LEADING, Spins, Way, rolled, sizes
from validation.studies.solve import Floats, integrate
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

METERS: Final = 0.5
SECONDS: Final = 10.0
INSTANTS: Final = 101
HEADINGS: Final = (0.0, 45.0, 90.0, 135.0)
"""Degrees from round the tank towards its axis."""
ASSUMED: Final[Mapping[str, float]] = {"caster_radius": 0.0254, "caster_crown": 0.005}
"""A caster wheel of the driven wheels' size; r_t = 5 mm and c = 12 mm are the plant's own, assumed, too."""
DRIFT_MM: Final = 0.01
SOURCE: Final = "Qualls, Canfield, Shibakov, 2016, 5, Fig. 6"
STEPS_M: Final = (0.002, 0.001)
"""Way of a wheel during one step of (30)."""
CLOSED: Final = 1e-13
NEAR: Final = 1e-6
CHAINS: Final = ("left", "right", "caster")
OWN: Final = np.arange(3)
OWNERS: Final = np.array([0, 1, 2, *[0] * 4, *[1] * 3, *[2] * 5])
"""Chain of each evaluated row: the three as they are, then one for each unknown."""
UNKNOWN: Final = np.array([0, 1, 2, 4, 6, 7, 8, 12, 13, 14, 15, 16])
"""Unknown places in three rows of six: three turns of a contact, spin, joint or swivel, and one spare."""
REMARKS: Final = (
    "Fig. 6's own points are not at hand: in their place is the plant, without weight, spring and stops.",
    "Assumed: r_t = 5 mm, c = 12 mm, a caster wheel of 25.4 mm. The mirrored robot exchanges 45° and 135°.",
    "But at 0°, a trailing caster's joint runs past its stop before 0.5 m: from there it is geometry only.",
    "Caster leading is tail first from a swivel of 0: but at 0° it turns over within 0.2 m, and then trails.",
    "With the caster turned over from the start, as in the study equal_speeds, the drift is another.",
    "(30) fixes a rotation only where R(3,2) R(3,3) is not 0; so its base is assumed aslant.",
)


def laboratory(degrees: float, side: float = 1.0) -> dict[str, float]:
    """Return the laboratory's robot (section 5) at a heading, its joint left for 1, right for -1.

    The wheel whose axle is fixed in the chassis stands upright.
    """
    p = dict(sizes("lab", **ASSUMED, joint_side=side, start_heading=math.radians(degrees)))
    fixed = 1 if side > 0.0 else 0

    def tube(lean: float) -> float:
        return Robot.standing(p, p["start_heading"], 0.0, lean).touches()[fixed].tube

    before, lean = 1e-4, 0.0
    for _ in range(5):
        if abs(tube(lean)) < CLOSED:
            break
        slope = (tube(lean) - tube(before)) / (lean - before)
        before, lean = lean, lean - tube(lean) / slope
    return p | {"start_joint": lean}


@dataclass(frozen=True, slots=True)
class Chains:
    """Three chains of homogeneous transforms from the surface over a wheel to the chassis, [C] 2, (30).

    Each begins with a contact that rolls without slip: arc, height, psi, tube u and wheel angle v, moved by
    (15)-(17) (sign of psi's rate corrected) under turns q(1), q(2), q(3) about {W}'s axes. Then comes the
    wheel's spin q(4), given for both driven wheels; q(5) is the left wheel's joint, or the caster's swivel.
    The chassis's axes are ahead, left, up. Elements (1,3), (2,3), (3,1) fix a rotation R only where
    neither R(3,2) nor R(3,3) is 0; with the surface's normal as third axis R(3,2) is, at the start at 0°. So
    the base's third axis is halfway between the chassis's left and up at the start (assumed).
    """

    p: Mapping[str, float]
    base: Floats
    """Base's axes as rows."""
    contacts: Floats
    """Row for each chain: arc, height, psi, u, v."""
    angles: Floats
    """Row for each chain: spin q(4), and q(5): 0 for the right wheel's."""

    @classmethod
    def of(cls, robot: Robot) -> "Chains":
        """Return them closed at a robot's pose; its joint is the left wheel's."""
        read, (ahead, left, up) = robot.readings(), robot.frame
        base = np.array([ahead, (left - up) / math.sqrt(2.0), (left + up) / math.sqrt(2.0)])
        way = math.cos(robot.swivel) * ahead + math.sin(robot.swivel) * left
        names = ("arc", "height", "psi", "tube")
        contacts = [
            [*(read[f"{name}_{side}"] for name in names), -_pitch(touch, forward)]
            for side, touch, forward in zip(CHAINS, robot.touches(), (ahead, ahead, way), strict=True)
        ]
        angles = [[0.0, robot.joint], [0.0, 0.0], [0.0, robot.swivel]]
        return cls(robot.p, base, np.array(contacts), np.array(angles))

    def moved(self, spins: Spins, guess: Floats) -> tuple["Chains", Floats]:
        """Return them after both driven wheels' spins in rad, and the 18 turns q, from a guess of these."""
        turns = guess.copy()
        turns[[3, 9]] = spins
        for _ in range(8):
            off, slope = self.slope(turns)
            turns[UNKNOWN] -= np.linalg.lstsq(slope, off)[0]
            if np.abs(off).max() < CLOSED:
                break
        rows = turns.reshape(3, 6)
        return replace(self, contacts=self._rolled(rows, OWN), angles=self.angles + rows[:, 3:5]), turns

    def poses(self) -> tuple[Floats, Floats]:
        """Return the chassis by each chain: ahead, left, up as rows, 3 x 3 x 3, and its middle in m."""
        return self._placed(self.contacts, self.angles, OWN)

    def observed(self) -> float:
        """Return R(3,2) R(3,3): where it is 0, (30) has no one answer."""
        _, second, third = self.poses()[0][1] @ self.base[2]
        return float(second * third)

    def open(self) -> float:
        """Return the largest of the elements by which two chains differ, m or 1."""
        return float(np.abs(_differences(self._elements(*self.poses()))).max())

    def slope(self, turns: Floats) -> tuple[Floats, Floats]:
        """Return all differences of the elements in (30), and their slopes by the unknowns."""
        tried = np.repeat(turns[None], OWNERS.size, axis=0)
        tried[np.arange(3, OWNERS.size), UNKNOWN] += NEAR
        rows = tried.reshape(-1, 3, 6)[np.arange(OWNERS.size), OWNERS]
        contacts = self._rolled(rows, OWNERS)
        elements = self._elements(*self._placed(contacts, self.angles[OWNERS] + rows[:, 3:5], OWNERS))
        slope = np.empty((18, UNKNOWN.size))
        for place, owner in enumerate(OWNERS[3:]):
            changed = np.zeros((3, 6))
            changed[owner] = (elements[3 + place] - elements[owner]) / NEAR
            slope[:, place] = _differences(changed)
        return _differences(elements[:3]), slope

    def _elements(self, frames: Floats, middles: Floats) -> Floats:
        """Return (1,4), (2,4), (3,4), (1,3), (2,3), (3,1) of the transforms, as rows."""
        turned = frames @ self.base.T
        return np.column_stack([middles @ self.base.T, turned[:, 2, 0], turned[:, 2, 1], turned[:, 0, 2]])

    def _sizes(self, owners: NDArray[np.intp]) -> tuple[Floats, Floats]:
        """Return r_t and the circle of the tubes' middles, for each row."""
        p = self.p
        crown = np.array([p["crown_radius"], p["crown_radius"], p["caster_crown"]])
        wheel = np.array([p["wheel_radius"], p["wheel_radius"], p["caster_radius"]])
        return crown[owners], (wheel - crown)[owners]

    def _rolled(self, rows: Floats, owners: NDArray[np.intp]) -> Floats:
        """Return the contacts after a step's turns, by (15)-(17) and Runge's and Kutta's method."""
        crown, ring = self._sizes(owners)
        start = self.contacts[owners]
        across, ahead, about = rows[:, :3].T

        def rates(at: Floats) -> Floats:
            sine, cosine, far = np.sin(at[:, 2]), np.cos(at[:, 2]), ring + crown * np.cos(at[:, 3])
            bent, tank = np.cos(at[:, 3]) / far, 1.0 / self.p["tank_radius"]
            one, mixed, two = 1.0 / crown + tank * cosine**2, tank * sine * cosine, bent + tank * sine**2
            det = one * two - mixed**2
            tangent = (-two * ahead - mixed * across) / det, (one * across + mixed * ahead) / det
            on_wheel = tangent[0] / crown, tangent[1] / far
            turning = -(about - np.sin(at[:, 3]) * on_wheel[1])
            round_it, up = cosine * tangent[0] + sine * tangent[1], sine * tangent[0] - cosine * tangent[1]
            return np.column_stack([round_it, up, turning, *on_wheel])

        first = rates(start)
        second = rates(start + first / 2.0)
        third = rates(start + second / 2.0)
        return np.asarray(start + (first + 2.0 * (second + third) + rates(start + third)) / 6.0)

    def _placed(self, contacts: Floats, angles: Floats, owners: NDArray[np.intp]) -> tuple[Floats, Floats]:
        """Return the chassis's axes and middles at the ends of chains."""
        joined, castered = ((owners == chain)[:, None] for chain in (0, 2))
        (crown, ring), p = self._sizes(owners), self.p
        arc, height, psi, tube, angle = contacts.T[..., None]
        turn, pitch = arc / p["tank_radius"], angles[:, :1] - angle
        along, zero = np.array([0.0, 0.0, 1.0]), np.zeros_like(turn)
        normal = np.hstack([np.cos(turn), np.sin(turn), zero])
        around = np.hstack([-np.sin(turn), np.cos(turn), zero])
        trace, way = (
            np.cos(psi) * around + np.sin(psi) * along,
            np.sin(psi) * around - np.cos(psi) * along,
        )
        axle = np.cos(tube) * trace - np.sin(tube) * normal
        spoke = np.cos(tube) * normal + np.sin(tube) * trace
        wheel = (p["tank_radius"] + crown[:, None]) * normal + height * along + ring[:, None] * spoke
        # (way, axle, spoke) turn about the axle, then the joint about `ahead`, or the swivel about `up`.
        ahead, up = np.cos(pitch) * way + np.sin(pitch) * spoke, np.cos(pitch) * spoke - np.sin(pitch) * way
        joint, swivel = angles[:, 1:] * joined, angles[:, 1:] * castered
        left = np.cos(joint) * axle + np.sin(joint) * up
        risen = np.cos(joint) * up - np.sin(joint) * axle
        front = np.cos(swivel) * ahead - np.sin(swivel) * left
        beside = np.cos(swivel) * left + np.sin(swivel) * ahead
        to_middle = np.array([-1.0, 1.0, 0.0])[owners][:, None] * p["half_track"] * axle
        behind = p["caster_distance"] * front + p["caster_offset"] * ahead
        behind = behind + (p["wheel_radius"] - p["caster_radius"]) * risen
        middle = wheel + to_middle + castered * behind
        return np.stack([front, beside, risen], axis=1), middle


def _pitch(touch: Touch, forward: Floats) -> float:
    """Return the angle of a frame's forward axis about the axle from the contact's way, rad."""
    way = np.cross(touch.axle, touch.normal)
    way /= np.linalg.norm(way)
    return math.atan2(float(forward @ np.cross(way, touch.axle)), float(forward @ way))


def _differences(elements: Floats) -> Floats:
    left, right, caster = elements
    return np.concatenate([left - right, right - caster, caster - left])


@dataclass(frozen=True, slots=True)
class Closing:
    """A drive by (30) beside the integrated rates, step by step, by the way of a wheel in m.

    `apart` are both middles, m, `joint` both joints, rad, `turned` the axes, as their largest element;
    `open` is the largest element by which two chains differ.
    """

    way: Floats
    apart: Floats
    joint: Floats
    turned: Floats
    open: Floats


def closed_along(degrees: float, step: float, meters: float, *, tail: bool) -> Closing:
    """Drive at equal speeds by (30), m of a wheel at each step; `tail` first with the caster turned over."""
    p = laboratory(degrees)
    robot = Robot.standing(p, p["start_heading"], LEADING if tail else 0.0, p["start_joint"])
    spin = (-1.0 if tail else 1.0) * step / p["wheel_radius"]
    steps = round(meters / step)
    ways = robot.driven(lambda _: spin, lambda _: spin, float(steps), 1.0)
    chains, turns, rows = Chains.of(robot), np.zeros(18), []
    for expected in ways:
        frames, middles = chains.poses()
        away, turned = np.linalg.norm(middles[1] - expected.middle), np.abs(frames[1] - expected.frame).max()
        joint = abs(chains.angles[0, 1] - expected.joint)
        rows.append((away, joint, turned, chains.open()))
        chains, turns = chains.moved((spin, spin), turns)
    return Closing(step * np.arange(steps + 1.0), *np.array(rows, dtype=float).T)


@dataclass(frozen=True, slots=True)
class Three:
    """One drive three ways, each a row round the tank and one along it, m; and the plant's joint, rad."""

    name: str
    course: float
    planar: Floats
    plant: Floats
    exact: Floats
    joint: Floats

    def aside(self, way: Floats) -> Floats:
        """Return how far a way is to the left of the straight line along the course, mm."""
        return np.asarray(1e3 * (way[1] * math.cos(self.course) - way[0] * math.sin(self.course)))


def planar(p: Mapping[str, float], spins: Spins) -> Floats:
    """Return arc and height by the planar model (1)-(3), as rows, m."""
    ahead = p["wheel_radius"] * (spins[0] + spins[1]) / 2.0
    turn = p["wheel_radius"] * (spins[1] - spins[0]) / (2.0 * p["half_track"])

    def rates(_: float, at: Floats) -> Floats:
        return np.array([ahead * math.cos(at[2]), ahead * math.sin(at[2]), turn])

    start = np.array([0.0, 0.0, p["start_heading"]])
    return integrate(rates, start, np.linspace(0.0, SECONDS, INSTANTS))[:, :2].T


def driven(degrees: float, *, tail: bool, side: float = 1.0) -> Three:
    """Drive 0.5 m at equal speeds, nose first or tail first; the caster is behind the wheels' middle."""
    p = laboratory(degrees, side)
    spin = (-METERS if tail else METERS) / (SECONDS * p["wheel_radius"])
    robot = Robot.standing(p, p["start_heading"], 0.0, p["start_joint"])
    ways = robot.driven(lambda _: spin, lambda _: spin, SECONDS, SECONDS / (INSTANTS - 1))
    exact = Way.of([one.readings() for one in ways], p["tank_radius"])
    plant = rolled(p, (spin, spin), SECONDS, INSTANTS)
    paths = [np.array([way.arc - way.arc[0], way.height - way.height[0]]) for way in (plant, exact)]
    name = f"{degrees:g}°, caster {'leading' if tail else 'trailing'}"
    return Three(name, p["start_heading"], planar(p, (spin, spin)), paths[0], paths[1], plant.joint)


def largest(aside: Floats) -> float:
    """Return the deviation that is farthest from 0."""
    return float(aside[int(np.argmax(np.abs(aside)))])


def three_ways(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    headings = (45.0,) if quick else HEADINGS
    runs = {tail: [driven(each, tail=tail) for each in headings] for tail in (False, True)}
    every = (*runs[False], *runs[True])
    closings = [closed_along(45.0, each, 0.1 if quick else METERS, tail=True) for each in STEPS_M]
    return Findings(
        compared=(*(row for run in every for row in _compared(run)), *_closed(*closings)),
        plots=(
            *(
                Plot(
                    f"Three ways on the unrolled tank, caster {'leading' if tail else 'trailing'}",
                    "way round the tank [m]",
                    "way along the tank [m]",
                    tuple(curve for run in runs[tail] for curve in _paths(run)),
                    f"{SOURCE}: equal wheel speeds. The plant is in place of what was measured. "
                    "Where a path ends short of the planar one, the joint is far beyond its stop.",
                    equal=True,
                )
                for tail in (False, True)
            ),
            *(
                Plot(
                    f"Sideways off the straight line, caster {'leading' if tail else 'trailing'}",
                    "way of a wheel [m]",
                    "to the left of the course [mm]",
                    (
                        Curve("planar model, all", [0.0, METERS], [0.0, 0.0], "dashed"),
                        *(curve for run in runs[tail] for curve in _asides(run)),
                    ),
                    f"{SOURCE}, magnified. Left is seen along the robot's nose, also tail first.",
                )
                for tail in (False, True)
            ),
            Plot(
                "(30) beside integrated rates: 45°, tail first",
                "way of a wheel [m]",
                "distance of both middles [µm]",
                tuple(
                    Curve(f"step of {1e3 * step:g} mm", closing.way, 1e6 * closing.apart)
                    for step, closing in zip(STEPS_M, closings, strict=True)
                ),
                "Qualls, Canfield, Shibakov, 2016, (30): half the step, a quarter of the difference. "
                "The chains stay closed to rounding all the way.",
            ),
        ),
        sheets=(_sheet(every),),
        remarks=REMARKS,
    )


def _compared(run: Three) -> tuple[Compared, ...]:
    flat, plant, exact = (run.aside(way) for way in (run.planar, run.plant, run.exact))
    rows = (
        ("planar model, largest deviation", 0.0, largest(flat), 1e-9),
        ("largest deviation", largest(exact), largest(plant), DRIFT_MM),
        ("deviation at the end", float(exact[-1]), float(plant[-1]), DRIFT_MM),
    )
    return tuple(
        Compared(f"{run.name}: {what}", "mm", None, other, ours, near) for what, other, ours, near in rows
    )


def _closed(coarse: Closing, fine: Closing) -> tuple[Compared, ...]:
    name = "(30), 45°, tail first, steps of 1 mm"
    ratio = float(coarse.apart.max() / fine.apart.max())
    return (
        Compared(f"{name}: off the integrated rates", "µm", None, 0.0, 1e6 * float(fine.apart.max()), 1.0),
        Compared(f"{name}: joint off", "°", None, 0.0, math.degrees(fine.joint.max()), 0.001),
        Compared(f"{name}: chains open by", "nm", None, 0.0, 1e9 * float(fine.open.max()), 1e-3),
        Compared("(30): difference at twice the step, in shares", "1", None, 4.0, ratio, 0.1),
    )


def _paths(run: Three) -> tuple[Curve, ...]:
    return (
        Curve(f"planar, {math.degrees(run.course):g}°", run.planar[0], run.planar[1], "dashed"),
        Curve(f"plant, {math.degrees(run.course):g}°", run.plant[0], run.plant[1]),
        Curve(f"non-planar, {math.degrees(run.course):g}°", run.exact[0, ::10], run.exact[1, ::10], "points"),
    )


def _asides(run: Three) -> tuple[Curve, Curve]:
    way = np.linspace(0.0, METERS, INSTANTS)
    return (
        Curve(f"plant, {math.degrees(run.course):g}°", way, run.aside(run.plant)),
        Curve(f"non-planar, {math.degrees(run.course):g}°", way[::5], run.aside(run.exact)[::5], "points"),
    )


def _sheet(runs: tuple[Three, ...]) -> Sheet:
    def stopped(run: Three) -> float | str:
        beyond = np.flatnonzero(np.abs(np.degrees(run.joint)) > JOINT_STOP_DEG)
        return METERS * float(beyond[0]) / (INSTANTS - 1) if beyond.size else "never"

    return Sheet(
        "Largest deviation to the left on 0.5 m; 0 by the planar model",
        ("drive", "plant [mm]", "non-planar [mm]", "joint at its stop, 25°, after [m]"),
        tuple(
            (run.name, *(largest(run.aside(way)) for way in (run.plant, run.exact)), stopped(run))
            for run in runs
        ),
    )
