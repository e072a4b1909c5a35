"""Modes of control: their names and numbers, each station's request for them, and the valid inputs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.intent import EnterMode, Pause
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.mavlink.modes import ROWS, DrivingMode, in_px4, number_of, px4, requested
from firmware_bridge.units import MILLISECOND, SECOND
from firmware_bridge.wire.internet import number_of as place_at
from hil_tests.unit.teleop.bench import CYCLE, acks, target_message
from hil_tests.unit.teleop.received import texts, types
from hil_tests.unit.teleop.stations import CONTROL, Hand
from hil_tests.unit.teleop.toy import toy

if TYPE_CHECKING:
    from hil_tests.unit.teleop.bench import RarsBench

ACCEPTED, DENIED = 0, 2
MODE = 176
MANUAL, GUIDED, HOLD = 0, 15, 4
HERE, THERE = place_at("10.0.0.1", 14550), place_at("10.0.0.2", 14550)
# As MAVSDK 4.1 and pymavlink 2.4.50 ask: main mode and submode; DO_SET_MODE's parameters 2 and 3.
OF_PX4 = {
    (1, 0): DrivingMode.MANUAL,
    (2, 0): DrivingMode.MANUAL,
    (3, 0): DrivingMode.MANUAL,
    (6, 0): DrivingMode.GUIDED,
    (4, 3): DrivingMode.HOLD,
    (px4(1), 0): DrivingMode.MANUAL,
    (px4(6), 0): DrivingMode.GUIDED,
    (px4(4, 3), 0): DrivingMode.HOLD,
}
OF_ROVER = {(0, 0): DrivingMode.MANUAL, (15, 0): DrivingMode.GUIDED, (4, 0): DrivingMode.HOLD}
OF_NO_ONE = [
    (4, 2),
    (4, 4),
    (4, 5),
    (4, 6),
    (5, 0),
    (7, 0),
    (10, 0),
    (11, 0),
    (16, 0),
    (px4(9), 0),
    (2**40, 0),
]


@pytest.mark.parametrize(("numbers", "way"), [*OF_PX4.items(), *OF_ROVER.items()])
def test_a_way_is_requested_in_both_numberings(
    bench: RarsBench, numbers: tuple[int, int], way: DrivingMode
) -> None:
    assert acks(bench.order(MODE, 1, *numbers)) == [(MODE, ACCEPTED)]
    assert bench.requested == [Pause() if way is DrivingMode.HOLD else EnterMode("")]
    if way is not DrivingMode.HOLD:  # the bench's bridge pauses nothing
        rover, px4s = (MANUAL, px4(1)) if way is DrivingMode.MANUAL else (GUIDED, px4(6))
        assert reported_mode(bench) == (px4s if numbers in OF_PX4 else rover)


@pytest.mark.parametrize("numbers", OF_NO_ONE)
def test_any_other_is_denied_by_name_and_pauses(bench: RarsBench, numbers: tuple[int, int]) -> None:
    replies = bench.order(MODE, 1, *numbers)
    assert acks(replies) == [(MODE, DENIED)]
    assert "0 Manual, 15 Guided, 4 Hold; there are no others" in "".join(texts(replies))
    assert bench.requested == [Pause()]


def reported_mode(bench: RarsBench) -> int:
    mode: int = bench.reported(436).custom_mode
    return mode


def test_the_names_are_listed_all_at_once_or_one_alone(bench: RarsBench) -> None:
    listed = [one for one in bench.order(512, 435) if one.get_type() == "AVAILABLE_MODES"]
    assert [(one.mode_name, one.custom_mode) for one in listed] == [
        ("Manual", MANUAL),
        ("Guided", GUIDED),
        ("Hold", HOLD),
    ]
    [one, ack] = bench.order(512, 435, 2)
    assert (one.mode_name, one.mode_index, ack.result) == ("Guided", 2, ACCEPTED)
    assert acks(bench.order(512, 435, 4)) == [(512, 3)]


def test_the_robots_own_modes_are_listed_behind_them() -> None:
    listed = [one for one in toy().order(512, 435) if one.get_type() == "AVAILABLE_MODES"]
    assert [(one.mode_name, one.custom_mode) for one in listed[3:]] == [
        ("Without port", 20),
        ("Without boom", 21),
    ]
    assert {one.number_modes for one in listed} == {5}


def test_the_heartbeat_and_current_mode_report_the_way(bench: RarsBench) -> None:
    assert (bench.reported(0).base_mode, reported_mode(bench)) == (0x41, MANUAL)
    bench.order(MODE, 1, GUIDED)
    heartbeat = bench.reported(0)
    assert (heartbeat.base_mode, heartbeat.custom_mode, reported_mode(bench)) == (0x09, GUIDED, GUIDED)
    bench.facts = replace(bench.facts, paused=True)
    heartbeat = bench.reported(0)
    assert (heartbeat.base_mode, heartbeat.custom_mode, reported_mode(bench)) == (0x01, HOLD, HOLD)


def test_set_points_that_move_are_reported_as_guided_and_a_stick_as_manual(bench: RarsBench) -> None:
    bench.target(0.0)
    assert reported_mode(bench) == MANUAL
    bench.target(0.2)
    assert reported_mode(bench) == GUIDED
    bench.target(0.0)
    assert reported_mode(bench) == GUIDED
    bench.stick()
    assert reported_mode(bench) == MANUAL


def test_what_is_reported_of_arming_and_of_modes_does_not_wait(bench: RarsBench) -> None:
    bench.report()
    for _ in range(3):
        assert not {"HEARTBEAT", "CURRENT_MODE", "EXTENDED_SYS_STATE"} & set(types(bench.report()))
    bench.order(400, 1)
    received = bench.report()
    assert [one.base_mode for one in received if one.get_type() == "HEARTBEAT"] == [0xC1]
    assert [one.landed_state for one in received if one.get_type() == "EXTENDED_SYS_STATE"] == [2]
    bench.order(MODE, 1, GUIDED)
    received = bench.report()
    assert [one.custom_mode for one in received if one.get_type() == "HEARTBEAT"] == [GUIDED]
    assert [one.custom_mode for one in received if one.get_type() == "CURRENT_MODE"] == [GUIDED]
    assert "HEARTBEAT" not in types(bench.report())


def test_an_idle_stick_beside_set_points_counts_for_nothing_once_guided_was_requested(
    bench: RarsBench,
) -> None:
    bench.order(MODE, 1, GUIDED)
    bench.target(0.2)
    bench.now += CYCLE
    bench.stick()
    assert bench.command.speed_mps == pytest.approx(0.2)
    assert bench.operator.dropped.idle == 1
    assert bench.operator.intent.received_at == bench.now - CYCLE, "it is no sign of life either"


@pytest.mark.parametrize(("silence", "counts"), [(499, False), (500, True)])
def test_it_counts_again_when_the_set_points_cease(bench: RarsBench, silence: int, *, counts: bool) -> None:
    bench.order(MODE, 1, GUIDED)
    bench.target(0.2)
    bench.now += silence * MILLISECOND
    bench.stick()
    assert (bench.operator.intent.received_at == bench.now) is counts
    assert (bench.command.speed_mps == 0.0) is counts


def test_a_stick_that_is_moved_takes_over_and_its_letting_go_stops(bench: RarsBench) -> None:
    bench.order(MODE, 1, GUIDED)
    bench.target(0.2)
    bench.stick(x=-500)
    assert (bench.command.speed_mps, reported_mode(bench)) == (-0.25, MANUAL)
    bench.stick()
    assert bench.command.speed_mps == 0.0


def test_without_an_order_the_newest_word_counts_as_ever(bench: RarsBench) -> None:
    bench.target(0.2)
    bench.stick()
    assert bench.command.speed_mps == 0.0
    assert bench.operator.dropped.idle == 0


@pytest.mark.parametrize("ends", ["manual", "hold", "control"])
def test_guided_ends_by_another_order_and_by_another_driver(bench: RarsBench, ends: str) -> None:
    bench.order(MODE, 1, GUIDED)
    match ends:
        case "manual":
            bench.order(MODE, 1, MANUAL)
        case "hold":
            bench.order(MODE, 1, HOLD)
        case _:
            bench.order(CONTROL, 1)
    bench.target(0.2)
    bench.stick()
    assert bench.command.speed_mps == 0.0


def test_guided_leaves_the_robots_own_mode_as_it_is() -> None:
    bench = toy()
    bench.order(MODE, 1, 21)
    bench.report()
    bench.order(MODE, 1, GUIDED)
    assert bench.requested[-1] == EnterMode("without_boom")
    bench.order(MODE, 1, 0)
    assert bench.requested[-1] == EnterMode("")


def test_each_place_is_reported_in_the_numbers_that_it_requests_in(bench: RarsBench) -> None:
    rover, other = Hand(bench, HERE), Hand(bench, THERE)
    rover.order(MODE, 1, GUIDED)
    assert inputs_of(bench, other)["CURRENT_MODE"] == GUIDED
    other.order(MODE, 1, 6)
    seen = inputs_of(bench, other)
    assert (seen["HEARTBEAT"], seen["CURRENT_MODE"]) == (px4(6), px4(6))
    assert [one.custom_mode for one in other.order(512, 435)[:3]] == [px4(1), px4(6), px4(4, 3)]
    seen = inputs_of(bench, rover)
    assert (seen["HEARTBEAT"], seen["CURRENT_MODE"]) == (GUIDED, GUIDED)
    other.order(MODE, 1, MANUAL)
    assert inputs_of(bench, other)["HEARTBEAT"] == MANUAL


def inputs_of(bench: RarsBench, hand: Hand) -> dict[str, int]:
    """Let two seconds pass; return the newest mode of each message that goes to one station."""
    seen = {}
    for _ in range(2 * SECOND // CYCLE):
        bench.now += CYCLE
        bench.facts = replace(bench.facts, now=bench.now)
        for one in (HERE, THERE):
            Hand(bench, one)
        for packet in bench.operator.report(bench.snapshot(), (), bench.now):
            if packet.address == hand.source:
                for message in hand.codec.decode(packet.payload):
                    if hasattr(message, "custom_mode"):
                        seen[message.get_type()] = message.custom_mode
    return seen


def test_who_does_not_drive_changes_no_mode_and_not_his_numbers(bench: RarsBench) -> None:
    driver, other = Hand(bench, HERE), Hand(bench, THERE)
    driver.order(CONTROL, 1)
    bench.requested.clear()
    assert other.result(MODE, 1, 6) == DENIED
    assert bench.requested == []
    assert inputs_of(bench, other)["HEARTBEAT"] == MANUAL


@given(st.integers(0, 2**32 - 1), st.integers(0, 255), st.integers(1, 6))
def test_whatever_is_requested_is_one_of_the_rows_or_the_robots_own(main: int, sub: int, own: int) -> None:
    found = requested(main, sub, own)
    if found is not None:
        assert found.own is None or 0 <= found.own < own
        number = number_of(found.driving_mode, found.own or 0)
        assert requested(number, 0, own) is not None
        assert in_px4(number) >= 1 << 16
    assert requested(main, sub, own) == found


def test_rows_have_numbers_of_their_own() -> None:
    every: list[Any] = [number for row in ROWS for number in (row.number, row.px4, *row.also)]
    assert len(set(every)) == len(every)


def test_a_set_point_of_mavsdk_moves_it(bench: RarsBench) -> None:
    """Offboard.set_velocity_body: frame 8, mask 1479."""
    assert bench.say(target_message(0.2, 0.1, mask=1479)) == []
    assert bench.command.speed_mps == pytest.approx(0.2)
    assert dialect.MAV_FRAME_BODY_NED == 8
