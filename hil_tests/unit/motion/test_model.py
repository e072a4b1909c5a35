"""Motion of an ideal robot for a commanded speed and yaw rate: arcs, by hand."""

import math

import pytest

from firmware_bridge.motion.model import Moving, Unicycle, arc
from firmware_bridge.motion.pose import Pose


def test_a_robot_stands_where_nothing_else_is_stated() -> None:
    moving = Moving(Pose())
    assert (moving.speed_mps, moving.yaw_rate_rad_s, moving.steer_rad) == (0.0, 0.0, None)


@pytest.mark.parametrize("heading", [0.0, 1.0])
@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_half_a_circle_ends_a_diameter_beside(heading: float, turn: float) -> None:
    """0.5 m/s and a quarter of a turn a second: a radius of 1/pi m, half of it after 2 s."""
    rate = turn * math.pi / 2.0
    end = arc(Pose(1.0, 2.0, heading), 0.5, rate, 2.0)
    aside = 2.0 * turn * 0.5 / (math.pi / 2.0)
    assert end.x_m == pytest.approx(1.0 - aside * math.sin(heading))
    assert end.y_m == pytest.approx(2.0 + aside * math.cos(heading))
    assert end.heading_rad == pytest.approx(heading + turn * math.pi)


def test_straight_ahead_and_on_the_spot() -> None:
    assert arc(Pose(), 0.25, 0.0, 4.0) == Pose(1.0, 0.0, 0.0)
    spot = arc(Pose(), 0.0, 0.3, 2.0)
    assert (spot.x_m, spot.y_m) == (0.0, 0.0)
    assert spot.heading_rad == pytest.approx(0.6)


def test_a_unicycle_moves_as_it_is_commanded() -> None:
    moved = Unicycle().step(Moving(Pose(), 9.0, 9.0), 0.5, 0.1, 2.0)
    assert (moved.speed_mps, moved.yaw_rate_rad_s) == (0.5, 0.1)
    assert moved.pose == arc(Pose(), 0.5, 0.1, 2.0)
    assert moved.pose.x_m == pytest.approx(0.5 * math.sin(0.2) / 0.1)
    assert moved.pose.y_m == pytest.approx(0.5 * (1.0 - math.cos(0.2)) / 0.1)
