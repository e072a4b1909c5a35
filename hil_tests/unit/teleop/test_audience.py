"""Receivers of messages: telemetry to stations, answers to the requester, nothing for a forged address."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_bridge.mavlink.audience import LAPSES_AFTER, LARGEST_CREDIT, MOST_PLACES, MOST_STATIONS
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.wire.internet import number_of
from hil_tests.lanes import examples
from hil_tests.unit.teleop.bench import CYCLE, RarsBench, rars
from hil_tests.unit.teleop.stations import ARM, CONTROL, Hand

if TYPE_CHECKING:
    from firmware_bridge.packet import Packet

BEAT = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
STICK = dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, 0)
PLACES = [number_of("10.0.0.1", port) for port in range(1, 60)]


def cycle(bench: RarsBench) -> tuple[Packet, ...]:
    """Let a cycle pass; return what is sent."""
    bench.now += CYCLE
    return bench.operator.report(bench.snapshot(), (), bench.now)


def reported(bench: RarsBench) -> set[int]:
    """Return the places that telemetry goes to, beside the one end of a link that has no other."""
    return {packet.address for packet in cycle(bench)} - {0}


def receives(
    bench: RarsBench, source: int, *messages: object, codec: Codec | None = None
) -> tuple[Packet, ...]:
    codec = codec or Codec(255, 190)
    datagram = b"".join(codec.encode(message) for message in messages)
    return bench.operator.receive(datagram, bench.now, bench.decide, source)


@pytest.mark.parametrize(
    "datagram",
    [
        b"\xfd garbage",
        b"",
        b"\xfd" * 5000,
        Codec(255, 190).encode(dialect.MAVLink_command_long_message(2, 1, 512, 0, 148, *(0.0,) * 6)),
        Codec(1, 1).encode(BEAT),
    ],
    ids=["garbage", "nothing", "much garbage", "for another", "our own"],
)
def test_what_is_no_good_frame_for_us_is_answered_with_nothing(bench: RarsBench, datagram: bytes) -> None:
    assert bench.operator.receive(datagram, 0, bench.decide, PLACES[0]) == ()
    assert reported(bench) == set()


def test_a_frame_makes_no_station_and_a_heartbeat_does(bench: RarsBench) -> None:
    receives(bench, PLACES[0], STICK)
    assert reported(bench) == set()
    receives(bench, PLACES[0], BEAT)
    assert reported(bench) == {PLACES[0]}


@pytest.mark.parametrize("keeps", [BEAT, STICK])
@pytest.mark.parametrize(("silence", "expected"), [(LAPSES_AFTER - 1, {PLACES[0]}), (LAPSES_AFTER, set())])
def test_a_station_lapses_unless_it_is_received(
    bench: RarsBench, keeps: object, silence: int, expected: set[int]
) -> None:
    receives(bench, PLACES[0], BEAT)
    bench.now += LAPSES_AFTER - 1
    receives(bench, PLACES[0], keeps)
    bench.now += silence - CYCLE
    assert reported(bench) == expected


def test_there_are_so_many_stations_and_a_place_is_free_when_one_lapses(bench: RarsBench) -> None:
    for source in PLACES[: MOST_STATIONS + 1]:
        receives(bench, source, BEAT)
    assert reported(bench) == set(PLACES[:MOST_STATIONS])
    bench.now += LAPSES_AFTER
    receives(bench, PLACES[20], BEAT)
    assert reported(bench) == {PLACES[20]}


def test_who_drives_is_reported_however_many_others_there_are(bench: RarsBench) -> None:
    for source in PLACES[:40]:
        receives(bench, source, BEAT)
    driver = Hand(bench, PLACES[50])
    assert PLACES[50] not in reported(bench)
    assert driver.result(ARM, 1) == 0
    for _ in range(40):
        for source in PLACES[:40]:
            receives(bench, source, BEAT, STICK)
        assert PLACES[50] in reported(bench)
    assert len(reported(bench)) == MOST_STATIONS + 1
    driver.result(CONTROL, 0)
    assert PLACES[50] not in reported(bench)


def test_each_station_receives_a_sequence_without_gaps(bench: RarsBench) -> None:
    counts: dict[int, list[int]] = {source: [] for source in PLACES[:3]}
    for source in PLACES[:2]:
        receives(bench, source, BEAT)
    for turn in range(20):
        sent = (
            *cycle(bench),
            *receives(bench, PLACES[turn % 3], dialect.MAVLink_ping_message(1, turn, 0, 0)),
        )
        for packet in sent:
            if packet.address in counts:
                counts[packet.address].append(packet.payload[4])
    for source in PLACES[:2]:
        first = counts[source][0]
        assert counts[source] == [(first + place) & 0xFF for place in range(len(counts[source]))]


def test_an_answer_goes_to_who_requested(bench: RarsBench) -> None:
    for source in PLACES[:2]:
        receives(bench, source, BEAT)
    [answer] = receives(bench, PLACES[1], dialect.MAVLink_ping_message(1, 2, 0, 0))
    assert answer.address == PLACES[1]


def test_an_acknowledgement_goes_before_a_text_where_one_alone_is_paid_for(bench: RarsBench) -> None:
    order = dialect.MAVLink_command_long_message(1, 1, 400, 0, 2, *(0.0,) * 6)
    [answer] = receives(bench, PLACES[0], order)
    assert Codec(9, 9).decode(answer.payload)[0].get_type() == "COMMAND_ACK"


QUESTIONS = st.sampled_from(
    [
        dialect.MAVLink_command_long_message(1, 1, 512, 0, number, *(0.0,) * 6)
        for number in (148, 331, 0, 1, 32, 147)
    ]
    + [dialect.MAVLink_command_long_message(1, 1, 400, 0, 2, *(0.0,) * 6), STICK]
    + [dialect.MAVLink_param_request_list_message(1, 1), dialect.MAVLink_timesync_message(0, 5)]
    + [dialect.MAVLink_param_request_read_message(1, 1, b"CYCLE", -1)]
)


@given(st.lists(st.tuples(st.integers(0, 100), st.lists(QUESTIONS, max_size=6)), max_size=40))
@settings(max_examples=examples(100))
def test_no_place_that_is_no_station_gets_more_bytes_than_it_sent(
    requested: list[tuple[int, list[object]]],
) -> None:
    bench = rars()
    paid: dict[int, int] = {}
    for place, messages in requested:
        codec = Codec(255, 190)
        datagram = b"".join(codec.encode(message) for message in messages)
        paid[place + 1] = paid.get(place + 1, 0) + len(datagram)
        sent = (*bench.operator.receive(datagram, bench.now, bench.decide, place + 1), *cycle(bench))
        for packet in sent:
            if packet.address:
                paid[packet.address] -= len(packet.payload)
    assert all(left >= 0 for left in paid.values())


def test_the_memory_of_foreign_nodes_is_bounded_and_so_is_their_credit(bench: RarsBench) -> None:
    for source in range(1, 3 * MOST_PLACES):
        receives(bench, source, STICK)
    for _ in range(200):
        receives(bench, 1, STICK)
    ping = dialect.MAVLink_command_long_message(1, 1, 512, 0, 331, *(0.0,) * 6)
    bench.report()
    answers = b"".join(packet.payload for packet in receives(bench, 1, *[ping] * 20))
    assert len(answers) <= LARGEST_CREDIT


@pytest.mark.parametrize(("others", "kept"), [(MOST_PLACES - 1, True), (MOST_PLACES, False)])
def test_so_many_places_keep_their_credit(bench: RarsBench, others: int, *, kept: bool) -> None:
    receives(bench, 1, *[STICK] * 20)
    for source in range(2, 2 + others):
        receives(bench, source, STICK)
    ping = dialect.MAVLink_command_long_message(1, 1, 512, 0, 331, *(0.0,) * 6)
    bench.report()
    answers = b"".join(packet.payload for packet in receives(bench, 1, ping))
    assert (len(answers) > 2 * len(Codec(255, 190).encode(ping))) is kept


def test_who_requests_the_list_all_the_time_does_not_keep_it_from_its_end(bench: RarsBench) -> None:
    driver, other = Hand(bench, PLACES[0]), Hand(bench, PLACES[1])
    driver.result(ARM, 1)
    bench.report()
    driver.say(dialect.MAVLink_param_request_list_message(1, 1))
    listed = []
    for _ in range(20):
        listed += [one.param_index for one in bench.report() if one.get_type() == "PARAM_VALUE"]
        other.say(dialect.MAVLink_param_request_list_message(1, 1))
    count = driver.say(dialect.MAVLink_param_request_read_message(1, 1, b"CYCLE", -1))[0].param_count
    assert set(listed) == set(range(count))
