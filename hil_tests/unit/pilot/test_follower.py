"""A path follower whose robot is armed: it is seen to stand before it drives off."""

from itertools import groupby
from typing import Final

from firmware_bridge.motion.model import Moving
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.driver import NEUTRAL, Sight
from firmware_bridge.pilot.follower import NEUTRAL_FOR, PathDriver
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.pilot.paths import PATHS, Path, PathError, placed
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

PERIOD: Final = 50 * MILLISECOND


def test_armed_and_armed_again_it_lets_go_for_a_while() -> None:
    path, link = PATHS["line"](5.0), PilotLink()
    follower = PathDriver(
        lambda pose: placed(path, pose), speed_mps=0.3, look_ahead_m=0.5, tightest_per_m=2.0
    )

    def rests(begin: Nanoseconds, span: Nanoseconds, *, armed: bool) -> set[bool]:
        stated = set()
        for now in range(begin, begin + span, PERIOD):
            follower.sees(Sight(Moving(Pose(), 0.0, 0.0), None, now))
            stated.add(follower.command(link, now, armed=armed) == NEUTRAL)
        return stated

    assert rests(0, NEUTRAL_FOR, armed=False) == {True}
    assert rests(NEUTRAL_FOR, NEUTRAL_FOR, armed=True) == {True}
    assert rests(2 * NEUTRAL_FOR, NEUTRAL_FOR, armed=True) == {False}
    assert rests(3 * NEUTRAL_FOR, PERIOD, armed=False) == {True}
    assert rests(4 * NEUTRAL_FOR, NEUTRAL_FOR, armed=True) == {True}
    assert rests(5 * NEUTRAL_FOR, NEUTRAL_FOR, armed=True) == {False}


def test_a_robot_that_is_held_back_is_let_go_and_driven_again_and_again() -> None:
    path, link = PATHS["line"](5.0), PilotLink()
    follower = PathDriver(
        lambda pose: placed(path, pose), speed_mps=0.3, look_ahead_m=0.5, tightest_per_m=2.0
    )
    reported, held = [], []
    for now in range(0, 20 * SECOND, PERIOD):
        follower.sees(Sight(Moving(Pose(), 0.0, 0.0), None, now))
        reported.append(follower.command(link, now, armed=True) == NEUTRAL)
        held.append(follower.held_back)
    lengths = [len(list(group)) * PERIOD for _, group in groupby(reported)]
    assert reported[0], "who arms it sees it stand"
    assert [round(length / SECOND) for length in lengths[:8]] == [1, 3] * 4
    assert len(lengths) >= 9
    assert held[-1] >= 4
    follower.sees(Sight(Moving(Pose(), 0.3, 0.0), None, 20 * SECOND))
    assert follower.held_back == 0


def test_a_path_that_is_not_known_yet_is_tried_again_and_refuses_nothing_then() -> None:
    path, link, known = PATHS["line"](5.0), PilotLink(), [False]

    def place(pose: Pose) -> Path:
        if not known[0]:
            raise PathError("the robot has not reported STEER yet")
        return placed(path, pose)

    follower = PathDriver(place, speed_mps=0.3, look_ahead_m=0.5, tightest_per_m=2.0)
    for now in range(0, 2 * NEUTRAL_FOR, PERIOD):
        follower.sees(Sight(Moving(Pose(), 0.0, 0.0), None, now))
        assert follower.command(link, now, armed=True) == NEUTRAL
    assert "STEER" in follower.refused
    known[0] = True
    assert follower.command(link, 2 * NEUTRAL_FOR, armed=True) != NEUTRAL
    assert follower.refused == ""
