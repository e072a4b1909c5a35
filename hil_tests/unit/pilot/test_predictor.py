import math

import pytest

from firmware_bridge.motion.model import MotionModel, Moving, Unicycle
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.predictor import Predictor
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.robots.rars.model import RarsModel
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds

TICK = 50 * MILLISECOND


def command(count: int) -> tuple[float, float]:
    """Return a drive that curves to and fro."""
    return 0.4, 0.3 * math.sin(count / 10.0)


def drive(model: MotionModel, up: Nanoseconds, count: int) -> list[tuple[Nanoseconds, Moving]]:
    """Return what a robot that obeys each word after `up` shows, each with when it was so."""
    moving, shown = Moving(Pose()), []
    for place in range(count):
        late = place - up // TICK
        speed, turn = command(late) if late >= 0 else (0.0, 0.0)
        shown.append((place * TICK, moving))
        for _ in range(2):
            moving = model.step(moving, speed, turn, 0.025)
    return shown


@pytest.mark.parametrize("model", [Unicycle(), RarsModel(find("rars"))], ids=["ideal", "rars"])
@pytest.mark.parametrize(("up_s", "down_s"), [(0.0, 0.0), (0.4, 0.4), (0.2, 0.6), (0.8, 0.05)])
def test_with_the_right_model_it_states_where_the_robot_will_be(
    model: MotionModel, up_s: float, down_s: float
) -> None:
    up, down = from_seconds(up_s), from_seconds(down_s)
    trip = up + down
    wrong = (up - down) // 2
    shown = drive(model, up, 200)
    predictor = Predictor(model)
    for place in range(160):
        now = place * TICK
        # Half a round trip is not the way up, and the robot's clock is then mapped wrong by as much.
        seen = (now - down) // TICK
        if seen >= 0:
            predictor.seen(shown[seen][0] - wrong, shown[seen][1])
        stated = predictor.at(now + trip // 2)
        predictor.on_command(now, trip // 2, *command(place))
        true = shown[place + up // TICK][1].pose
        if stated is not None and place > 2 * trip // TICK:
            assert math.dist((stated.pose.x_m, stated.pose.y_m), (true.x_m, true.y_m)) < 2e-3
    if trip:
        assert predictor.error_m is not None
        assert predictor.error_m < 2e-3


def test_its_error_is_reported_where_the_robot_does_otherwise() -> None:
    predictor = Predictor(Unicycle())
    predictor.on_command(0, 0, 0.5, 0.0)
    predictor.seen(0, Moving(Pose()))
    for place in range(1, 9):
        stated = predictor.at(place * TICK)
        assert stated is not None
        assert stated.pose.x_m == pytest.approx(0.5 * place * 0.05)
    predictor.seen(6 * TICK, Moving(Pose()))  # it stands
    assert predictor.error_m == pytest.approx(0.15)


def test_before_it_has_seen_anything_it_sends_nothing_and_what_is_older_changes_nothing() -> None:
    predictor = Predictor(Unicycle())
    assert predictor.at(0) is None
    predictor.seen(TICK, Moving(Pose(1.0)))
    predictor.seen(0, Moving(Pose(7.0)))
    stated = predictor.at(TICK)
    assert stated is not None
    assert stated.pose == Pose(1.0)


def test_rars_steers_no_faster_than_its_rack_and_speeds_up_at_its_ramp() -> None:
    robot = find("rars")
    model = RarsModel(robot)
    moving = model.step(Moving(Pose(), 0.5, 0.0, 0.0), 0.5, 0.5, 0.05)
    assert moving.steer_rad is not None
    # 5000 rpm over 159: 3.29 rad/s at the pinion, 49 mm/s at the rack, which is 2.5 mm in a cycle.
    assert moving.steer_rad == pytest.approx(math.atan(2.47 / 30.0), rel=0.03)
    begins = model.step(Moving(Pose()), 0.5, 0.0, 0.05)
    assert begins.speed_mps == pytest.approx(0.80 * 0.144 * 9.81 * 0.05)
    assert model.tightest_per_m == pytest.approx(1.0 / 0.415)
    assert ROBOT_TYPE.model is RarsModel
