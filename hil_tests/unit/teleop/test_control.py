"""Station in control: the commands obeyed, and control taken, handed over, given up and lost."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from firmware_bridge.intent import (
    NEVER_RECEIVED,
    Answer,
    Arm,
    ChangeDriver,
    ClearEmergencyStop,
    Disarm,
    EmergencyStop,
)
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.teleop.commands import ROWS
from firmware_bridge.teleop.stations import LAPSES_AFTER, MOST_STATIONS
from firmware_bridge.units import MILLISECOND, SECOND
from firmware_bridge.wire.internet import number_of
from hil_tests.unit.teleop.bench import in_control
from hil_tests.unit.teleop.received import texts, types
from hil_tests.unit.teleop.stations import (
    ARM,
    CLEAR,
    CONTROL,
    FORCE,
    INTERVAL,
    PAUSE,
    RELAY,
    STOP,
    Hand,
)

if TYPE_CHECKING:
    from firmware_bridge.teleop.incoming import Sender
    from hil_tests.unit.teleop.bench import RarsBench

ACCEPTED, DENIED, FAILED = 0, 2, 4
HERE, THERE = number_of("10.0.0.1", 14550), number_of("10.0.0.2", 14550)


@pytest.fixture
def driver(bench: RarsBench) -> Hand:
    """A station that has armed, and drives."""
    hand = Hand(bench, HERE)
    hand.stick()
    assert hand.result(ARM, 1) == ACCEPTED
    bench.report()
    hand.stick(500)
    bench.requested.clear()
    return hand


@pytest.fixture(
    params=[(THERE, 255, 190), (HERE, 254, 190), (HERE, 255, 191), (number_of("10.0.0.1", 14551), 255, 190)]
)
def other(bench: RarsBench, driver: Hand, request: pytest.FixtureRequest) -> Hand:
    """A station that differs from who drives in one of address, port, system and component."""
    assert driver.bench is bench
    return Hand(bench, *request.param)


def drives(bench: RarsBench) -> Sender | None:
    return bench.operator.driver


def test_who_arms_while_no_one_drives_drives(bench: RarsBench, driver: Hand) -> None:
    assert drives(bench) == (driver.source, 255, 190)
    assert "control: 255/190 at 10.0.0.1:14550 is in control" in reported(bench)


def reported(bench: RarsBench) -> str:
    return "".join(texts(bench.received))


def test_who_is_denied_to_arm_does_not_drive(bench: RarsBench) -> None:
    bench.verdict = Answer(accepted=False, reason="no")
    assert Hand(bench, HERE).result(ARM, 1) == DENIED
    assert drives(bench) is None


def test_sticks_of_anybody_else_are_no_intent(bench: RarsBench, other: Hand) -> None:
    before = bench.operator.intent
    bench.now += 50 * MILLISECOND
    text = "".join(texts(other.stick(-1000, buttons=1)))
    assert bench.operator.intent is before
    assert bench.operator.dropped.undriven == 1
    assert text.startswith("MANUAL_CONTROL of ")
    assert other.stick() == [], "not reported at the rate of a joystick"
    bench.now += 2 * SECOND
    assert texts(
        other.say(dialect.MAVLink_set_position_target_local_ned_message(0, 1, 1, 8, 1511, *(0.0,) * 11))
    )
    assert bench.operator.intent is before


@pytest.mark.parametrize("row", [row for row in ROWS if not row.anyone], ids=lambda row: str(row.command))
def test_words_of_anybody_else_are_refused(bench: RarsBench, driver: Hand, row: object) -> None:
    before = bench.operator.intent
    other = Hand(driver.bench, THERE)
    assert other.result(row.command, 1, 1, 1) == DENIED  # type: ignore[attr-defined] # a row
    assert bench.requested == []
    assert bench.operator.intent is before


@pytest.mark.parametrize(("command", "params"), [(ARM, (1,)), (ARM, (0,)), (CLEAR, (1,)), (PAUSE, (0,))])
def test_arming_clearing_and_pausing_are_the_drivers(
    bench: RarsBench, other: Hand, command: int, params: tuple[float, ...]
) -> None:
    replies = other.order(command, *params)
    assert (types(replies)[-1], replies[-1].result) == ("COMMAND_ACK", DENIED)
    assert "255/190 at 10.0.0.1:14550 is in control" in "".join(texts(replies))
    assert bench.requested == []


def test_a_parameter_is_the_drivers(bench: RarsBench, other: Hand) -> None:
    replies = other.say(dialect.MAVLink_param_set_message(1, 1, b"RATE_ODOM", 1.0, 9))
    assert replies[-1].param_value == 20.0
    assert "in control" in "".join(texts(replies))
    assert bench.operator.dropped.undriven == 0


def test_anybody_may_read(other: Hand) -> None:
    assert other.result(512, 148) == ACCEPTED
    assert types(other.say(dialect.MAVLink_ping_message(1, 2, 0, 0))) == ["PING"]


@pytest.mark.parametrize(
    ("command", "params"), [(STOP, (1,)), (CLEAR, (0,)), (ARM, (0, FORCE))], ids=["terminate", "safe", "kill"]
)
def test_an_emergency_stop_is_anybodys_and_one_that_can_be_cleared(
    bench: RarsBench, other: Hand, command: int, params: tuple[float, ...]
) -> None:
    replies = other.order(command, *params)
    assert replies[-1].result == ACCEPTED
    assert bench.requested == [EmergencyStop()]
    assert "emergency stop by" in "".join(texts(bench.report()))


def test_a_stop_button_is_anybodys(bench: RarsBench, other: Hand) -> None:
    other.stick(0x7FFE, buttons=4)
    assert bench.requested == [EmergencyStop()]
    assert bench.operator.intent.received_at == bench.now


def test_each_station_counts_its_own_frames(bench: RarsBench) -> None:
    first, second = Hand(bench, HERE), Hand(bench, THERE)
    for _ in range(100):
        first.stick()
    second.stick(500)
    assert bench.command.speed_mps == 0.25
    assert bench.operator.dropped.overtaken == 0


def test_the_arming_stations_own_stick_is_judged(bench: RarsBench) -> None:
    first, second = Hand(bench, HERE), Hand(bench, THERE)
    second.stick()
    bench.now += 50 * MILLISECOND
    first.stick(1000)
    second.result(ARM, 1)
    assert (bench.command.speed_mps, bench.operator.intent.neutral) == (0.0, True)


def test_a_deflected_stick_of_who_arms_counts_until_it_is_gone(bench: RarsBench) -> None:
    hand = Hand(bench, HERE)
    for ago, neutral in ((10 * SECOND - 1, False), (10 * SECOND, True)):
        hand.stick(1000)
        bench.now += ago
        hand.order(ARM, 1)
        assert bench.operator.intent.neutral is neutral
        hand.order(CONTROL, 0)
        assert bench.operator.intent.neutral


def test_control_is_requested_and_given_up(bench: RarsBench) -> None:
    hand = Hand(bench, HERE)
    assert hand.result(CONTROL, 1) == ACCEPTED
    assert drives(bench) == (HERE, 255, 190)
    assert hand.result(CONTROL, 1) == ACCEPTED
    assert bench.requested == [ChangeDriver()], "requested once more, nothing changes"
    assert hand.result(CONTROL, 0) == ACCEPTED
    assert drives(bench) is None
    assert bench.requested == [ChangeDriver(), Disarm(), ChangeDriver()]
    assert hand.result(CONTROL, 0) == DENIED
    bench.report()
    assert "control: 255/190 at 10.0.0.1:14550 has released it, no station in control" in reported(bench)


@pytest.mark.parametrize(
    ("params", "then"),
    [((1, 0), FAILED), ((1, 1), ACCEPTED), ((0, 1, 0), FAILED), ((0, 1, 1), ACCEPTED)],
    ids=["of 2026", "of 2026, yielding", "of 2025", "of 2025, yielding"],
)
def test_both_ways_to_say_it(bench: RarsBench, params: tuple[float, ...], then: int) -> None:
    Hand(bench, HERE).order(CONTROL, *params)
    assert drives(bench) == (HERE, 255, 190)
    assert Hand(bench, THERE).result(CONTROL, 1) == then


@pytest.mark.parametrize("params", [(2,), (float("nan"),), (0, 2), (0.5, 1)])
def test_what_is_neither_is_denied(bench: RarsBench, params: tuple[float, ...]) -> None:
    assert Hand(bench, HERE).result(CONTROL, *params) == DENIED
    assert drives(bench) is None


def test_a_request_is_refused_and_brought_to_who_drives(bench: RarsBench, other: Hand, driver: Hand) -> None:
    [ack] = other.order(CONTROL, 1)
    [requested] = [one for one in bench.report() if one.get_type() == "COMMAND_LONG"]
    assert "requests it" in reported(bench)
    assert (requested.command, requested.target_system, requested.target_component) == (CONTROL, 255, 190)
    assert (requested.param1, requested.param4) == (1.0, float(other.codec.system))
    assert (ack.command, ack.result) == (CONTROL, FAILED)
    other.order(CONTROL, 1)
    assert "COMMAND_LONG" not in types(bench.report()), "not at the rate of its requests"
    assert drives(bench) == (driver.source, 255, 190)


def test_control_is_handed_over_to_who_requests(bench: RarsBench, other: Hand, driver: Hand) -> None:
    driver.order(CONTROL, 1, 1)
    assert other.result(CONTROL, 1) == ACCEPTED
    assert drives(bench) == (other.source, other.codec.system, other.codec.component)
    assert bench.requested == [ChangeDriver()]
    assert (bench.command.speed_mps, bench.operator.intent.received_at) == (0.0, NEVER_RECEIVED)
    assert driver.result(ARM, 0) == DENIED


def test_a_lamp_stays_lit_when_control_changes(bench: RarsBench, driver: Hand) -> None:
    driver.order(RELAY, 1, 1)
    driver.order(CONTROL, 1, 1)
    Hand(bench, THERE).order(CONTROL, 1)
    assert bench.command.headlamp


def test_the_old_message_does_the_same(bench: RarsBench) -> None:
    first, second = Hand(bench, HERE), Hand(bench, THERE)
    requests = dialect.MAVLink_change_operator_control_message(1, 0, 0, b"")
    gives = dialect.MAVLink_change_operator_control_message(1, 1, 0, b"")
    for hand, message, ack in (
        (first, requests, 0),
        (second, requests, 3),
        (second, gives, 3),
        (first, gives, 0),
        (second, requests, 0),
    ):
        answer = hand.say(message)[-1]
        assert (answer.get_type(), answer.ack) == ("CHANGE_OPERATOR_CONTROL_ACK", ack)
    assert drives(bench) == (THERE, 255, 190)


@pytest.mark.parametrize(("silence", "lost"), [(LAPSES_AFTER - 1, False), (LAPSES_AFTER, True)])
def test_who_sends_nothing_loses_control(bench: RarsBench, driver: Hand, silence: int, *, lost: bool) -> None:
    bench.now += silence
    assert bench.operator.lapse(bench.now) is lost
    assert (drives(bench) is None) is lost
    bench.report()
    assert ("is gone, no station in control" in reported(bench)) is lost
    assert (bench.operator.intent.received_at == NEVER_RECEIVED) is lost
    assert driver.result(ARM, 1) == ACCEPTED


def test_any_good_frame_keeps_control_and_that_of_another_does_not(bench: RarsBench, driver: Hand) -> None:
    beat = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
    bench.now += LAPSES_AFTER - 1
    driver.say(beat)
    bench.now += LAPSES_AFTER - 1
    assert not bench.operator.lapse(bench.now)
    Hand(bench, THERE).say(beat)
    bench.now += 1
    assert bench.operator.lapse(bench.now)


@pytest.mark.parametrize(
    ("interval_us", "result"), [(-1, ACCEPTED), (50_000, ACCEPTED), (0, ACCEPTED), (49_999, DENIED)]
)
def test_who_does_not_drive_is_reported_no_more_often_than_others(
    bench: RarsBench, driver: Hand, interval_us: int, result: int
) -> None:
    assert driver.result(INTERVAL, 331, 20_000) == ACCEPTED
    assert Hand(bench, THERE).result(INTERVAL, 331, interval_us) == result


def test_at_the_drivers_own_place_no_one_else_sets_intervals(bench: RarsBench, driver: Hand) -> None:
    assert Hand(bench, driver.source, 254).result(INTERVAL, 331, -1) == DENIED


def test_foreign_nodes_do_not_fill_the_memory_nor_push_the_driver_out(bench: RarsBench, driver: Hand) -> None:
    for place in range(3 * MOST_STATIONS):
        bench.now += 1
        Hand(bench, place + 1).stick()
    bench.now += MILLISECOND
    driver.stick(200)
    assert bench.command.speed_mps == pytest.approx(0.1)
    assert len(bench.operator.stations.of) <= MOST_STATIONS
    assert next(iter(bench.operator.stations.of)) == bench.operator.driver, "remembered from the first"


def test_while_no_one_drives_anybody_clears_and_arms(bench: RarsBench) -> None:
    bench.facts = replace(bench.facts, emergency_stopped=True)
    assert Hand(bench, HERE).result(CLEAR, 1) == ACCEPTED
    assert Hand(bench, THERE).result(ARM, 1) == ACCEPTED
    assert bench.requested == [ClearEmergencyStop(), Arm()]
    assert drives(bench) == (THERE, 255, 190)


def test_a_drivers_own_stick_that_he_left_deflected_is_gone_in_time(bench: RarsBench, driver: Hand) -> None:
    bench.facts = replace(bench.facts, armed=False)
    bench.report()
    for ago, neutral in ((9 * SECOND, False), (SECOND, True)):
        bench.now += ago
        driver.order(ARM, 1)
        bench.facts = replace(bench.facts, armed=False)
        bench.report()
        assert bench.operator.intent.neutral is neutral


def test_control_that_changes_all_the_time_floods_no_one(bench: RarsBench) -> None:
    hand = Hand(bench, HERE)
    for _ in range(500):
        hand.order(CONTROL, 1)
        hand.order(CONTROL, 0)
    assert len(texts(bench.report())) < 20
    hand.order(CONTROL, 1)
    assert "control: 255/190 at 10.0.0.1:14550 is in control" in texts(bench.report())[-1]


def test_the_old_set_mode_is_refused_in_words(other: Hand) -> None:
    replies = other.say(dialect.MAVLink_set_mode_message(1, 1, 0))
    assert replies[-1].result == DENIED
    assert "in control" in "".join(texts(replies))


def test_frames_for_another_robot_on_the_link_are_none_that_were_lost(bench: RarsBench) -> None:
    bench.order(400, 1)
    for cycle in range(300):
        bench.stick(target=1)
        for _other in range(3):
            bench.stick(target=2)
        bench.now = cycle * 50 * MILLISECOND
    assert in_control(bench).clocks.losses.share == 0.0


def test_a_station_that_calls_itself_as_the_robot_is_named_once(bench: RarsBench) -> None:
    namesake = Codec(1, 1)
    bench.say(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
    bench.send(namesake.encode(dialect.MAVLink_heartbeat_message(10, 0, 0, 0, 4, 3)))
    assert "as this robot" not in "".join(texts(bench.report())), "an echo of the robot's own"
    for _ in range(3):
        bench.send(namesake.encode(dialect.MAVLink_manual_control_message(1, 500, 0, 0, 0, 0)))
    stated = "".join(texts(bench.report()))
    assert stated.count("a station calls itself 1/1, as this robot: it is ignored; let it be system 255") == 1
    assert bench.command.speed_mps == 0.0
