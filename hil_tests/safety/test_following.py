"""The range in which an axis may be after its set-points, and at both edges of each bound its name."""

import math
from dataclasses import asdict
from typing import Any, Final

import pytest

from firmware_bridge.drivers.driver import Position, SetPoint, Speed, Stop
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Link
from firmware_bridge.families.motor_shield.settings import ShieldAxis
from firmware_bridge.robot.plausibility import Plausibility
from firmware_bridge.robot_types import find, names
from firmware_bridge.safety.tracking import bounds_of, within
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.safety.following_bench import CYCLE, GIVES, RARS, SLACK, STEERING, WHEEL, Axle, settled, still
from hil_tests.safety.gate_bench import above

AT_THREE: Final = SLACK + 3.0 * GIVES
"""The slack of a wheel that is commanded to 3 rad/s, one way or the other."""

# What follows from axis, drive and link


def test_what_a_shield_s_axis_leaves_out_is_worked_out_from_its_regulator() -> None:
    robot = find("rome")
    for axis in robot.axes:
        bounds = bounds_of(robot, axis)
        assert bounds.ramp == 0.5 * ShieldAxis.of(axis).acceleration
        assert bounds.cruise == pytest.approx(
            0.5 * ShieldAxis.of(axis).full_speed_rpm * math.tau / 60.0 / axis.ratio
        )
        assert bounds.position == pytest.approx(axis.top_speed / 40.0)


@pytest.mark.parametrize("name", [name for name in names() if Epos2Link.all_of(find(name))])
def test_what_a_robot_file_leaves_out_is_worked_out(name: str) -> None:
    robot = find(name)
    for axis in robot.axes:
        bounds, drive = bounds_of(robot, axis), Epos2Axis.of(axis).profile
        rpm = 2.0 * math.pi / 60.0 / axis.ratio
        gentlest = min(drive.acceleration_rpm_s, drive.deceleration_rpm_s, drive.quick_stop_rpm_s)
        assert bounds.speed == bounds.position == pytest.approx(axis.top_speed / 40.0)
        assert axis.standstill_below == pytest.approx(axis.top_speed / 80.0)
        assert bounds.ramp == pytest.approx(0.5 * gentlest * rpm)
        assert bounds.cruise == pytest.approx(0.5 * drive.velocity_rpm * rpm)
        assert bounds.lag_s == 0.1 + 2 * robot.cycle / SECOND
        within_ms = axis.plausibility.within_ms or Epos2Link.of_link(robot, axis.link).silent_ms
        assert bounds.creep == pytest.approx(axis.standstill_below * within_ms / 1000)
        assert axis.holds_with == Epos2Axis.of(axis).continuous_current_ma / 1000


def test_what_a_robot_file_states_counts() -> None:
    stated = Plausibility(
        standstill_below=0.3,
        speed=1.0,
        position=2.0,
        ramp=3.0,
        cruise=4.0,
        holds_with=5.0,
        lag_ms=60,
        within_ms=70,
    )
    axis = WHEEL.model_copy(update={"plausibility": stated})
    bounds = bounds_of(RARS, axis)
    assert (bounds.speed, bounds.position, bounds.ramp, bounds.cruise) == (1.0, 2.0, 3.0, 4.0)
    assert bounds.lag_s == 0.06
    assert bounds.creep == pytest.approx(0.3 * 0.07)
    assert (axis.standstill_below, axis.holds_with) == (0.3, 5.0)
    assert within(axis, SECOND) == 70 * MILLISECOND
    assert within(WHEEL, SECOND) == SECOND


@pytest.mark.parametrize(
    ("key", "value", "changes"),
    [
        ("speed", 1.0, {"speed": 1.0}),
        ("position", 2.0, {"position": 2.0}),
        ("ramp", 3.0, {"ramp": 3.0}),
        ("cruise", 4.0, {"cruise": 4.0}),
        ("lag_ms", 60, {"lag_s": 0.06}),
        ("standstill_below", 0.3, {"creep": 0.3 * 0.25}),
        ("within_ms", 70, {"creep": 0.2 * 0.07}),
    ],
)
def test_each_key_of_a_robot_file_changes_its_own_bound_alone(
    key: str, value: Any, changes: dict[str, float]
) -> None:
    """RARS's wheel rests below 0.2 rad/s, an 80th of 16; its link allows a silence of 250 ms."""
    axis = WHEEL.model_copy(update={"plausibility": Plausibility(**{key: value})})
    excluded, bounds = asdict(bounds_of(RARS, WHEEL)), asdict(bounds_of(RARS, axis))
    assert bounds == pytest.approx(excluded | changes)


def test_a_link_of_every_second_cycle_has_twice_the_way() -> None:
    slower = Epos2Link.of_link(RARS, "drives").model_copy(update={"every": 2})
    assert bounds_of(RARS.with_links({"drives": slower}), WHEEL).lag_s == pytest.approx(0.3)


# Speeds


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("set_point", [Stop.STANDSTILL, Stop.QUICK_STOP, Stop.POWER_OFF, Speed(0.0)])
def test_what_is_commanded_to_stand_may_not_move_faster_than_its_slack(
    set_point: SetPoint, sign: float
) -> None:
    assert not still(set_point).deviates(sign * SLACK)
    one = still(set_point)
    assert one.deviates(sign * above(SLACK))
    assert one.follower.following.uncommanded


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("does", "deviates", "uncommanded"),
    [
        (3.0, False, False),
        (3.0 - AT_THREE + 1e-9, False, False),
        (3.0 - AT_THREE - 1e-6, True, False),
        (0.0, True, False),
        (-AT_THREE + 1e-9, True, False),
        (-AT_THREE - 1e-9, True, True),
        (3.0 + AT_THREE - 1e-9, False, False),
        (3.0 + AT_THREE + 1e-6, True, True),
    ],
)
def test_a_speed_that_is_not_the_one_commanded_is_too_little_or_uncommanded(
    does: float, sign: float, *, deviates: bool, uncommanded: bool
) -> None:
    one = settled(Speed(sign * 3.0), sign * 3.0)
    assert one.deviates(sign * does) is deviates
    assert one.follower.following.uncommanded is uncommanded


@pytest.mark.parametrize(
    ("was", "reported", "does", "deviates"),
    [
        # The slack is 0.4, and 0.02 of the fastest that the range holds: 0.6 rad/s.
        (-10.0, 3.0, -10.59, False),
        (-10.0, 3.0, -10.61, True),
        (-3.0, 10.0, 10.59, False),
        (-3.0, 10.0, 10.61, True),
    ],
)
def test_a_range_over_both_ways_has_the_slack_of_its_faster_end(
    was: float, reported: float, does: float, *, deviates: bool
) -> None:
    one = settled(Speed(was), was)
    one.commanded(Speed(reported))
    assert one.deviates(does) is deviates


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("does", "uncommanded"), [(-0.59, False), (-0.61, True)])
def test_what_stays_behind_may_turn_back_by_the_slack_of_the_faster_end(
    does: float, sign: float, *, uncommanded: bool
) -> None:
    one = settled(Speed(sign * 10.0), sign * 10.0)
    one.commanded(Speed(sign * 3.0))
    assert one.deviates(sign * does)
    assert one.follower.following.uncommanded is uncommanded


def test_what_is_no_number_is_uncommanded() -> None:
    one = still(Speed(0.0))
    assert one.deviates(0.0, velocity=math.nan)
    assert one.follower.following.uncommanded
    one = still(Position(0.0), STEERING)
    assert one.deviates(0.0, position=math.nan)
    assert one.follower.following.uncommanded


def test_a_new_speed_counts_at_once_and_the_old_one_for_a_while() -> None:
    one = settled(Speed(3.0), 3.0)
    one.commanded(Speed(0.0))
    assert not one.deviates(0.0), "it may be as fast as commanded"
    one = settled(Speed(3.0), 3.0)
    one.commanded(Speed(0.0))
    assert not one.deviates(3.0), "it may not have received it yet"
    # 10.9 rad/s2 for 50 ms are 0.545 rad/s, and 200 ms take 22 % of 3 rad/s: the slower one counts.
    assert one.deviates(3.0), "now it should be slower"


def test_a_range_shrinks_with_its_ramp_and_then_with_its_lag() -> None:
    one = settled(Speed(10.0), 10.0)
    one.commanded(Speed(0.0))
    one.does(10.0)
    before = one.follower.following.high
    assert before == pytest.approx(10.0)
    ramp = bounds_of(RARS, WHEEL).ramp * 0.05
    highs = [one.does(0.0).high for _ in range(60)]
    assert highs[0] == pytest.approx(before - ramp)
    assert highs[1] == pytest.approx(before - 2.0 * ramp)
    last = highs[-2] / highs[-1]
    assert last == pytest.approx(math.exp(0.25)), "50 ms of 200 ms"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_range_reaches_to_each_new_speed_and_keeps_what_it_has(sign: float) -> None:
    one = still(Speed(0.0))
    one.commanded(Speed(sign * 3.0))
    one.commanded(Speed(0.0))
    assert not one.deviates(sign * 3.0), "commanded twice between two samples, it may have received either"
    one = still(Speed(sign * 3.0))
    one.commanded(Speed(sign * 5.0))
    known = one.does(0.0)
    assert sorted((sign * known.low, sign * known.high)) == [0.0, 5.0]


@pytest.mark.parametrize("between", [1, 2, 3, 4])
def test_each_of_several_set_points_between_two_samples_counts(between: int) -> None:
    one = still(Speed(0.0))
    for number in range(1, between + 1):
        one.commanded(Speed(float(number)))
        one.commanded(Speed(-float(number)))
    one.commanded(Speed(0.0))
    known = one.does(0.0)
    assert (known.low, known.high) == (-between, between)


def test_while_it_deviates_the_last_sample_that_obeyed_is_kept() -> None:
    one = still(Speed(0.0))
    last = one.now
    assert [one.does(3.0).obeyed_at for _ in range(3)] == [last] * 3
    assert one.does(0.0).obeyed_at == one.now


# Positions


@pytest.mark.parametrize("speed", [0.0, 0.01, -0.01])
def test_where_it_obeys_a_position_it_does_not_move_uncommanded(speed: float) -> None:
    one = still(Position(0.0), STEERING)
    known = one.does(speed)
    assert known.obeyed_at == known.sampled_at
    assert not known.uncommanded


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_position_is_approached_or_not(sign: float) -> None:
    slack, cruise = STEERING.top_speed / 40.0, bounds_of(RARS, STEERING).cruise
    stands = still(Position(sign * 1.0), STEERING)
    goes = still(Position(sign * 1.0), STEERING)
    for _ in range(10):
        assert not goes.deviates(sign * 1.1 * cruise)
        known = stands.does(0.0)
    assert known.obeyed_at < known.sampled_at
    assert not known.uncommanded
    assert abs(known.position - sign * min(abs(known.low), abs(known.high))) > slack


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_who_goes_away_from_its_position_moves_uncommanded(sign: float) -> None:
    one = still(Position(0.0), STEERING)
    slack = STEERING.top_speed / 40.0
    assert not one.deviates(0.0, position=sign * slack)
    far = sign * above(slack)
    assert one.does(sign * 1.0, position=far).uncommanded
    assert not one.does(sign * slack, position=far).uncommanded, "it hardly moves: it does not follow"
    known = one.does(-sign * 1.0, position=far)
    assert not known.uncommanded, "it comes back"
    assert known.obeyed_at < known.sampled_at


def test_a_position_that_is_given_up_may_coast_to_rest() -> None:
    one = still(Position(1.0), STEERING)
    one.does(1.6, 3)
    one.commanded(Stop.STANDSTILL)
    assert not one.deviates(1.6)
    assert not one.deviates(0.0)
    one = still(Position(1.0), STEERING)
    one.does(1.6, 3)
    one.commanded(Stop.STANDSTILL)
    one.does(1.6, 10)
    assert one.deviates(1.6)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("share", [0.0, 0.5, 1.2])
def test_given_up_it_may_be_as_fast_as_it_ever_is_or_as_it_was(share: float, sign: float) -> None:
    top = STEERING.top_speed
    one = still(Position(sign * 9.0), STEERING)
    one.does(sign * share * top, 2)
    one.commanded(Stop.STANDSTILL)
    known = one.does(0.0)
    ends = sorted((sign * known.low, sign * known.high))
    assert ends == pytest.approx([-top, max(top, share * top)])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_reported_a_position_on_its_way_it_may_be_as_far_beside_it_as_its_lag_takes_it(sign: float) -> None:
    one = Axle(STEERING)
    one.commanded(Speed(sign * 1.5))
    one.does(sign * 1.5, 40)
    place = one.position
    one.commanded(Position(place))
    known = one.does(0.0)
    further = 1.5 * bounds_of(RARS, STEERING).lag_s
    assert (known.low, known.high) == pytest.approx((place - further, place + further))


def test_a_position_that_is_reported_on_the_way_may_be_overshot_a_little() -> None:
    one = Axle(STEERING)
    one.commanded(Speed(1.5))
    one.does(1.5, 40)
    one.commanded(Position(one.position))
    assert not one.deviates(1.5)


# A position that repeats


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_wheel_whose_position_repeats_backlog_its_way(sign: float) -> None:
    one = settled(Speed(sign * 0.1), sign * 0.1)
    creep = bounds_of(RARS, WHEEL).creep
    before = one.follower.following.sampled_at
    # 0.1 rad/s owe 0.005 rad a cycle; a speed of 0 is within the slack.
    for cycle in range(1, 13):
        known = one.does(0.0)
        assert known.obeyed_at == known.sampled_at
        assert known.backlog == pytest.approx(0.005 * cycle)
        assert known.place_at == before
        if known.backlog <= creep:
            assert known.settled_at == known.sampled_at
    assert known.settled_at < known.sampled_at
    assert one.does(sign * 1e-9).settled_at == one.now, "one bit is enough"
    assert one.follower.following.backlog == 0.0


def test_what_need_not_move_has_no_backlog() -> None:
    one = still(Speed(0.0))
    known = one.does(0.0, 100)
    assert (known.backlog, known.settled_at) == (0.0, one.now)
    assert known.place_at < one.now - 4 * SECOND


@pytest.mark.parametrize("place", [0.0, 0.2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_position_that_repeats_backlog_what_its_range_has_left_behind(sign: float, place: float) -> None:
    one = Axle(STEERING)
    one.position = place
    one.commanded(Position(place))
    assert one.does(0.0, 3).backlog == 0.0
    one.commanded(Position(place + sign * 0.5))
    known = one.does(0.0, 4)
    nearest = known.low if sign > 0.0 else known.high
    assert known.backlog == pytest.approx(sign * (nearest - known.position))
    assert known.backlog > bounds_of(RARS, STEERING).creep


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_axis_that_moves_too_slowly_to_its_position_has_no_backlog(sign: float) -> None:
    """It does not follow; its position does not repeat."""
    one = still(Position(sign * 1.0), STEERING)
    known = one.does(sign * 0.001, 20)
    assert known.obeyed_at < known.sampled_at
    assert (known.backlog, known.settled_at) == (0.0, known.sampled_at)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_wheel_backlog_the_least_that_it_should_have_gone(sign: float) -> None:
    one = settled(Speed(sign * 2.0), sign * 2.0)
    one.commanded(Speed(sign * 3.0))
    assert one.does(0.0).backlog == pytest.approx(0.05 * 2.0)
    one = settled(Speed(sign * 2.0), sign * 2.0)
    one.commanded(Speed(-sign * 3.0))
    assert one.does(0.0).backlog == 0.0, "on its way to the other side it may stand"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_however_slow_it_should_go_it_backlog_until_it_moves(sign: float) -> None:
    one = settled(Speed(sign * 5e-7), sign * 5e-7)
    assert one.does(0.0).backlog == pytest.approx(0.05 * 5e-7)
    one.commanded(Speed(0.0))
    assert one.does(0.0, 3).backlog == pytest.approx(0.05 * 5e-7), "a command to stand pays nothing back"
    assert one.does(sign * 1e-9).backlog == 0.0


@pytest.mark.parametrize("stop", [Speed(0.0), Stop.STANDSTILL])
def test_an_encoder_that_freezes_while_its_wheel_is_stopped_is_known_at_rest(stop: SetPoint) -> None:
    one = settled(Speed(4.0), 4.0)
    for speed in (3.0, 2.0, 1.0):
        one.commanded(Speed(speed))
        one.does(0.0)
    one.commanded(stop)
    known = one.does(0.0, 8)
    assert known.obeyed_at > known.sampled_at - SECOND // 2
    assert known.backlog > bounds_of(RARS, WHEEL).creep
    assert known.sampled_at - known.settled_at >= 8 * CYCLE
    one.commanded(Stop.POWER_OFF)
    assert one.does(0.0).backlog == 0.0, "what no one drives has no backlog"


def test_what_it_may_creep_it_may_owe() -> None:
    one = still(Speed(0.125), standstill_below=0.125, within_ms=50)
    one.does(0.125, 200)
    assert one.does(0.0).settled_at == one.now
    assert one.does(0.0).settled_at == one.now - CYCLE
