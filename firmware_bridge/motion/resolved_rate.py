"""A tool along its path by rates of joints: the law, what it does near singular postures, and near limits.

Source: A. Seleit, MSc thesis, UCF, 2020, (3.15), (3.16) and (3.21) to (3.23). Damping: Y. Nakamura and
H. Hanafusa, 1986. Joints that near their limits weigh more: T. F. Chan and R. V. Dubey, 1995. Lengths in m,
angles in rad, in the floor's frame.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from firmware_bridge.motion.chain import Angles, Chain, Matrix

ALL: Final = (0, 1, 2, 3, 4, 5)
"""Indices of the tool's three speeds and three turns: all of them are controlled."""
POSITION: Final = (0, 1, 2)
HEAVIEST: Final = 1e6
"""The weight of a joint at its limit: it does a millionth of what it would do."""


class Watch(NamedTuple):
    """Effect of a posture on the tool's motion."""

    manipulability: float
    """The product of the singular values: 0 where a direction is lost."""
    smallest: float
    """The least singular value."""
    damping: float
    """The square of what was added to each of them; 0 far from singular postures."""


@dataclass(frozen=True, slots=True)
class Damping:
    """From which least singular value on rates are damped, and how much at a singular posture.

    Assumed 0.03 and 0.03: for 20 mm/s of the tool the joints then do 0.67 rad/s at most, all together.
    """

    below: float = 0.03
    most: float = 0.03

    def squared(self, smallest: float) -> float:
        """Return the square of the damping: it begins smoothly at `below`."""
        if smallest >= self.below:
            return 0.0
        return (1.0 - (smallest / self.below) ** 2) * self.most**2


class Rates(NamedTuple):
    """Rates of the joints, rad/s, and the quality of the posture."""

    joints: Matrix
    watch: Watch


def resolved(
    chain: Chain,
    angles: Angles,
    wanted: Matrix,
    *,
    rows: Sequence[int] = ALL,
    moving: Sequence[int] = ALL,
    damping: Damping | None = None,
) -> Rates:
    """Return the joints' rates for what the tool shall do, q' = J+ (wanted) of (3.16).

    `rows` are those of the tool's six speeds that `wanted` has, `moving` the joints that are not locked.
    Where joints are left over, those that near a limit do less.
    """
    jacobian = chain.jacobian(angles)[np.ix_(rows, moving)]
    inverse, watch = _inverse(jacobian, Damping() if damping is None else damping)
    rates = inverse @ wanted
    if len(moving) > len(rows):
        spread = np.array(
            [
                1.0 / math.sqrt(_weight(angles[joint], chain.least[joint], chain.most[joint], rate))
                for joint, rate in zip(moving, rates, strict=True)
            ]
        )
        # Least squares with weights: each column is scaled by 1 / sqrt(weight), and the result once more.
        rates = spread * (_damped(jacobian * spread, watch.damping) @ wanted)
    found = np.zeros(len(chain.links))
    found[list(moving)] = rates
    return Rates(found, watch)


def position_error_law(desired: Matrix, actual: Matrix, speed: Matrix, gain: float) -> Matrix:
    """Return the speed that the tool shall have, x' + K e with e = x_r - x, in m/s."""
    return speed + gain * (desired - actual)


def pose_law(desired: Matrix, actual: Matrix, twist: Matrix, gains: tuple[float, float]) -> Matrix:
    """Return the tool's speed and turn for two poses and the desired one's twist, (3.21) to (3.23).

    `gains` in 1/s for position and orientation. The orientation's error is half the sum of the vector
    products of both frames' axes; the law turns it back by the shortest way, from any error below 90 degrees.
    """
    place, turn = gains
    error = desired[:3, 3] - actual[:3, 3]
    pairs = [(actual[:3, axis], desired[:3, axis]) for axis in range(3)]
    orientation = 0.5 * sum((np.cross(e, d) for e, d in pairs), start=np.zeros(3))
    lever = -0.5 * sum((_skew(d) @ _skew(e) for e, d in pairs), start=np.zeros((3, 3)))
    turned = np.linalg.solve(lever, lever.T @ twist[3:] + turn * orientation)
    law: Matrix = np.r_[twist[:3] + place * error, turned]
    return law


class PoseGains(NamedTuple):
    """Gains of `PoseControl`: three of the position, one of the orientation."""

    kp_per_s: float
    ko_per_s: float
    ki_per_s2: float = 0.0
    kd: float = 0.0
    """Below 1: a difference of two cycles stands for e', and from 1 on it would grow by itself."""


class PoseControl:
    """`pose_law` with the position's integral and derivative, x' = x_d' + K_p e + K_i int e + K_d e'.

    Source: A. Seleit, chapter 3, the loops of Fig. 3.9 (open), 3.10 (PI) and 3.11 (PID).
    """

    def __init__(self, gains: PoseGains) -> None:
        self._gains: Final = gains
        self._sum: Matrix = np.zeros(3)
        """The integral of the position's error, m s."""
        self._last: Matrix | None = None
        """The position's error a cycle before, m."""

    def reset(self) -> None:
        """Forget the integral, and the error before."""
        self._sum, self._last = np.zeros(3), None

    def twist(
        self, desired: Matrix, actual: Matrix, feed: Matrix, seconds: float, *, limited: bool = False
    ) -> Matrix:
        """Return the tool's speed and turn, m/s and rad/s, `seconds` after the call before.

        `feed` is the desired pose's twist. Nothing is added to the integral where the tool was `limited` to
        less than the last twist: it would overshoot afterwards (wind-up).
        """
        gains, error = self._gains, desired[:3, 3] - actual[:3, 3]
        if not limited:
            self._sum = self._sum + seconds * error
        # Without an error before there is no difference: the first one would be a jump.
        before = error if self._last is None else self._last
        rate = (error - before) / seconds if seconds > 0.0 else np.zeros(3)
        self._last = error
        speed = feed[:3] + gains.ki_per_s2 * self._sum + gains.kd * rate
        return pose_law(desired, actual, np.r_[speed, feed[3:]], (gains.kp_per_s, gains.ko_per_s))


def slowed(
    chain: Chain,
    angles: Angles,
    rates: Matrix,
    fastest: Sequence[float],
    seconds: float,
    *,
    margin: float = 0.0,
) -> float:
    """Return the share of these rates, 1 at most, at which no joint is too fast or passes its limit.

    `fastest` in rad/s; for the next `seconds`, with a `margin` before the limits in rad. All joints by one
    share: so the tool stays on its way, and stops there.
    """
    share = 1.0
    for joint, rate in enumerate(rates):
        room = (
            (chain.most[joint] - margin - angles[joint])
            if rate > 0.0
            else (angles[joint] - chain.least[joint] - margin)
        )
        allowed = min(fastest[joint], max(0.0, room) / seconds)
        if abs(rate) > allowed:
            share = min(share, allowed / abs(rate))
    return float(share)


def _inverse(jacobian: Matrix, damping: Damping) -> tuple[Matrix, Watch]:
    """Return the damped inverse, and how singular it was."""
    values = np.linalg.svd(jacobian, compute_uv=False)
    added = damping.squared(float(values[-1]))
    return _damped(jacobian, added), Watch(float(np.prod(values)), float(values[-1]), added)


def _damped(jacobian: Matrix, added: float) -> Matrix:
    """Return J' (J J' + damping)^-1, which is the inverse of least squares where nothing is added."""
    # Undamped, J J' may be singular to the last bit, which the pseudo-inverse stands.
    if not added:
        inverse: Matrix = np.asarray(np.linalg.pinv(jacobian), np.float64)
        return inverse
    square = jacobian @ jacobian.T + added * np.eye(jacobian.shape[0])
    damped: Matrix = np.asarray(np.linalg.solve(square, jacobian), np.float64).T
    return damped


def _weight(angle: float, least: float, most: float, rate: float) -> float:
    """Return 1 where a joint goes away from its limit, and more the nearer it comes, `HEAVIEST` at most."""
    above, below = most - angle, angle - least
    # At or beyond its limit a joint is heavy only where it would go further out.
    if above <= 0.0 or below <= 0.0:
        return HEAVIEST if (above <= 0.0) == (rate > 0.0) else 1.0
    slope = (most - least) ** 2 * (2.0 * angle - most - least) / (4.0 * above**2 * below**2)
    return min(1.0 + abs(slope), HEAVIEST) if slope * rate > 0.0 else 1.0


def _skew(vector: Matrix) -> Matrix:
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
