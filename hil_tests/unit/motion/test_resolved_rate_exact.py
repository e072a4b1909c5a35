"""Rates of joints by hand: an arm of two links of 1 m in a plane, whose Jacobian is known in closed form.

Sideways it has the row (cos a + cos(a + b), cos(a + b)). Of a scalar command x the solution of least weighted
squares is q_i = J_i / w_i / (sum of J_j^2 / w_j + damping) x.
"""

import math

import numpy as np
import pytest

from firmware_bridge.motion.chain import Chain, ChainLink, Matrix
from firmware_bridge.motion.resolved_rate import Damping, pose_law, resolved, slowed
from hil_tests.rows import every

SIDEWAYS = (1,)
BOTH = (0, 1)
BEND = 0.5
"""The second joint's angle where its limits are tried."""


def planar(below: float = 2.0, above: float = 2.0, at: float = 0.0) -> Chain:
    """Return the arm; the second joint has this much room about an angle, the first 2 rad about 0."""
    link = ChainLink(0.0, 1.0, 0.0)
    return Chain((link, link), (-2.0, at - below), (2.0, at + above))


def nearness(angle: float, least: float, most: float) -> float:
    """Chan and Dubey's function of the distance from both limits, which grows without bound at each."""
    return (most - least) ** 2 / (4.0 * (most - angle) * (angle - least))


def assert_shared(below: float, above: float, command: float, weight: float) -> None:
    """Check what both joints do for a command sideways if the second weighs so much, and the first 1."""
    found = resolved(
        planar(below, above, BEND), (0.0, BEND), np.array((command,)), rows=SIDEWAYS, moving=BOTH
    )
    one, two = 1.0 + math.cos(BEND), math.cos(BEND)
    share = command / (one**2 + two**2 / weight)
    assert found.joints == pytest.approx((one * share, two / weight * share), rel=1e-5, abs=0.0)


@every(
    ("below", "above"),
    [(1.0, 1.0), (1.0, 0.5), (0.5, 1.0), (1.0, 0.1), (0.1, 1.0), (1.0, 0.005), (0.005, 1.0), (0.25, 0.75)],
)
@every("command", [0.1, -0.1, 1e-4, -1e-4])
def test_a_joint_weighs_more_by_the_slope_towards_its_nearer_limit(
    below: float, above: float, command: float
) -> None:
    """The slope by differences; both joints go the way of the command."""
    step = 1e-4 * min(below, above)
    slope = (nearness(step, -below, above) - nearness(-step, -below, above)) / (2.0 * step)
    weight = 1.0 + abs(slope) if (above < below) == (command > 0.0) else 1.0
    assert_shared(below, above, command, weight if above != below else 1.0)


@every("room", [1e-6, 0.0, -0.001, -0.5])
def test_at_its_limit_and_beyond_a_joint_does_a_millionth(room: float) -> None:
    for command in (0.1, 1e-4):
        assert_shared(1.0, room, command, 1e6)
        assert_shared(room, 1.0, -command, 1e6)
        assert_shared(min(room, 0.0), 0.005, -command, 1e6)  # a joint of little travel


@every("room", [1e-6, 0.0, -0.001, -0.5])
def test_at_its_limit_and_beyond_a_joint_is_free_to_go_back(room: float) -> None:
    for command in (0.1, 1e-4):
        assert_shared(1.0, room, -command, 1.0)
        assert_shared(room, 1.0, command, 1.0)


@every(
    ("smallest", "below", "most", "squared"),
    [
        # A parabola from the square of `most` at 0 down to 0 at `below`.
        (0.0, 0.04, 0.02, 4e-4),
        (0.01, 0.04, 0.02, 3.75e-4),
        (0.02, 0.04, 0.02, 3e-4),
        (0.03, 0.04, 0.02, 1.75e-4),
        (0.04, 0.04, 0.02, 0.0),
        (0.05, 0.04, 0.02, 0.0),
        (0.0, 0.0, 0.02, 0.0),
    ],
)
def test_damping_is_a_parabola_of_the_least_singular_value(
    smallest: float, below: float, most: float, squared: float
) -> None:
    assert Damping(below, most).squared(smallest) == pytest.approx(squared)


def test_damped_rates_of_a_stretched_arm() -> None:
    """J is (2, 1), its singular value the root of 5: damping is (1 - 5 / 25) * 2^2 = 3.2."""
    found = resolved(
        planar(), (0.0, 0.0), np.array((0.41,)), rows=SIDEWAYS, moving=BOTH, damping=Damping(5.0, 2.0)
    )
    assert found.joints == pytest.approx((0.1, 0.05))
    assert found.watch == pytest.approx((math.sqrt(5.0), math.sqrt(5.0), 3.2))


@every(("moving", "lever"), [(0, 2.0), (1, 1.0)])
def test_where_no_joint_is_left_over_limits_weigh_nothing(moving: int, lever: float) -> None:
    """One joint for one speed, a tenth before its limit: J / (J^2 + damping), the other stands."""
    chain = Chain(planar().links, (-2.0, -2.0), (0.1, 0.1))
    added = (1.0 - (lever / 4.0) ** 2) * 9.0
    found = resolved(
        chain, (0.0, 0.0), np.array((0.1,)), rows=SIDEWAYS, moving=(moving,), damping=Damping(4.0, 3.0)
    )
    expected = [0.0, 0.0]
    expected[moving] = 0.1 * lever / (lever**2 + added)
    assert found.joints == pytest.approx(expected)


def test_a_singular_posture_without_damping_has_the_rates_of_least_squares() -> None:
    """Stretched, nothing moves along: of (1, 0.5) only 0.5 sideways is met, by 2 : 1 as J is."""
    found = resolved(
        planar(), (0.0, 0.0), np.array((1.0, 0.5)), rows=BOTH, moving=BOTH, damping=Damping(0.0, 0.0)
    )
    assert found.joints == pytest.approx((0.2, 0.1))
    assert found.watch == pytest.approx((0.0, 0.0, 0.0), abs=1e-15)


def test_the_singular_values_of_an_elbow_at_a_right_angle() -> None:
    """J is ((-1, -1), (1, 0)): its determinant 1, J J' has (3 - root of 5) / 2, the golden ratio's square."""
    found = resolved(planar(), (0.0, math.pi / 2.0), np.array((0.3, 0.2)), rows=BOTH, moving=BOTH)
    assert found.watch == pytest.approx((1.0, (math.sqrt(5.0) - 1.0) / 2.0, 0.0))
    assert found.joints == pytest.approx((0.2, -0.5))


def about_z(angle: float, place: tuple[float, float, float]) -> Matrix:
    pose = np.eye(4)
    pose[:2, :2] = ((math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle)))
    pose[:3, 3] = place
    return pose


@every("off", [0.0, 0.6, -0.6, 1.2])
def test_a_pose_aside_and_turned_about_one_axis_is_led_back_by_the_tangent(off: float) -> None:
    """About one axis the error is sin(off), and its rate cos(off) times that of the turn."""
    twist = np.array((0.1, 0.2, 0.3, 0.0, 0.0, 0.6))
    law = pose_law(about_z(0.3 + off, (1.5, 2.0, 2.0)), about_z(0.3, (1.0, 2.0, 3.0)), twist, (4.0, 2.0))
    assert law == pytest.approx((2.1, 0.2, -3.7, 0.0, 0.0, 0.6 + 2.0 * math.tan(off)), abs=1e-12)


@every(
    ("angle", "rate", "margin", "share"),
    [
        # 1 rad/s at most, for the next half second, between -2 and 2.
        (0.0, 1.0, 0.0, 1.0),
        (0.0, 1.25, 0.0, 0.8),
        (0.0, -1.25, 0.0, 0.8),
        # A quarter is left: half a rad/s to either side.
        (1.75, 0.5, 0.0, 1.0),
        (1.75, 0.625, 0.0, 0.8),
        (-1.75, -0.5, 0.0, 1.0),
        (-1.75, -0.625, 0.0, 0.8),
        # Half of it is margin.
        (1.75, 0.5, 0.125, 0.5),
        (-1.75, -0.5, 0.125, 0.5),
        # Slowly onto the limit, away from it, and standing there.
        (1.999, 0.005, 0.0, 0.4),
        (-1.999, -0.005, 0.0, 0.4),
        (2.0, -1.0, 0.0, 1.0),
        (-2.0, 1.0, 0.0, 1.0),
        (2.0, 0.0, 0.0, 1.0),
        (-2.0, 0.0, 0.0, 1.0),
        (-2.5, 0.0, 0.0, 1.0),
    ],
)
def test_the_share_at_which_a_joint_keeps_its_speed_and_its_limits(
    angle: float, rate: float, margin: float, share: float
) -> None:
    for other in (0.0, 0.001):
        rates = np.array((rate, other))
        found = slowed(planar(), (angle, 0.0), rates, (1.0, 1.0), 0.5, margin=margin)
        assert found == pytest.approx(share, rel=1e-9)
