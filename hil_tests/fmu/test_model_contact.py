"""Surfaces by their forms, and the climber's contact equations (15)-(17) against exact rolling on them."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import sympy as sp

from fmu.climber.contact import Contact, Torus
from fmu.climber.surfaces import Surface, cylinder, plane, sphere, torus

Vector = npt.NDArray[np.float64]
TANK, RING = 0.15, 0.4
SURFACES: dict[str, Surface] = {
    "cylinder": cylinder(sp.Float(TANK)),
    "plane": plane,
    "sphere": sphere(sp.Float(TANK)),
    "torus": torus(sp.Float(TANK), sp.Float(RING)),
    "torus, all but straight": torus(sp.Float(TANK), sp.Float(1e12)),
}
S, Z = sp.symbols("s z", real=True)
PLACES = ((0.0, 0.0), (0.06, -0.11), (-0.12, 0.2))


@cache
def evaluated(name: str) -> Callable[[float, float], list[Any]]:
    """Return point, frame and forms of a surface as numbers."""
    place = SURFACES[name](S, Z)
    parts = [place.point, place.along_s, place.along_z, place.normal]
    forms = [place.metric, place.curvature, place.torsion]
    made: Callable[[float, float], list[Any]] = sp.lambdify(
        (S, Z), [list(each) for each in (*parts, *forms)], "math"
    )
    return made


@pytest.mark.parametrize("at", PLACES)
@pytest.mark.parametrize("name", SURFACES)
def test_forms_are_those_of_the_placement(name: str, at: tuple[float, float]) -> None:
    """M, K and T from differences of the point and of its frame."""
    of, step = evaluated(name), 1e-5

    def across(part: int, way: int) -> Vector:
        ends = [
            np.array(of(*(value + sign * step * (place == way) for place, value in enumerate(at)))[part])
            for sign in (1, -1)
        ]
        return np.asarray((ends[0] - ends[1]) / (2 * step))

    _, x, y, normal, metric, curvature, torsion = map(np.array, of(*at))
    assert np.cross(x, y) == pytest.approx(normal, abs=1e-12)
    for way, axis in enumerate((x, y)):
        assert across(0, way) == pytest.approx(metric[way] * axis, abs=1e-8)
        bent = across(3, way) / metric[way]
        assert [bent @ x, bent @ y] == pytest.approx([curvature[way], curvature[way + 1]], abs=1e-7)
        assert across(1, way) @ y / metric[way] == pytest.approx(torsion[way], abs=1e-7)


@pytest.mark.parametrize("at", PLACES)
def test_a_torus_without_bend_is_a_cylinder(at: tuple[float, float]) -> None:
    one, other = evaluated("torus, all but straight")(*at), evaluated("cylinder")(*at)
    for a, b in zip(one, other, strict=True):
        assert a == pytest.approx(b, abs=1e-11)


CENTRES: dict[str, Callable[[Vector], tuple[Vector, float]]] = {
    "cylinder": lambda p: (np.array([-TANK, 0.0, p[2]]), TANK),
    "sphere": lambda _: (np.array([-TANK, 0.0, 0.0]), TANK),
    "plane": lambda p: (np.array([-1.0, p[1], p[2]]), 1.0),
    "torus": lambda p: (_on_ring(p), TANK),
}
"""The point from which a point's nearest one on the surface is so far away."""


def _on_ring(p: Vector) -> Vector:
    x, z = p[0] + RING + TANK, p[2]
    far = math.hypot(x, z)
    return np.array([RING * x / far - RING - TANK, 0.0, RING * z / far])


def touching(name: str, middle: Vector, axle: Vector, crown: float, wheel: float) -> tuple[Vector, Vector]:
    """Find where a torus touches a surface, by its geometry alone: the point and the normal there."""
    place = middle
    for _ in range(60):
        centre, radius = CENTRES[name](place)
        normal = (place - centre) / np.linalg.norm(place - centre)
        spoke = (normal @ axle) * axle - normal
        place = middle + (wheel - crown) * spoke / np.linalg.norm(spoke)
    assert np.linalg.norm(place - centre) == pytest.approx(radius + crown, abs=1e-6)
    return place - crown * normal, normal


CROWN, WHEEL = 0.006, 0.02


@cache
def contact_rates(name: str) -> Any:
    tube, psi, *motion = sp.symbols("tube psi wx wy wz vx vy vz", real=True)
    contact = Contact(tube, psi, SURFACES[name](S, Z), Torus(sp.Float(CROWN), sp.Float(WHEEL)))
    found = contact.rates(tuple(motion[:3]), tuple(motion[3:]))
    symbols = [tube, psi, S, Z, *motion]
    return sp.lambdify(symbols, [found[each] for each in ("tube", "psi", "arc", "height")], "math", cse=True)


@pytest.mark.long(keeps=["cylinder-2.2-rolling", "torus-0.4-sliding"])
@pytest.mark.parametrize("sliding", [0.0, 0.03], ids=["rolling", "sliding"])
@pytest.mark.parametrize(
    ("name", "psi"), [("cylinder", 2.2), ("plane", 0.4), ("sphere", 2.2), ("torus", 0.4)]
)
def test_contact_equations_against_exact_rolling(name: str, psi: float, sliding: float) -> None:
    """(15)-(17) with the corrected sign: a torus that tilts, rolls, turns and slides on a surface."""
    equations = contact_rates(name)
    coordinates = np.array([0.0, psi, 0.0, 0.0])
    axle = np.array([0.0, math.cos(psi), math.sin(psi)])
    steps, length = 60, 0.5

    def motion(t: float, at: Vector) -> Vector:
        axle, middle, coordinates = at[:3], at[3:6], at[6:]
        turning = 2.0 * axle + np.array([0.8 * math.cos(3 * t), 0.3 * math.sin(2 * t), -0.4 * math.cos(t)])
        place, normal = touching(name, middle, axle, CROWN, WHEEL)
        slide = np.array([0.0, sliding * math.cos(t), -sliding])
        slide -= (slide @ normal) * normal
        speed = slide - np.cross(turning, place - middle)
        return np.concatenate([np.cross(turning, axle), speed, equations(*coordinates, *turning, *slide)])

    state = np.concatenate([axle, np.array([WHEEL, 0.0, 0.0]), coordinates])
    step = length / steps
    for count in range(steps):
        t = count * step
        a = motion(t, state)
        b = motion(t + step / 2, state + step / 2 * a)
        c = motion(t + step / 2, state + step / 2 * b)
        d = motion(t + step, state + step * c)
        state = state + step / 6 * (a + 2 * b + 2 * c + d)
    axle, (tube, psi, s, z) = state[:3], state[6:]
    place, normal = touching(name, state[3:6], axle, CROWN, WHEEL)
    point, x, y, *_ = map(np.array, evaluated(name)(s, z))
    assert point == pytest.approx(place, abs=1e-6)
    assert tube == pytest.approx(math.asin(-float(normal @ axle)), abs=1e-6)
    # psi is the direction of the axle's trace on the surface.
    direction = math.atan2(float(axle @ y), float(axle @ x))
    assert math.remainder(psi - direction, 2 * math.pi) == pytest.approx(0.0, abs=1e-6)
    assert abs(tube) > 0.05
