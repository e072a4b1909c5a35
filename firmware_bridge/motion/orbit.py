"""Two bodies: where one is after any time, by the functions F and G of its first place and speed.

Source: A. Seleit, MSc thesis, UCF, 2020, 2.4: r'' = -mu r / r^3, (4.7) and (4.8) with their factors and dots.
The universal variable serves every conic: R. H. Battin, An Introduction to the Mathematics and Methods of
Astrodynamics. In DU and TU mu is 1; any other unit does with its own mu.
"""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from firmware_bridge.motion.chain import Matrix

SERIES_BELOW: Final = 1.0
TERMS: Final = 12
"""Of a series below 1: what comes behind them is below the last bit."""
EXACT: Final = 4.0 * np.finfo(float).eps
MOST_TURNS: Final = 200


class Functions(NamedTuple):
    """r = f r0 + g v0 and v = f' r0 + g' v0; f g' - f' g is 1."""

    f: float
    g: float
    f_rate: float
    g_rate: float


@dataclass(frozen=True, slots=True, eq=False)
class OrbitState:
    """Place and speed, three numbers each."""

    place: Matrix
    speed: Matrix

    @property
    def momentum(self) -> Matrix:
        """The angular momentum, per mass."""
        return np.cross(self.place, self.speed)

    def energy(self, mu: float = 1.0) -> float:
        """Return the energy per mass."""
        return float(self.speed @ self.speed / 2.0 - mu / np.linalg.norm(self.place))


def state(place: tuple[float, float, float], speed: tuple[float, float, float]) -> OrbitState:
    """Return a state of plain numbers."""
    return OrbitState(np.array(place), np.array(speed))


THESIS: Final = state((-0.5985, 1.6634, 0.0279), (-0.9523, -0.0639, 0.0110))
"""(4.10), rounded as printed, in DU and DU/TU: a = 4.543 DU, e = 0.648."""


def period(of: OrbitState, mu: float = 1.0) -> float:
    """Return the time of a revolution; infinite where it never comes back."""
    axis = -mu / (2.0 * of.energy(mu)) if of.energy(mu) < 0.0 else math.inf
    return math.tau * axis * math.sqrt(axis / mu) if axis < math.inf else math.inf


def propagated(begin: OrbitState, time: float, mu: float = 1.0) -> OrbitState:
    """Return the state after a time, which may be negative; ValueError at the center itself."""
    by = functions(begin, time, mu)
    return OrbitState(
        by.f * begin.place + by.g * begin.speed, by.f_rate * begin.place + by.g_rate * begin.speed
    )


def functions(begin: OrbitState, time: float, mu: float = 1.0) -> Functions:
    """Return F and G and their rates after a time."""
    first = float(np.linalg.norm(begin.place))
    if not first > 0.0:
        raise ValueError("an orbit's state is not at its center: give a place that is not 0")
    # Backwards in time is forwards with the speed reversed: F is even in time and G is odd.
    if time < 0.0:
        back = functions(OrbitState(begin.place, -begin.speed), -time, mu)
        return Functions(back.f, -back.g, -back.f_rate, back.g_rate)
    root, inverse = math.sqrt(mu), -2.0 * begin.energy(mu) / mu
    turns = period(begin, mu)
    # Whole revolutions change nothing, and would cost digits of the anomaly.
    left = math.fmod(time, turns) if turns < math.inf else time
    radial = float(begin.place @ begin.speed) / root
    anomaly = _anomaly(first, radial, inverse, root * left)
    square = anomaly**2
    c, s = stumpff(inverse * square)
    far = square * c + radial * anomaly * (1.0 - inverse * square * s) + first * (1.0 - inverse * square * c)
    return Functions(
        1.0 - square / first * c,
        left - anomaly * square * s / root,
        root / (far * first) * anomaly * (inverse * square * s - 1.0),
        1.0 - square / far * c,
    )


def between(begin: OrbitState, end: OrbitState) -> Functions:
    """Return F and G that lead from one state to another of the same orbit, (4.7) and (4.8) in space."""
    momentum = begin.momentum
    share = momentum / float(momentum @ momentum)
    return Functions(
        float(np.cross(end.place, begin.speed) @ share),
        float(np.cross(begin.place, end.place) @ share),
        float(np.cross(end.speed, begin.speed) @ share),
        float(np.cross(begin.place, end.speed) @ share),
    )


def stumpff(value: float) -> tuple[float, float]:
    """Return C and S, (1 - cos x) / x^2 and (x - sin x) / x^3 for x^2 = `value`, also below 0."""
    if abs(value) < SERIES_BELOW:
        c = s = 0.0
        # Horner's scheme: near 0 the closed form subtracts two numbers that are almost equal.
        for term in range(TERMS, -1, -1):
            c = 1.0 - value * c / ((2 * term + 3) * (2 * term + 4))
            s = 1.0 - value * s / ((2 * term + 4) * (2 * term + 5))
        return c / 2.0, s / 6.0
    root = math.sqrt(abs(value))
    if value > 0.0:
        return (1.0 - math.cos(root)) / value, (root - math.sin(root)) / (value * root)
    return (1.0 - math.cosh(root)) / value, (root - math.sinh(root)) / (value * root)


def _anomaly(first: float, radial: float, inverse: float, time: float) -> float:
    """Solve Kepler's equation for the universal variable; it grows with the time, so a bracket holds it."""
    low, high = 0.0, max(1.0, math.sqrt(first))
    while _late(first, radial, inverse, high)[0] < time:
        low, high = high, 2.0 * high
    guess = 0.5 * (low + high)
    for _ in range(MOST_TURNS):
        value, slope = _late(first, radial, inverse, guess)
        low, high = (guess, high) if value < time else (low, guess)
        better = guess - (value - time) / slope
        # Newton's step where it stays in the bracket, else bisection, which cannot fail.
        better = better if low <= better <= high else 0.5 * (low + high)
        if abs(better - guess) <= EXACT * max(1.0, abs(guess)):
            return better
        guess = better
    return guess


def _late(first: float, radial: float, inverse: float, anomaly: float) -> tuple[float, float]:
    """Return the time at which an anomaly is reached, times the root of mu, and its slope: the radius."""
    square = anomaly**2
    c, s = stumpff(inverse * square)
    time = anomaly * square * s + radial * square * c + first * anomaly * (1.0 - inverse * square * s)
    slope = (
        square * c + radial * anomaly * (1.0 - inverse * square * s) + first * (1.0 - inverse * square * c)
    )
    return time, slope
