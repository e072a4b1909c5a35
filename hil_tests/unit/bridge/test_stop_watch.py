"""The watch over stops, at both edges of each time: what confirms a stage, and what comes where none is."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.bridge.stops import AT_STANDSTILL, SLOWED, Stops
from firmware_bridge.drivers.driver import Power, SetPoint, Speed, Stop
from firmware_bridge.drivers.life_cycle import Transition
from firmware_bridge.drivers.stop_stages import TAKEN_WITHIN
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, to_seconds
from hil_tests.unit.pipeline.cart import WHEELS, FakeCart

START: Final[Nanoseconds] = 10 * SECOND
SILENT: Final = 250 * MILLISECOND
CYCLE: Final = 50 * MILLISECOND
DECELERATION: Final = 5_700 / 26.0 * 0.104_719_755
"""rad/s2 behind the gear."""
STAGES: Final = (
    "ramp",
    "quick stop by PDO",
    "quick stop by SDO",
    "power off by SDO",
    "silence",
    "reset",
)
TASKS: Final = [Transition.LISTEN, Transition.QUICK_STOP, Transition.POWER_OFF, Transition.RESET]


class Watched:
    """The left wheel of the cart, with a stop requested."""

    def __init__(self, speed: float = 5.0) -> None:
        cart = FakeCart()
        self.all_drivers = cart.all_drivers
        self.links = cart.links
        self.driver = cart.drivers["left"]
        self.stops = Stops(cart.robot, cart.all_drivers)
        self.now = START
        self.requested = {"left"}
        self.set_point: SetPoint = Stop.STANDSTILL
        self.reports(speed)

    def reports(self, speed: float, power: Power = Power.ON) -> None:
        """Let the drive report a sample, now."""
        self.driver.feedback = replace(
            self.driver.feedback, velocity=speed, power=power, received_at=self.now, sampled_at=self.now
        )

    def looks(self, later: Nanoseconds = 0) -> Mapping[str, SetPoint]:
        """Look at it so much later; return the set-points as they are to be sent."""
        self.now += later
        sent, set_points = self.stops.watch(self.requested, {"left": self.set_point}, self.now)
        assert sent == (), "a paper driver sends nothing"
        return set_points

    def unconfirmed(self) -> str | None:
        """The stage that failed last, if any."""
        events = self.stops.interlock_events
        assert [event.name for event in events] == ["stop not acknowledged: left"] * len(events)
        assert len(events) <= 1
        return events[0].stage if events else None

    def confirmed(self) -> bool:
        return not self.stops.under_way and not self.stops.given_up


@pytest.mark.parametrize(
    ("speed", "rests"), [(12.0 * AT_STANDSTILL, True), (12.0 * AT_STANDSTILL + 1e-9, False)]
)
@pytest.mark.parametrize("sign", [1, -1])
def test_rest_is_a_share_of_the_top_speed(speed: float, sign: int, *, rests: bool) -> None:
    watched = Watched()
    watched.looks()
    watched.now += CYCLE
    watched.reports(sign * speed)
    watched.looks()
    assert watched.confirmed() is rests


@pytest.mark.parametrize("later", [0, 1])
def test_only_a_word_from_after_the_stop_confirms_it(later: int) -> None:
    watched = Watched()
    watched.looks()
    watched.now += later
    watched.reports(0.0)
    watched.looks()
    assert watched.confirmed() is bool(later)


def test_without_torque_the_stop_is_done_at_any_speed() -> None:
    watched = Watched()
    watched.driver.unpowered = True
    watched.looks()
    assert watched.confirmed()


@pytest.mark.parametrize(("early", "fails"), [(1_000, False), (-1_000, True)])
@pytest.mark.parametrize("speed", [5.0, -5.0, 0.5])
def test_a_drive_that_goes_on_has_the_time_of_its_ramp_and_the_step_s(
    speed: float, early: int, *, fails: bool
) -> None:
    watched = Watched(speed)
    watched.looks()
    until = START + 150 * MILLISECOND + round(abs(speed) / DECELERATION * SECOND)
    for at in (*range(START + CYCLE, until - early, CYCLE), until - early):
        watched.now = at
        watched.reports(speed)
        watched.looks()
    assert watched.unconfirmed() == ("ramp" if fails else None)


@pytest.mark.parametrize(("share", "fails"), [(SLOWED, False), (SLOWED + 0.01, True)])
def test_one_that_slows_down_is_given_more_time(share: float, *, fails: bool) -> None:
    watched = Watched(1.0)
    watched.looks()
    for _ in range(3):
        watched.now += CYCLE
        watched.reports(share)
        watched.looks()
    watched.now += CYCLE
    watched.reports(share)
    watched.looks()
    assert watched.unconfirmed() == ("ramp" if fails else None)


@pytest.mark.parametrize(("power", "patience"), [(Power.ON, SILENT), (Power.UNKNOWN, 150 * MILLISECOND)])
def test_one_that_is_not_received_is_given_its_time_out_and_no_more(power: Power, patience: int) -> None:
    watched = Watched()
    watched.reports(5.0, power)
    watched.looks()
    watched.looks(patience - 1)
    assert watched.unconfirmed() is None
    assert watched.looks(1)["left"] is Stop.QUICK_STOP
    assert watched.unconfirmed() == "ramp"
    assert watched.driver.begun == [Transition.LISTEN]


def test_while_the_bridge_itself_ramps_the_drive_is_not_late() -> None:
    watched = Watched()
    for speed in range(100, 0, -5):
        watched.set_point = Speed(speed / 10.0)
        watched.looks(CYCLE)
        watched.reports(speed / 10.0)
    assert watched.unconfirmed() is None
    watched.set_point = Speed(0.0)
    watched.looks(CYCLE)
    assert not watched.confirmed()


def escalated(watched: Watched) -> list[str]:
    """Report nothing more; return the stages that fail, in order, until all have."""
    failed = []
    while not watched.stops.given_up:
        assert watched.now < START + 20 * SECOND
        watched.looks(CYCLE)
        stage = watched.unconfirmed()
        if stage is not None and stage not in failed:
            failed.append(stage)
    return failed


def test_a_drive_that_is_receiving_nothing_is_taken_through_every_stage() -> None:
    watched = Watched()
    assert escalated(watched) == list(STAGES)
    assert watched.driver.begun == TASKS
    # Two silences, two objects of which the first ends with its task, the watch from top speed, the reset.
    assert to_seconds(watched.now - START) < 0.25 + 0.25 + 0.2 + 0.2 + 0.35 + 12.0 / 21.0 + 1.0 + 6 * 0.05
    (event,) = watched.stops.interlock_events
    assert (
        event.reason == "node 1 (left): reset not acknowledged; nothing is left to try; it may go on moving"
    )
    assert event.interlock.disarms


def test_for_an_axis_that_rested_no_one_else_loses_power() -> None:
    watched = Watched(0.0)
    assert escalated(watched) == [stage for stage in STAGES if stage != "silence"]


def test_a_power_off_that_was_ordered_begins_with_it() -> None:
    watched = Watched(0.0)
    watched.set_point = Stop.POWER_OFF
    watched.reports(0.0)
    assert escalated(watched) == ["power off by PDO", "power off by SDO", "silence", "reset"]


def test_rest_is_not_enough_where_the_power_was_ordered_off() -> None:
    watched = Watched(0.0)
    watched.set_point = Stop.POWER_OFF
    watched.looks()
    watched.now += CYCLE
    watched.reports(0.0)
    watched.looks()
    assert watched.stops.under_way
    watched.driver.unpowered = True
    watched.looks(CYCLE)
    assert watched.confirmed()


def test_the_link_is_silent_for_that_stage_and_no_longer() -> None:
    watched = Watched()
    watched.all_drivers.begin_beats(START)
    beats: dict[str, list[Nanoseconds]] = {link_drivers.name: [] for link_drivers in watched.all_drivers.all}
    for link in watched.links.values():
        link.beats = beats[link.name]
    while not watched.stops.given_up:
        watched.looks(CYCLE)
        watched.all_drivers.beat(watched.now)
    missed = sorted(set(beats["tool"]) - set(beats["drives"]))
    assert set(beats["drives"]) < set(beats["tool"])
    assert missed[-1] - missed[0] >= 200 * MILLISECOND, "longer than the drives' patience"
    assert beats["drives"][-1] > missed[-1]


def test_a_confirmed_stop_begins_again_where_the_word_is_missed_or_states_otherwise() -> None:
    for speed, later in ((0.0, SILENT), (1.0, 1)):
        watched = Watched(0.0)
        watched.looks()
        watched.now += 1
        watched.reports(0.0)
        watched.looks()
        assert watched.confirmed()
        if speed:
            watched.now += 1
            watched.reports(speed)
        watched.looks(later - 1)
        assert watched.confirmed() is (speed == 0.0)
        watched.looks(1)
        assert watched.stops.under_way


@pytest.mark.parametrize("every", [2, 3, 4])
def test_a_drive_that_rests_for_a_moment_again_and_again_gets_no_new_time_by_it(every: int) -> None:
    watched, taken_at = Watched(), None
    for cycle in range(200):
        watched.looks(CYCLE)
        watched.reports(0.0 if cycle % every == 0 else 5.0)
        if taken_at is None and Transition.POWER_OFF in watched.driver.begun:
            taken_at = watched.now
    assert taken_at is not None, "5 s after the stop began a stage takes the power, whatever was confirmed"
    assert 4.0 < to_seconds(taken_at - START) <= to_seconds(TAKEN_WITHIN) + 6 * 0.05


def test_an_axis_that_may_move_is_left_alone() -> None:
    watched = Watched()
    watched.requested = set()
    assert watched.looks(10 * SECOND)["left"] is Stop.STANDSTILL
    assert watched.driver.begun == []


def test_a_stop_that_escalates_does_not_end_because_no_one_requests_any_more() -> None:
    watched = Watched()
    watched.looks()
    watched.looks(SILENT)
    watched.requested = set()
    assert watched.looks(CYCLE)["left"] is Stop.QUICK_STOP
    watched.now += 1
    watched.reports(0.0)
    watched.looks()
    watched.looks(CYCLE)
    assert not watched.stops.escalating
    assert watched.unconfirmed() is None


def test_nothing_is_tried_over_a_link_that_is_gone() -> None:
    watched = Watched()
    watched.links[WHEELS].lost = "the adapter is gone"
    watched.looks()
    watched.looks(10 * SECOND)
    assert watched.driver.begun == []


@given(
    speed=st.floats(-12.0, 12.0),
    lag=st.floats(0.0, 0.1),
    lost=st.lists(st.booleans(), min_size=60, max_size=60),
)
def test_an_honest_drive_is_never_taken_further_than_its_ramp(
    speed: float, lag: float, lost: list[bool]
) -> None:
    """It begins up to two cycles late, and of its samples any may be lost, but no four in a row."""
    watched = Watched(speed)
    watched.looks()
    sign = 1.0 if speed >= 0.0 else -1.0
    missed = 0
    for is_lost in lost:
        watched.now += CYCLE
        ramped = max(to_seconds(watched.now - START) - lag, 0.0) * DECELERATION
        missed = missed + 1 if is_lost and missed < 2 else 0
        if not missed:
            watched.reports(sign * max(abs(speed) - ramped, 0.0))
        watched.looks()
        assert watched.unconfirmed() is None
    assert watched.confirmed()


@given(stated=st.lists(st.tuples(st.sampled_from([1, 49, 50, 51, 200]), st.floats(0.2, 12.0)), max_size=30))
def test_whatever_a_moving_drive_states_the_last_stage_comes_in_bounded_time(
    stated: list[tuple[int, float]],
) -> None:
    watched = Watched()
    watched.looks()
    for ms, speed in stated:
        watched.now += ms * MILLISECOND
        watched.reports(speed)
        watched.looks()
        assert not watched.confirmed() or watched.stops.given_up
    began = watched.now
    while not watched.stops.given_up:
        watched.looks(CYCLE)
    assert watched.now - began < 5 * SECOND
    assert Transition.RESET in watched.driver.begun


def without_power() -> Watched:
    """A drive that has confirmed the stage that takes its power, and nothing since."""
    watched = Watched()
    while Transition.POWER_OFF not in watched.driver.begun:
        watched.looks(CYCLE)
    watched.driver.unpowered = True
    watched.looks(CYCLE)
    assert watched.confirmed()
    return watched


def test_the_word_that_took_the_power_stays_in_force_until_that_is_steady() -> None:
    watched = without_power()
    while watched.now < START + 20 * SECOND:
        set_point = watched.looks(CYCLE)["left"]
        if set_point is not Stop.POWER_OFF:
            break
    assert set_point is Stop.STANDSTILL
    assert to_seconds(watched.now - watched.stops.of_axes["left"].confirmed_at) == pytest.approx(
        0.5, abs=0.06
    )


def test_a_drive_set_up_again_after_its_power_off_is_reported_once_more_before_it_is_reset() -> None:
    watched = without_power()
    watched.looks(8 * CYCLE)
    watched.driver.begun.clear()
    watched.driver.unpowered = False
    assert watched.looks(CYCLE)["left"] is Stop.POWER_OFF
    assert watched.driver.begun == [Transition.POWER_OFF]
    watched.looks(3 * CYCLE)
    assert watched.driver.begun == [Transition.POWER_OFF], "it has its time to answer"
    watched.driver.unpowered = True
    watched.looks(CYCLE)
    assert watched.confirmed()


def test_a_drive_that_goes_back_and_forth_about_its_power_is_reset_at_last() -> None:
    watched = without_power()
    for cycle in range(200):
        watched.looks(CYCLE)
        watched.driver.unpowered = cycle % 3 == 0
        if Transition.RESET in watched.driver.begun:
            break
    assert Transition.RESET in watched.driver.begun
    assert to_seconds(watched.now - START) < to_seconds(TAKEN_WITHIN) + 1.5, "the silence before it lasts 1 s"
