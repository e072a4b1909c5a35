"""Source of the robot's pose: the cameras', carried on by odometry, or odometry's alone."""

from firmware_bridge.bridge.locating import Locating
from firmware_bridge.drivers.driver import Reading, SeenPose
from firmware_bridge.motion.captured import AGREE, Source
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, Nanoseconds

CYCLE = 50 * MILLISECOND


def shown(x: float, y: float, at: Nanoseconds) -> dict[str, Reading]:
    """Return the cameras' reading of a robot that looks along x there."""
    return {"place": Reading(0.0, at, at, SeenPose((x, y, 0.1), (0.0, 0.0, 0.0, 1.0), 0.0, 0))}


def see(locating: Locating, x: float, y: float, begin: Nanoseconds) -> None:
    """Have the cameras see it there, as often as a first pose needs."""
    for at in range(begin, begin + AGREE):
        locating.rolled(Pose(), at, shown(x, y, at))


def source(locating: Locating) -> Source | None:
    """Return the source of its pose; None where there are no cameras."""
    return None if locating.located is None else locating.located.source


def test_without_cameras_it_is_odometrys_and_begins_where_it_is_reported_to() -> None:
    locating = Locating(find("rome"))
    locating.rolled(Pose(0.3, 0.1, 0.2), CYCLE, shown(5.0, 5.0, CYCLE))
    assert (locating.pose, locating.located) == (Pose(0.3, 0.1, 0.2), None)
    locating.interrupted()
    assert locating.pose == Pose(0.3, 0.1, 0.2)
    assert locating.begin_again() == "the present place is the origin"
    assert locating.pose == Pose()


def test_with_cameras_it_is_theirs_carried_on_by_what_is_rolled() -> None:
    locating = Locating(find("rome+cameras"))
    locating.rolled(Pose(), 0, {})
    assert source(locating) is Source.UNSEEN
    see(locating, 2.0, -1.0, CYCLE - AGREE)
    locating.rolled(Pose(0.02, 0.01, 0.0), 2 * CYCLE, shown(2.0, -1.0, CYCLE - 1))
    assert locating.pose == Pose(2.02, -0.99, 0.0)
    assert source(locating) is Source.CAPTURED


def test_elsewhere_it_is_believed_when_someone_states_so_or_what_was_rolled_is_not_known() -> None:
    for again in (Locating.begin_again, Locating.interrupted):
        locating = Locating(find("rome+cameras"))
        see(locating, 2.0, -1.0, CYCLE)
        see(locating, 4.0, 4.0, 2 * CYCLE)
        assert locating.pose == Pose(2.0, -1.0, 0.0)
        again(locating)
        assert source(locating) is Source.UNSEEN
        see(locating, 4.0, 4.0, 3 * CYCLE)
        assert locating.pose == Pose(4.0, 4.0, 0.0)
