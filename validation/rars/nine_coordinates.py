"""The robot by nine coordinates, its steered wheels with mass: [R] 3.4.2, 3.4.3, (3.46)-(3.76), corrected.

q' = (w1, w2, y1', y2', x', psi1', psi2', w4, w5): spins of the rear wheels, their speeds ahead, the speed to
the right, both steers' rates, spins of the front wheels. Ours are the printed matrices, corrected: abar_2
ends in -2 m_w (lam1^2 - lam2 lam3) (3.70). The independent way adds up the work of every mass's acceleration.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from validation.rars.plant import P
from validation.studies.solve import Floats
from validation.studies.study import Compared, Findings, Sheet

SEED: Final = 11
POINTS: Final = 200
STEP: Final = 1e-5


@dataclass(frozen=True, slots=True)
class Nine:
    """Masses and lengths; SI units, Tab. 3.1 where it has them."""

    rear_track: float = P["rear_track"]
    front_track: float = 0.210
    centre_ahead: float = P["centre_offset"]
    front_ahead: float = P["wheelbase"] - P["centre_offset"]
    """Front axle from the centre of mass on."""
    mass: float = P["platform_mass"]
    yaw_inertia: float = P["yaw_inertia"]
    wheel_mass: float = P["wheel_mass"]
    spin_inertia: float = P["wheel_spin_inertia"]
    wheel_yaw_inertia: float = P["wheel_yaw_inertia"]

    @property
    def alphas(self) -> tuple[float, float, float, float]:
        """al1 to al4 of (3.70): kg."""
        track, mass, wheel = self.rear_track, self.mass, self.wheel_mass
        lam1 = (self.centre_ahead + self.front_ahead) / track
        lam2, lam3 = ((track + sign * self.front_track) / 2.0 / track for sign in (-1.0, 1.0))
        turned = (self.yaw_inertia + 4.0 * self.wheel_yaw_inertia) / track**2
        share = self.centre_ahead / track
        return (
            turned + mass * (share**2 + 0.25) + wheel * (2.0 * lam1**2 + lam2**2 + lam3**2 + 1.0),
            -turned + mass * (0.25 - share**2) - 2.0 * wheel * (lam1**2 - lam2 * lam3),
            share * mass + 2.0 * lam1 * wheel,
            mass + 4.0 * wheel,
        )

    def inertia(self) -> Floats:
        """Return M, 9 by 9."""
        one, two, three, four = self.alphas
        found = np.zeros((9, 9))
        for spin in (0, 1, 7, 8):
            found[spin, spin] = self.spin_inertia
        found[2:5, 2:5] = [[one, two, three], [two, one, -three], [three, -three, four]]
        upright = self.wheel_yaw_inertia
        for steer in (5, 6):
            found[steer, steer] = upright
            for rear, sign in ((2, -1.0), (3, 1.0)):
                found[steer, rear] = found[rear, steer] = sign * upright / self.rear_track
        return found

    def coriolis(self, rates: Floats) -> Floats:
        """Return C, 9 by 9, for these rates."""
        _, _, three, four = self.alphas
        found = np.zeros((9, 9))
        yaw = (rates[3] - rates[2]) / self.rear_track
        half = four / 2.0
        found[2:5, 2:5] = yaw * np.array([[0.0, -three, half], [three, 0.0, half], [-half, -half, 0.0]])
        return found

    def added(self, rates: Floats, accelerations: Floats) -> Floats:
        """Return the forces that these accelerations need: every mass's acceleration over the floor."""
        forces = np.zeros(9)
        for weight, ways in self._masses():
            way = ways @ rates
            if len(ways) == 1:
                forces += weight * ways.T @ (ways @ accelerations)
                continue
            # Over the floor, in the body's axes: what it changes, and what the body turns it by.
            yaw = (rates[3] - rates[2]) / self.rear_track
            over_floor = ways @ accelerations + yaw * np.array([-way[1], way[0]])
            forces += weight * ways.T @ over_floor
        return forces

    def _masses(self) -> list[tuple[float, Floats]]:
        """Return each mass with its velocity, right and ahead, each inertia with its turning, by q'."""
        rows = np.eye(9)
        yaw = (rows[3] - rows[2]) / self.rear_track
        ahead = (rows[2] + rows[3]) / 2.0

        def at(right: float, along: float) -> Floats:
            return np.array([rows[4] - along * yaw, ahead + right * yaw])

        found = [(self.mass, at(0.0, self.centre_ahead)), (self.yaw_inertia, yaw[None])]
        found += [(self.spin_inertia, rows[[spin]]) for spin in (0, 1, 7, 8)]
        front = self.centre_ahead + self.front_ahead
        for side in (-0.5, 0.5):
            found.append((self.wheel_mass, at(side * self.rear_track, 0.0)))
            found.append((self.wheel_mass, at(side * self.front_track, front)))
            found.append((self.wheel_yaw_inertia, yaw[None]))
        found += [(self.wheel_yaw_inertia, (yaw + rows[steer])[None]) for steer in (5, 6)]
        return found


def largest_error(robot: Nine, points: int = POINTS) -> float:
    """Return the largest difference of the forces over random rates and accelerations, N and N.m."""
    chance, off = np.random.default_rng(SEED), 0.0
    for _ in range(points):
        rates, accelerations = chance.uniform(-2.0, 2.0, (2, 9))
        ours = robot.inertia() @ accelerations + robot.coriolis(rates) @ rates
        off = max(off, float(np.abs(ours - robot.added(rates, accelerations)).max()))
    return off


def nine_coordinates(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study; a quick one is the same."""
    del quick
    robot = Nine()
    names = ("w1", "w2", "y1'", "y2'", "x'", "psi1'", "psi2'", "w4", "w5")
    units = np.eye(9)
    added = np.column_stack([robot.added(np.zeros(9), one) for one in units])
    places = ((2, 2, "al1"), (2, 3, "al2"), (2, 4, "al3"), (4, 4, "al4"))
    return Findings(
        compared=(
            *(
                Compared(f"{name}, Tab. 3.1", "kg", None, float(added[row, column]), alpha, 1e-9)
                for (row, column, name), alpha in zip(places, robot.alphas, strict=True)
            ),
            Compared(
                f"largest error over {POINTS} random rates and accelerations",
                "N",
                None,
                0.0,
                largest_error(robot),
                1e-9,
            ),
        ),
        sheets=(
            Sheet(
                "M by the masses' sums, kg and kg.m2",
                ("", *names),
                tuple((name, *map(float, row)) for name, row in zip(names, added, strict=True)),
            ),
        ),
        remarks=(
            (
                "The front wheels' distance is assumed, 0.210 m; that of their centres is not printed. "
                "RARS's plant has its steered wheels without mass: the plant `nine_coordinates` has this."
            ),
        ),
    )
