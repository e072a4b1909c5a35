"""Contact equations (15)-(17) of the climbing robot, corrected, against the exact rolling of a torus."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import sympy as sp

from fmu.climber.contact import Contact

Vector = npt.NDArray[np.float64]


def contact_rates(radii: tuple[float, float, float]) -> Any:
    tube, psi, arc, *omega = symbols = sp.symbols("tube psi arc wx wy wz", real=True)
    nothing = (sp.S.Zero, sp.S.Zero, sp.S.Zero)
    contact = Contact(tube, psi, nothing, arc / radii[2], tuple(map(sp.Float, radii)))
    found = contact.rates(tuple(omega))
    return sp.lambdify(symbols, [found[name] for name in ("tube", "psi", "arc", "height")])


def touching(
    middle: Vector, axle: Vector, radii: tuple[float, float, float], near: float
) -> tuple[float, float, float]:
    """Find tube angle, arc and height where a torus touches the cylinder, by its geometry alone."""
    crown, wheel, tank = radii

    def point(turn: float) -> Vector:
        normal = np.array([math.cos(turn), math.sin(turn), 0.0])
        spoke = -(normal - (normal @ axle) * axle)
        return np.asarray(middle + (wheel - crown) * spoke / np.linalg.norm(spoke) - crown * normal)

    turn = near
    for _ in range(50):
        place = point(turn)
        turn = math.atan2(place[1], place[0])
    place = point(turn)
    normal = np.array([math.cos(turn), math.sin(turn), 0.0])
    assert math.hypot(place[0], place[1]) == pytest.approx(tank, rel=1e-7)
    return math.asin(-float(normal @ axle)), turn * tank, float(place[2])


@pytest.mark.parametrize("psi", [math.pi, 2.2, 0.4])
@pytest.mark.parametrize("crown", [0.02, 0.006])
def test_contact_equations_against_exact_rolling(psi: float, crown: float) -> None:
    """(15)-(17) with the corrected sign: a torus that tilts, rolls and turns on a cylinder, v = 0."""
    radii = crown, 0.02, 0.15
    equations = contact_rates(radii)
    coordinates = np.array([0.0, psi, 0.0, 0.0])
    normal = np.array([1.0, 0.0, 0.0])
    axle = np.array([0.0, math.cos(psi), math.sin(psi)])
    middle = (radii[2] + radii[1]) * normal
    steps, length = 400, 1.0

    def omega(t: float, along: Vector) -> Vector:
        return np.asarray(
            2.0 * along + np.array([0.8 * math.cos(3 * t), 0.3 * math.sin(2 * t), -0.4 * math.cos(t)])
        )

    def motion(t: float, at: Vector) -> Vector:
        axle, middle, coordinates = at[:3], at[3:6], at[6:]
        turning = omega(t, axle)
        _, arc, height = touching(middle, axle, radii, coordinates[2] / radii[2])
        turn = arc / radii[2]
        place = np.array([radii[2] * math.cos(turn), radii[2] * math.sin(turn), height])
        speed = -np.cross(turning, place - middle)
        own = equations(*coordinates[:3], *turning)
        return np.concatenate([np.cross(turning, axle), speed, own])

    state, step = np.concatenate([axle, middle, coordinates]), length / steps
    for count in range(steps):
        t = count * step
        a = motion(t, state)
        b = motion(t + step / 2, state + step / 2 * a)
        c = motion(t + step / 2, state + step / 2 * b)
        d = motion(t + step, state + step * c)
        state = state + step / 6 * (a + 2 * b + 2 * c + d)
    tube, arc, height = touching(state[3:6], state[:3], radii, state[8] / radii[2])
    assert state[6] == pytest.approx(tube, abs=1e-8)
    assert state[8] == pytest.approx(arc, abs=1e-9)
    assert state[9] == pytest.approx(height, abs=1e-9)
    # psi is the direction of the axle's trace on the surface.
    around = np.array([-math.sin(arc / radii[2]), math.cos(arc / radii[2]), 0.0])
    direction = math.atan2(state[2], float(state[:3] @ around))
    assert math.cos(state[7] - direction) == pytest.approx(1.0, abs=1e-12)
