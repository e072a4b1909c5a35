"""Over a step of 20 mm on springs: pushes, loads, and a wheel in the air, [R] 2.3, Fig. 2.3.

The thesis prints the step and the wheel's diameter of 100 mm, no stiffness, travel or damping: those are
assumed. Ours is the body on four springs that only push, driven over a step; the independent ways are closed
forms and sums.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from validation.rars.plant import P
from validation.studies.solve import Floats, integrate
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

STEP_M: Final = 0.020
RIM: Final = P["wheel_radius"]
GRAVITY: Final = P["gravity"]
BASE: Final = P["wheelbase"]
TRACK: Final = P["rear_track"]
FRONT: Final = 0.336
"""Front contact to front contact, of 2.3.1: assumed to be the contacts'."""
OFFSETS: Final = (0.220, 0.141)
"""Rear axle to the centre of mass: Tab. 3.1, and 2.3.1."""
STIFF: Final = 2e4
"""N/m, assumed."""
DAMPED: Final = 400.0
"""N.s/m, assumed."""
INERTIAS: Final = (1.18, 1.28)
"""kg.m2, roll and pitch: Tab. 3.1, elements (1,1) and (2,2)."""
SPEED: Final = 0.1
GRIPS: Final = 0.3
CORNERS: Final = ("front left", "front right", "rear left", "rear right")
FRONTS: Final = (0, 1)
MEETS_S: Final = 0.6
"""Time when a front wheel's axle is over the edge."""
RIDE_S: Final = 3.0


def pushes(x_m: Floats | float) -> Floats:
    """Return the push that lifts a wheel over its load, the axle so far before the edge."""
    x = np.abs(np.asarray(x_m))
    found: Floats = x / np.sqrt(RIM**2 - x**2)
    return found


def rises(x_m: Floats | float) -> Floats:
    """Return how high the axle of a wheel is over the floor's level; x before the edge is negative, m."""
    x = np.asarray(x_m)
    begins = math.sqrt(RIM**2 - (RIM - STEP_M) ** 2)
    on = np.sqrt(np.maximum(RIM**2 - np.minimum(x, 0.0) ** 2, 0.0)) - (RIM - STEP_M)
    return np.where(x < -begins, 0.0, on)


def loads(offset: float) -> tuple[float, float]:
    """Return the standing load of the front pair and of the rear pair, N."""
    front = P["platform_mass"] * GRAVITY * offset / BASE
    return front, P["platform_mass"] * GRAVITY - front + 2.0 * P["wheel_mass"] * GRAVITY


@dataclass(frozen=True, slots=True)
class Sprung:
    """The body on a spring at each contact: heave, roll and pitch; no wheel has mass."""

    stiffness: float = STIFF
    damping: float = DAMPED
    offset: float = OFFSETS[0]
    front_track: float = FRONT

    @property
    def corners(self) -> Floats:
        """Each contact ahead and to the left of the centre of mass, m."""
        ahead, back = BASE - self.offset, -self.offset
        front, rear = self.front_track / 2.0, TRACK / 2.0
        return np.array([(ahead, front), (ahead, -front), (back, rear), (back, -rear)])

    @property
    def masses(self) -> Floats:
        """Mass, roll's and pitch's inertia."""
        return np.array([P["platform_mass"], *INERTIAS])

    @property
    def ways(self) -> Floats:
        """How a contact rises by heave, roll (left up) and pitch (nose up), a row each."""
        x, y = self.corners.T
        return np.column_stack((np.ones(4), y, x))

    def standing(self) -> Floats:
        """Return what each spring gives standing on the level, N: no spring sees a twist then."""
        ways = self.ways
        weight = np.array([self.masses[0] * GRAVITY, 0.0, 0.0])
        found: Floats = ways @ np.linalg.solve(ways.T @ ways, weight)
        return found

    def forces(self, body: Floats, moves: Floats, floor: Floats, rising: Floats) -> Floats:
        """Return each spring's push for the places of body and floor, and their rates, N; 0 in the air."""
        pressed = self.standing() + self.stiffness * (floor - self.ways @ body)
        return np.maximum(pressed + self.damping * (rising - self.ways @ moves), 0.0)

    def resting(self, floor: Floats) -> Floats:
        """Return the springs' pushes at rest on a floor, N, by Newton's steps."""
        body = np.zeros(3)
        for _ in range(50):
            pressed = self.standing() + self.stiffness * (floor - self.ways @ body)
            bears = pressed > 0.0
            rest = self.ways.T @ np.maximum(pressed, 0.0) - np.array([self.masses[0] * GRAVITY, 0.0, 0.0])
            slope = self.stiffness * self.ways.T @ (bears[:, None] * self.ways)
            body = body + np.linalg.lstsq(slope, rest, rcond=None)[0]
        return self.forces(body, np.zeros(3), floor, np.zeros(4))

    def ridden(self, wheels: tuple[int, ...]) -> tuple[Floats, Floats]:
        """Return times and the springs' pushes as some wheels drive over the step at a constant speed."""
        start = np.zeros(6)
        begins = np.full(4, np.inf)
        for wheel in wheels:
            # The wheel comes to the edge: front ones first, by the wheelbase.
            begins[wheel] = MEETS_S if wheel in FRONTS else MEETS_S + BASE / SPEED

        def floor(at: float) -> Floats:
            found: Floats = rises(SPEED * (at - np.where(np.isinf(begins), 1e6, begins)))
            return found

        def rates(at: float, state: Floats) -> Floats:
            rising = (floor(at + 1e-5) - floor(at - 1e-5)) / 2e-5
            pushed = self.forces(state[:3], state[3:], floor(at), rising)
            rest = self.ways.T @ pushed - np.array([self.masses[0] * GRAVITY, 0.0, 0.0])
            return np.concatenate((state[3:], rest / self.masses))

        times = np.linspace(0.0, RIDE_S + BASE / SPEED, 801)
        rows = integrate(rates, start, times, 10)
        pushed = [
            self.forces(row[:3], row[3:], floor(at), (floor(at + 1e-5) - floor(at - 1e-5)) / 2e-5)
            for at, row in zip(times, rows, strict=True)
        ]
        return times, np.array(pushed)


def leaves_at(offset: float, front_track: float = FRONT) -> float:
    """Return the stiffness in N/m above which one wheel on the step lifts another off the floor."""
    low, high = 1e3, 1e6
    for _ in range(60):
        middle = math.sqrt(low * high)
        floor = np.array([STEP_M, 0.0, 0.0, 0.0])
        lifted = Sprung(middle, 0.0, offset, front_track).resting(floor).min() <= 0.0
        low, high = (low, middle) if lifted else (middle, high)
    return low


def frictions(offset: float) -> tuple[float, float]:
    """Return the friction that both front wheels at once need of the rear ones, and one of them alone."""
    front, rear = loads(offset)
    both = float(pushes(-contact_m())) * front / rear
    return both, both / 2.0


def contact_m() -> float:
    """Return how far before the edge the axle is when its wheel meets it, m."""
    return math.sqrt(RIM**2 - (RIM - STEP_M) ** 2)


@cache
def _ridden() -> tuple[Floats, Floats]:
    return Sprung().ridden((0, 2))


def step(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study; a quick one is the same."""
    del quick
    way = np.linspace(-contact_m(), 0.0, 20001)
    push = pushes(way)
    work = float(((push[1:] + push[:-1]) / 2.0 * np.diff(way)).sum())
    times, pushed = _ridden()
    raised = Sprung().resting(np.array([STEP_M, 0.0, 0.0, 0.0])) - Sprung().standing()
    return Findings(
        compared=(
            Compared("work over load, along the way over the edge", "m", None, STEP_M, work, 1e-6),
            Compared(
                "height of the axle at the edge, over the floor's level",
                "m",
                None,
                STEP_M,
                float(rises(0.0)),
                1e-12,
            ),
            *(
                Compared(
                    f"load of the {name} spring that a step under the front left one changes",
                    "N",
                    None,
                    sign * STIFF * STEP_M * _twist(),
                    float(change),
                    1e-6,
                    "a trapezium; of a rectangle it is a quarter of stiffness times step",
                )
                for name, sign, change in zip(CORNERS, (1.0, -1.0, -_far(), _far()), raised, strict=True)
            ),
        ),
        plots=(
            Plot(
                "Push over load as a wheel of 100 mm climbs 20 mm",
                "axle before the edge [mm]",
                "push over load [1]",
                (Curve("one wheel", 1e3 * way[::100], push[::100]),),
                "|x| / sqrt(r² - x²), quasi-static; 1.333 at the first touch.",
            ),
            Plot(
                "The left wheels drive over the step on springs",
                "time [s]",
                "push of the spring [N]",
                tuple(Curve(name, times, pushed[:, place]) for place, name in enumerate(CORNERS)),
                f"{SPEED:g} m/s, {STIFF:g} N/m and {DAMPED:g} N.s/m at each wheel, assumed. The diagonal of "
                "a raised wheel bears more, the other one less: on stiffer springs a wheel is in the air.",
            ),
        ),
        sheets=(
            Sheet(
                "What a step of 20 mm needs",
                (
                    *("rear axle to centre of mass [m]", "front pair [N]", "rear pair [N]"),
                    *("friction, both front wheels [1]", "friction, one [1]", "energy to lift the front [J]"),
                    "a wheel leaves the floor above [N/m]",
                ),
                tuple(
                    (offset, *loads(offset), *frictions(offset), loads(offset)[0] * STEP_M, leaves_at(offset))
                    for offset in OFFSETS
                ),
            ),
        ),
        remarks=(
            (
                "No stiffness, damping or travel is printed: assumed. A driven wheel alone climbs from "
                "standstill only where the friction is 1.333 or more; at 0.3 the rear wheels push one front "
                "wheel at a time with the centre of mass at 141 mm, both not; at 0.5 m/s its 8.8 J lift "
                "its front."
            ),
            (
                "A driven wheel in the air turns free; the other one drives on, as each has a motor: the "
                "source's reason for two. RARS's plant has rigid wheels on a plane; the plant "
                "`rars_sprung` has springs."
            ),
        ),
    )


def _twist() -> float:
    """Return the share of a step that the front spring over it takes up: a quarter of a rectangle."""
    null = _null()
    return float(null[0] * null[0])


def _far() -> float:
    """Return how a rear spring's load changes over a front one's, by the twist that no motion takes up."""
    null = _null()
    return float(abs(null[2] / null[0]))


def _null() -> Floats:
    """Return the loads that neither lift nor turn the body, of length 1."""
    found: Floats = np.linalg.svd(Sprung().ways.T)[2][-1]
    return found
