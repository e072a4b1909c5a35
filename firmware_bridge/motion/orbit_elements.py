"""An orbit by its six elements, and back.

Source: R. H. Battin, An Introduction to the Mathematics and Methods of Astrodynamics. Angles in rad.
Where the orbit lies in the plane of x and y its node is at x, and where it is a circle its periapsis is at
the node: so all six are always there, and lead back to the same state.
"""

import math
from typing import Final, NamedTuple

import numpy as np

from firmware_bridge.motion.chain import Matrix
from firmware_bridge.motion.orbit import OrbitState

NONE: Final = 1e-12
"""Below this there is no eccentricity, and no inclination."""


class Elements(NamedTuple):
    """Size, shape, place in space, and place on the orbit."""

    axis: float
    """The semi-major axis; below 0 for a hyperbola."""
    eccentricity: float
    inclination: float
    node: float
    """The right ascension of the ascending node."""
    periapsis: float
    """From the node."""
    anomaly: float
    """The true one, from the periapsis."""


def elements(of: OrbitState, mu: float = 1.0) -> Elements:
    """Return a state's elements; ValueError for a parabola and for a fall onto the center."""
    momentum, energy = of.momentum, of.energy(mu)
    size = float(np.linalg.norm(momentum))
    if abs(energy) < NONE or size < NONE:
        raise ValueError("a parabola and a straight fall have no semi-major axis with an angle: give another")
    normal = momentum / size
    # Laplace's vector: towards the periapsis, and as long as the eccentricity.
    shape = np.cross(of.speed, momentum) / mu - of.place / np.linalg.norm(of.place)
    eccentricity = float(np.linalg.norm(shape))
    across = math.hypot(normal[0], normal[1])
    to_node = np.array((1.0, 0.0, 0.0)) if across < NONE else np.array((-normal[1], normal[0], 0.0)) / across
    to_periapsis = to_node if eccentricity < NONE else shape / eccentricity
    return Elements(
        -mu / (2.0 * energy),
        eccentricity,
        # The arc cosine would lose half of the digits near 0 and 180 degrees.
        math.atan2(across, normal[2]),
        math.atan2(to_node[1], to_node[0]) % math.tau,
        _angle(to_node, to_periapsis, normal),
        _angle(to_periapsis, of.place, normal),
    )


def state_of(orbit: Elements, mu: float = 1.0) -> OrbitState:
    """Return the state with these elements; ValueError where there is no such place."""
    parameter = orbit.axis * (1.0 - orbit.eccentricity**2)
    divisor = 1.0 + orbit.eccentricity * math.cos(orbit.anomaly)
    if not parameter > 0.0 or not divisor > 0.0:
        raise ValueError(
            f"no orbit has a = {orbit.axis:g}, e = {orbit.eccentricity:g} and a body at {orbit.anomaly:g} rad"
        )
    sine, cosine = math.sin(orbit.anomaly), math.cos(orbit.anomaly)
    turn = _about(2, orbit.node) @ _about(0, orbit.inclination) @ _about(2, orbit.periapsis)
    place = parameter / divisor * np.array((cosine, sine, 0.0))
    speed = math.sqrt(mu / parameter) * np.array((-sine, orbit.eccentricity + cosine, 0.0))
    return OrbitState(turn @ place, turn @ speed)


def _angle(one: Matrix, two: Matrix, normal: Matrix) -> float:
    """Return the angle from one direction to another about the orbit's normal, from 0 to a whole turn."""
    return math.atan2(float(np.cross(one, two) @ normal), float(one @ two)) % math.tau


def _about(axis: int, angle: float) -> Matrix:
    """Return the matrix that turns about x, y or z."""
    sine, cosine = math.sin(angle), math.cos(angle)
    one, two = (axis + 1) % 3, (axis + 2) % 3
    turned = np.eye(3)
    turned[one, one], turned[one, two], turned[two, one], turned[two, two] = cosine, -sine, sine, cosine
    return turned
