"""Two on nearly the same circle: where one is as the other sees it, after any time.

Source: W. H. Clohessy and R. S. Wiltshire, 1960: linear in the distance, for a chief on a circle. In the
chief's frame: x outwards, y along its way, z along its angular momentum; n is its mean motion in rad a unit
of time.
"""

import math

import numpy as np

from firmware_bridge.motion.chain import Matrix
from firmware_bridge.motion.orbit import OrbitState


def transition(n: float, time: float) -> Matrix:
    """Return the 6 x 6 matrix that takes place and speed in the chief's frame through a time."""
    sine, cosine, turned = math.sin(n * time), math.cos(n * time), n * time
    return np.array(
        [
            [4.0 - 3.0 * cosine, 0.0, 0.0, sine / n, 2.0 * (1.0 - cosine) / n, 0.0],
            [
                6.0 * (sine - turned),
                1.0,
                0.0,
                -2.0 * (1.0 - cosine) / n,
                (4.0 * sine - 3.0 * turned) / n,
                0.0,
            ],
            [0.0, 0.0, cosine, 0.0, 0.0, sine / n],
            [3.0 * n * sine, 0.0, 0.0, cosine, 2.0 * sine, 0.0],
            [-6.0 * n * (1.0 - cosine), 0.0, 0.0, -2.0 * sine, 4.0 * cosine - 3.0, 0.0],
            [0.0, 0.0, -n * sine, 0.0, 0.0, cosine],
        ]
    )


def relative(chief: OrbitState, deputy: OrbitState) -> OrbitState:
    """Return the deputy in the chief's frame, which turns with it; exact, for any orbits."""
    frame, turn = _frame(chief)
    apart = deputy.place - chief.place
    # In a frame that turns, the speed lacks the turn times the distance.
    return OrbitState(frame @ apart, frame @ (deputy.speed - chief.speed - np.cross(turn, apart)))


def absolute(chief: OrbitState, seen: OrbitState) -> OrbitState:
    """Return where a deputy is that the chief sees so; the inverse of `relative`."""
    frame, turn = _frame(chief)
    apart = frame.T @ seen.place
    return OrbitState(chief.place + apart, chief.speed + frame.T @ seen.speed + np.cross(turn, apart))


def closed(place: tuple[float, float, float], outwards: float, across: float, n: float) -> OrbitState:
    """Return a start from which a deputy comes back after each revolution: y' = -2 n x.

    `outwards` and `across` are its speeds along x and z.
    """
    return OrbitState(np.array(place), np.array((outwards, -2.0 * n * place[0], across)))


def _frame(chief: OrbitState) -> tuple[Matrix, Matrix]:
    """Return the chief's axes, one a row, and how fast they turn."""
    momentum = chief.momentum
    outwards = chief.place / np.linalg.norm(chief.place)
    upwards = momentum / np.linalg.norm(momentum)
    frame = np.array((outwards, np.cross(upwards, outwards), upwards))
    return frame, momentum / float(chief.place @ chief.place)
