"""Sticks and buttons: what they make of the intent, and those that are broken, overtaken or repeated."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from firmware_bridge.intent import NEVER_RECEIVED, Arm, ClearEmergencyStop, EmergencyStop
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.robots.rars.motion import RarsMotion
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.teleop.received import texts

if TYPE_CHECKING:
    from hil_tests.unit.teleop.bench import RarsBench


def test_before_anybody_speaks_nothing_is_wanted(bench: RarsBench) -> None:
    assert bench.command == RarsMotion()
    assert bench.operator.intent.received_at == NEVER_RECEIVED


def test_a_stick_becomes_the_intent_and_its_time(bench: RarsBench) -> None:
    bench.now = 7 * SECOND
    assert bench.stick(x=500, r=-500) == []
    assert (bench.command.speed_mps, bench.operator.intent.received_at) == (0.25, 7 * SECOND)
    assert bench.command.steer_rad == pytest.approx(0.5236, abs=1e-4)


def test_a_set_point_at_standstill_keeps_the_steering(bench: RarsBench) -> None:
    bench.stick(r=-500)
    steer = bench.command.steer_rad
    bench.target(0.0, 0.3)
    assert bench.command.steer_rad == steer


def test_what_is_refused_changes_nothing_and_is_no_sign_of_life(bench: RarsBench) -> None:
    bench.stick(x=500)
    before = bench.operator.intent
    bench.now += SECOND
    assert texts(bench.target(float("nan")))
    assert texts(bench.stick(x=2000))
    assert texts(bench.target(0.2, frame=1))
    assert bench.operator.intent == before
    assert bench.operator.dropped.refused == 3


def test_refusals_are_not_reported_at_the_rate_of_a_joystick(bench: RarsBench) -> None:
    reported = 0
    for _ in range(100):
        reported += bool(bench.target(0.2, frame=1))
        bench.now += 50 * MILLISECOND
    assert reported == 2  # at once, after 2 s, and then after 4 s more


def test_an_overtaken_set_point_is_forgotten(bench: RarsBench) -> None:
    early = bench.station.encode(dialect.MAVLink_manual_control_message(1, 1000, 0, 0, 0, 0))
    bench.stick(x=0)
    bench.now += 20 * MILLISECOND
    bench.send(early)
    assert bench.command.speed_mps == 0.0
    assert bench.operator.dropped.overtaken == 1
    bench.send(early)
    assert bench.operator.dropped.overtaken == 2


def test_a_datagram_that_arrives_twice_is_one_sign_of_life(bench: RarsBench) -> None:
    twice = bench.station.encode(dialect.MAVLink_manual_control_message(1, 100, 0, 0, 0, 0))
    bench.send(twice)
    bench.now += 20 * MILLISECOND
    bench.send(twice)
    assert bench.operator.intent.received_at == 0
    assert bench.operator.dropped.overtaken == 1


def test_a_station_that_starts_again_is_received_after_a_quarter_of_a_second(bench: RarsBench) -> None:
    for _ in range(100):
        bench.stick()
    bench.station = Codec(255, 190)
    bench.now += 249 * MILLISECOND
    bench.stick(x=100)
    assert bench.command.speed_mps == 0.0
    bench.now += 1 * MILLISECOND
    bench.stick(x=100)
    assert bench.command.speed_mps == pytest.approx(0.05)


@pytest.mark.parametrize("late", [249, 250, 260, 499, 2999])
def test_a_go_that_comes_after_the_stop_is_not_obeyed(bench: RarsBench, late: int) -> None:
    bench.stick()
    go = bench.station.encode(dialect.MAVLink_manual_control_message(1, 1000, 0, 0, 0, 0))
    bench.stick()
    bench.now += late * MILLISECOND
    bench.send(go)
    assert bench.command.speed_mps == 0.0
    assert bench.operator.dropped.overtaken == 1


@pytest.mark.parametrize(
    ("behind", "late", "received"), [(96, 2999, False), (96, 3000, True), (97, 250, True)]
)
def test_what_is_far_behind_or_comes_late_is_a_station_that_starts_again(
    bench: RarsBench, behind: int, late: int, *, received: bool
) -> None:
    early = bench.station.encode(dialect.MAVLink_manual_control_message(1, 200, 0, 0, 0, 0))
    for _ in range(behind):
        bench.stick()
    bench.now += late * MILLISECOND
    bench.send(early)
    assert (bench.command.speed_mps > 0.0) is received


@pytest.mark.parametrize("order", [(0, 1, 3, 2, 4), (0, 2, 1, 3, 4), (0, 1, 2, 4, 3)])
def test_one_swapped_datagram_switches_a_lamp_once(bench: RarsBench, order: tuple[int, ...]) -> None:
    presses = [bench.station.encode(one) for one in map(_pressing, (0, 2, 2, 0, 0))]
    for place in order:
        bench.send(presses[place])
        bench.now += 50 * MILLISECOND
    assert bench.command.headlamp


def _pressing(buttons: int) -> object:
    return dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, buttons)


def test_an_overtaken_stop_button_still_stops(bench: RarsBench) -> None:
    early = bench.station.encode(dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, 4))
    bench.stick()
    bench.send(early)
    assert bench.requested == [EmergencyStop()]


def test_a_stop_button_on_a_broken_stick_still_stops(bench: RarsBench) -> None:
    bench.stick(x=0x7FFE, buttons=4)
    assert bench.requested == [EmergencyStop()]


def test_the_stop_button_requests_until_the_robot_is_stopped_and_not_on(bench: RarsBench) -> None:
    bench.report()
    bench.stick(buttons=4)
    bench.stick(buttons=4)
    assert len(bench.requested) == 2
    bench.report()
    bench.stick(buttons=4)
    assert len(bench.requested) == 2


@pytest.mark.parametrize("within_ns", [0, 1, 49_999_999])
def test_the_stop_button_stops_at_once_after_a_clear(bench: RarsBench, within_ns: int) -> None:
    """The newest snapshot still has the emergency stop latched."""
    bench.stick(buttons=4)
    bench.report()
    bench.order(5300, 1)
    bench.now += within_ns
    bench.stick(buttons=4)
    assert bench.requested == [EmergencyStop(), ClearEmergencyStop(), EmergencyStop()]


def test_buttons_switch_when_they_go_down(bench: RarsBench) -> None:
    seen = []
    for buttons in (0, 1, 1, 0, 2, 3, 0, 3):
        bench.stick(buttons=buttons)
        seen.append((bench.command.detector, bench.command.headlamp))
    assert seen == [
        (False, False), (True, False), (True, False), (True, False),
        (True, True), (False, True), (False, True), (True, False),
    ]  # fmt: skip


def test_a_button_that_is_down_from_the_start_switches_nothing(bench: RarsBench) -> None:
    bench.stick(buttons=3)
    assert (bench.command.detector, bench.command.headlamp) == (False, False)


def test_the_lifts_stick_takes_over_from_its_target_and_not_before(bench: RarsBench) -> None:
    bench.order(400, 1)
    bench.report()
    bench.order(187, 0)
    seen = []
    for z, buttons in ((0, 0), (500, 8), (500, 0)):
        bench.stick(z=z, buttons=buttons)
        seen.append((bench.command.lift_m is not None, round(bench.command.lift_rate_mps, 6)))
    assert seen == [(True, 0.0), (False, 0.05), (False, 0.0)]


def test_arming_and_clearing_take_the_lifts_target_away(bench: RarsBench) -> None:
    for command, params, request in ((400, (1,), Arm), (5300, (1,), ClearEmergencyStop)):
        bench.facts = replace(bench.facts, armed=True)
        bench.report()
        bench.order(187, 0)
        assert bench.command.lift_m is not None
        bench.order(command, *params)
        assert isinstance(bench.requested[-1], request)
        assert bench.command.lift_m is None
