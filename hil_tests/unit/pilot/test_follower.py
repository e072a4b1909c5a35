"""A path follower whose robot is armed: it is seen to stand before it drives off."""

from typing import Final

from firmware_bridge.motion.model import Moving
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.driver import REST, Sight
from firmware_bridge.pilot.follower import LETS_GO_FOR, Follower
from firmware_bridge.pilot.link import Link
from firmware_bridge.pilot.paths import PATHS, placed
from firmware_bridge.units import MILLISECOND, Nanoseconds

PERIOD: Final = 50 * MILLISECOND


def test_armed_and_armed_again_it_lets_go_for_a_while() -> None:
    path, link = PATHS["line"](5.0), Link()
    follower = Follower(lambda pose: placed(path, pose), speed_mps=0.3, look_ahead_m=0.5, tightest_per_m=2.0)

    def rests(begin: Nanoseconds, span: Nanoseconds, *, armed: bool) -> set[bool]:
        said = set()
        for now in range(begin, begin + span, PERIOD):
            follower.sees(Sight(Moving(Pose(), 0.0, 0.0), None, now))
            said.add(follower.wish(link, now, armed=armed) == REST)
        return said

    assert rests(0, LETS_GO_FOR, armed=False) == {True}
    assert rests(LETS_GO_FOR, LETS_GO_FOR, armed=True) == {True}
    assert rests(2 * LETS_GO_FOR, LETS_GO_FOR, armed=True) == {False}
    assert rests(3 * LETS_GO_FOR, PERIOD, armed=False) == {True}
    assert rests(4 * LETS_GO_FOR, LETS_GO_FOR, armed=True) == {True}
    assert rests(5 * LETS_GO_FOR, LETS_GO_FOR, armed=True) == {False}
