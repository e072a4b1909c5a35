"""Plausibility of an axis when its power goes and comes, and when a sample is old or the first one."""

from dataclasses import replace

import pytest

from firmware_bridge.drivers.driver import Feedback, Position, Power, SetPoint, Speed, Stop
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import AnyRobot, CommandForm
from firmware_bridge.robot_types import find, names
from firmware_bridge.safety.tracking import Followers, TrackingMonitor, bounds_of
from firmware_bridge.units import SECOND
from hil_tests.safety.following_bench import CYCLE, RARS, STEERING, WHEEL, Axle, settled, still


@pytest.mark.parametrize("power", [Power.OFF, Power.FAULT])
def test_without_torque_an_axis_may_coast(power: Power) -> None:
    one = still(Speed(0.0))
    assert not one.deviates(9.0, power=power)
    assert not one.deviates(9.0, power=power)
    known = one.does(5.0)
    assert known.obeyed_at == known.sampled_at
    assert not one.deviates(4.5), "with its power back it comes to rest from where it was"
    one.does(4.5, 20)
    assert one.deviates(4.5)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_power_that_comes_back_finds_the_axis_as_it_is(sign: float) -> None:
    one = still(Speed(sign * 3.0))
    changed = one.now
    for power in (Power.OFF, Power.ON):
        known = one.does(sign * 5.0, power=power)
        assert (known.set_point, known.changed_at) == (Speed(sign * 3.0), changed)
        assert (known.position, known.velocity) == (one.position, sign * 5.0)
        assert known.sampled_at == known.obeyed_at == known.settled_at == known.place_at == one.now
    known = one.does(sign * 5.0)
    assert sorted((sign * known.low, sign * known.high)) == [0.0, 5.0]
    assert (known.backlog, known.uncommanded) == (0.0, False)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_nothing_that_is_reported_without_torque_is_judged_by_the_next_sample(sign: float) -> None:
    one = still(Speed(0.0))
    one.does(sign * 9.0, power=Power.OFF)
    one.commanded(Speed(sign * 0.1))
    assert not one.deviates(sign * 9.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_axis_that_was_moved_by_hand_may_be_where_it_is_when_its_power_comes_back(sign: float) -> None:
    one = Axle(STEERING)
    one.commanded(Position(sign * 1.0))
    one.position = sign * 1.0
    one.does(0.0, 3)
    for place in (1.5, 2.0, 2.5, 3.0):
        one.position = sign * place
        one.does(0.0, power=Power.OFF)
        one.does(0.0)
        assert not one.deviates(0.0)
        known = one.follower.following
        assert sorted((sign * known.low, sign * known.high)) == [1.0, place]


@pytest.mark.parametrize("power", [Power.ON, Power.UNKNOWN, Power.STOPPED])
def test_with_torque_or_without_a_word_for_it_an_axis_is_watched(power: Power) -> None:
    one = still(Speed(0.0))
    assert one.deviates(1.0, power=power)


def test_a_device_that_has_stopped_by_itself_is_to_stand_whatever_it_is_reported() -> None:
    one = settled(Speed(3.0), 3.0)
    assert not one.deviates(3.0, power=Power.STOPPED)
    for _ in range(20):
        known = one.does(3.0, power=Power.STOPPED)
    assert known.uncommanded
    assert one.does(0.0, power=Power.STOPPED).obeyed_at == one.now
    one.does(0.0, 20)
    assert known.set_point == Speed(3.0), "the demand itself is kept"


@pytest.mark.parametrize("speed", [3.0, 0.0])
def test_a_sample_that_was_seen_changes_nothing(speed: float) -> None:
    """An axis that follows, and one that has a backlog."""
    one = settled(Speed(3.0), 3.0)
    known = one.does(speed, 4)
    assert (known.settled_at == known.sampled_at) is (speed != 0.0)
    assert one.known(99.0) is known


@pytest.mark.parametrize("cycles", [1, 2, 5, 50])
def test_a_sample_older_than_the_newest_is_not_judged(cycles: int) -> None:
    """Four cycles of a way that is owed; the older sample shows another place and too much speed."""
    one = settled(Speed(3.0), 3.0)
    one.does(0.0, 4)
    one.now -= cycles * CYCLE
    one.position += 99.0
    known = one.known(9.0)
    assert known.sampled_at == known.obeyed_at == known.settled_at == known.place_at == one.now
    assert (known.position, known.backlog, known.uncommanded) == (one.position, 0.0, False)
    known = one.does(9.0)
    assert known.obeyed_at == known.settled_at == one.now
    assert one.does(9.0).high == 9.0, "its range begins with the speed that it had"


def test_each_time_that_its_power_comes_back_it_is_judged_from_the_second_sample_on() -> None:
    one = still(Speed(0.0))
    for _ in range(4):
        assert not one.deviates(9.0, power=Power.OFF)
        assert not one.deviates(0.0)
        assert one.deviates(9.0)


def test_its_range_reaches_to_rest_and_back_each_time_that_a_device_stops_and_goes_on() -> None:
    """Between the stops 60 cycles of 50 ms: the range has shrunk to what is demanded."""
    one = settled(Speed(3.0), 3.0)
    for _ in range(3):
        known = one.does(3.0, power=Power.STOPPED)
        assert (known.low, known.high) == pytest.approx((0.0, 3.0), abs=1e-3)
        known = one.does(0.0, 60, power=Power.STOPPED)
        assert (known.low, known.high) == pytest.approx((0.0, 0.0), abs=1e-3)
        known = one.does(0.0)
        assert (known.low, known.high) == pytest.approx((0.0, 3.0), abs=1e-3)
        known = one.does(3.0, 60)
        assert (known.low, known.high) == pytest.approx((3.0, 3.0), abs=1e-3)


def test_a_device_that_was_not_received_or_counts_again_is_not_judged() -> None:
    follower = TrackingMonitor(WHEEL, bounds_of(RARS, WHEEL))
    assert follower.saw(Feedback("left")).obeyed_at == NEVER_RECEIVED
    one = still(Speed(0.0))
    assert one.follower.saw(Feedback("left", Power.ON, sampled_at=NEVER_RECEIVED)).obeyed_at == NEVER_RECEIVED
    one.position = 99.0
    assert one.does(0.0).obeyed_at == one.now


def test_the_set_point_and_when_it_changed_are_known() -> None:
    one = still(Speed(1.0))
    changed = one.now
    one.does(1.0, 3)
    one.commanded(Speed(1.0))
    assert one.does(1.0).changed_at == changed
    one.commanded(Stop.STANDSTILL)
    known = one.does(1.0)
    assert (known.set_point, known.changed_at) == (Stop.STANDSTILL, one.now - CYCLE)


@pytest.mark.parametrize("name", names())
def test_all_axes_of_a_robot_are_watched_each_by_its_own(name: str) -> None:
    robot: AnyRobot = find(name)
    followers = Followers(robot)
    axes = {axis.name: Feedback(axis.name, Power.ON, SECOND, SECOND) for axis in robot.axes}
    followers.saw(axes)
    set_points: dict[str, SetPoint] = {
        axis.name: Speed(0.5 * axis.top_speed) for axis in robot.axes if axis.command is CommandForm.SPEED
    }
    now = SECOND
    followers.saw({name: replace(one, sampled_at=now + 1) for name, one in axes.items()})
    followers.on_set_points(set_points, now)
    for _ in range(20):
        now += robot.cycle
        known = followers.saw({name: replace(one, sampled_at=now) for name, one in axes.items()})
    assert {name for name, one in known.items() if one.obeyed_at < now} == set(set_points)
