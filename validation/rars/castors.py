"""A platform on two driven wheels and two castors with mass, [R] 3.2, 3.3, (3.13)-(3.40), corrected.

Ours is the closed form by the wheels' speeds: I th'' = tau - C th'. The independent way is d'Alembert's: it
moves every mass along the floor, takes second differences, and adds up the work of each wheel's small turn.
Corrected: pivot minus wheel is d1 e - d2 f in (3.21), (3.28); (3.25) has -m S; (3.27) has its rows exchanged.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from validation.studies.solve import Floats, integrate
from validation.studies.study import Compared, Curve, Findings, Plot

SIDES: Final = (-1.0, 1.0)
"""Left and right castor, along i to the right."""
STEP: Final = 1e-4
"""s, of the second differences."""


@dataclass(frozen=True, slots=True)
class Castored:
    """Platform and castors; axes: i to the right, j ahead; lengths in m, from the rear axle's middle."""

    rear_track: float = 0.4
    rim: float = 0.05
    centre_ahead: float = 0.22
    pivots_ahead: float = 0.295
    """From the centre of mass on."""
    pivot_aside: float = 0.105
    mass: float = 70.0
    yaw_inertia: float = 3.2
    wheel_mass: float = 0.3
    spin_inertia: float = 4.65e-4
    wheel_yaw_inertia: float = 2.42e-4
    castor_mass: float = 0.35
    across: float = 0.0
    """d1: pivot beside its wheel."""
    trail: float = 0.04
    """d2: pivot behind its wheel at a swivel of 0; 0 needs a motor, as P has no inverse then."""

    @property
    def _ways(self) -> tuple[Floats, Floats]:
        """Speed ahead and yaw rate by the left and the right wheel's speed."""
        return self.rim / 2.0 * np.ones(2), self.rim / self.rear_track * np.array([-1.0, 1.0])

    def rates(self, swivels: Floats, spins: Floats) -> tuple[Floats, Floats]:
        """Return the castors' swivel rates and spins, rad/s, by swivels and the driven wheels' spins."""
        parts = [self._castor(side, angle) for side, angle in zip(SIDES, swivels, strict=True)]
        yaw = self._ways[1] @ spins
        turning = np.array([swivelling @ spins - yaw for _, swivelling in parts])
        return turning, np.array([rolling @ spins for rolling, _ in parts])

    def matrices(self, swivels: Floats, spins: Floats) -> tuple[Floats, Floats]:
        """Return I in kg.m2 and C in kg.m2/s."""
        lam = self.rim / self.rear_track
        yaw = 2.0 * lam**2 * self.wheel_yaw_inertia
        rear = self.spin_inertia + self.wheel_mass * self.rim**2 + yaw
        body = (self.mass * self.centre_ahead**2 + self.yaw_inertia) * lam**2
        mean = self.mass * self.rim**2 / 4.0
        inertia: Floats = np.array(
            [[rear + mean + body, mean - body - yaw], [mean - body - yaw, rear + mean + body]]
        )
        pull = self.mass * self.centre_ahead * self.rim**3 / self.rear_track**2
        coriolis: Floats = pull * (spins[0] - spins[1]) * np.array([[0.0, 1.0], [-1.0, 0.0]])
        each = self.castor_mass * self.rim**2 / 4.0
        for side, angle, turning in zip(SIDES, swivels, self.rates(swivels, spins)[0], strict=True):
            rolling, swivelling = self._castor(side, angle)
            # d/dt of both by the swivel: e' = psi' f, f' = -psi' e.
            swivels_on = turning * (self.rim * rolling + self.across * swivelling) / self.trail
            rolls_on = (-turning * self.trail * swivelling - self.across * swivels_on) / self.rim
            inertia += each * (6.0 * np.outer(rolling, rolling) + np.outer(swivelling, swivelling))
            coriolis += each * (6.0 * np.outer(rolling, rolls_on) + np.outer(swivelling, swivels_on))
        return inertia, coriolis

    def accelerations(self, swivels: Floats, spins: Floats, torques: Floats) -> Floats:
        """Return the driven wheels', rad/s2."""
        inertia, coriolis = self.matrices(swivels, spins)
        return np.asarray(np.linalg.solve(inertia, torques - coriolis @ spins), dtype=float)

    def balanced(self, swivels: Floats, spins: Floats, accelerations: Floats) -> Floats:
        """Return the torques in N.m that these accelerations need, by every mass's change of velocity."""
        turning = self.rates(swivels, spins)[0]
        yaw = float(self._ways[1] @ spins)
        later, before = (
            self._velocities(at * yaw, swivels + at * turning, spins + at * accelerations)
            for at in (STEP, -STEP)
        )
        torques = np.zeros(2)
        for wheel, alone in enumerate(np.eye(2)):
            moves = self._velocities(0.0, swivels, alone)
            for (weight, after), (_, earlier), (_, way) in zip(later, before, moves, strict=True):
                torques[wheel] += weight * (after - earlier) @ way / (2.0 * STEP)
        return torques

    def _velocities(self, heading: float, swivels: Floats, spins: Floats) -> list[tuple[float, Floats]]:
        """Return each mass with its velocity over the floor, each inertia with its turning."""
        ahead, yaw = (float(way @ spins) for way in self._ways)

        def over_floor(right: float, along: float) -> Floats:
            cos, sin = math.cos(heading), math.sin(heading)
            return np.array([cos * right - sin * along, sin * right + cos * along])

        found = [
            (self.mass, over_floor(-self.centre_ahead * yaw, ahead)),
            (self.yaw_inertia + 2.0 * self.wheel_yaw_inertia, np.array([yaw])),
        ]
        for side, spin in zip(SIDES, spins, strict=True):
            found.append((self.wheel_mass, over_floor(0.0, ahead + side * yaw * self.rear_track / 2.0)))
            found.append((self.spin_inertia, np.array([spin])))
        turning, rolling = self.rates(swivels, spins)
        for angle, swivels_at, rolls in zip(swivels, turning, rolling, strict=True):
            # Its wheel rolls along its own way; a disc: half its mass about the axle, a quarter upright.
            way = self.rim * rolls
            found.append((self.castor_mass, over_floor(-math.sin(angle) * way, math.cos(angle) * way)))
            disc = self.castor_mass * self.rim**2
            found.append((disc / 2.0, np.array([rolls])))
            found.append((disc / 4.0, np.array([swivels_at + yaw])))
        return found

    def _castor(self, side: float, angle: float) -> tuple[Floats, Floats]:
        """Return by the driven wheels' speeds a castor's spin, and its turning over the floor."""
        ahead, yaw = self._ways
        across = -(self.centre_ahead + self.pivots_ahead) * yaw
        along = ahead + side * self.pivot_aside * yaw
        cos, sin = math.cos(angle), math.sin(angle)
        swivelling = (across * cos + along * sin) / self.trail
        rolling = (along * cos - across * sin - swivelling * self.across) / self.rim
        return rolling, swivelling


SEED: Final = 7
POINTS: Final = 50
TORQUES: Final = (0.5, 0.8)
LASTS_S: Final = 10.0
TURNS_S: Final = 3.0
"""From here on the torques are turned round: the castors swing round."""
PUSH: Final = 0.2
"""N.m."""


def castors(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study; a quick one is the same."""
    del quick
    robot, chance = Castored(), np.random.default_rng(SEED)
    off = 0.0
    for _ in range(POINTS):
        swivels, spins, torques = chance.uniform(-1.4, 1.4, 2), *chance.uniform(-8.0, 8.0, (2, 2))
        needed = robot.balanced(swivels, spins, robot.accelerations(swivels, spins, torques))
        off = max(off, float(np.abs(needed - torques).max()))
    swivels, spins = np.array([0.3, -0.2]), np.array([4.0, 6.0])
    ours = robot.accelerations(swivels, spins, np.array(TORQUES))
    # By d'Alembert torques are linear in accelerations: two differences and a rest.
    rest = robot.balanced(swivels, spins, np.zeros(2))
    columns = np.column_stack([robot.balanced(swivels, spins, one) - rest for one in np.eye(2)])
    independent = np.linalg.solve(columns, np.array(TORQUES) - rest)
    times, rows = swung(robot)
    return Findings(
        compared=(
            *(
                Compared(
                    f"acceleration of the {name} wheel, swivels 0.3 and -0.2 rad, wheels at 4 and 6 rad/s",
                    "rad/s2",
                    None,
                    float(independent[place]),
                    float(ours[place]),
                    1e-5,
                    "",
                )
                for place, name in enumerate(("left", "right"))
            ),
            Compared(f"largest error of the torque over {POINTS} random points", "N.m", None, 0.0, off, 1e-5),
        ),
        plots=(
            Plot(
                "Two castors swing round as the platform turns back",
                "time [s]",
                "swivel [deg]",
                tuple(
                    Curve(f"{name} castor", times, np.degrees(rows[:, place]))
                    for place, name in enumerate(("left", "right"))
                ),
                f"From rest at 0.3 and -0.2 rad, both wheels pushed by {PUSH:g} N.m, from {TURNS_S:g} s on "
                "back by as much, the left by a tenth more; no friction. At 180 degrees it trails as it "
                "drives ahead; pushed it is unstable.",
            ),
        ),
        remarks=(
            (
                "The castors' masses and trail are assumed; the thesis prints none. RARS itself steers: this "
                "is a plant of its own, `castors`."
            ),
        ),
    )


def swung(robot: Castored) -> tuple[Floats, Floats]:
    """Return times, and swivels and driven wheels' speeds at each."""

    def rates(at: float, state: Floats) -> Floats:
        push = PUSH if at < TURNS_S else -PUSH
        torques = np.array([1.1 * push if at >= TURNS_S else push, push])
        swivels, spins = state[:2], state[2:]
        return np.concatenate([robot.rates(swivels, spins)[0], robot.accelerations(swivels, spins, torques)])

    times = np.linspace(0.0, LASTS_S, 301)
    return times, integrate(rates, np.array([0.3, -0.2, 0.0, 0.0]), times, 4)
