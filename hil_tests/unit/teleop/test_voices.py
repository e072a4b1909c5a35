"""Messages to each place: in its version of MAVLink, and at the intervals that it requested."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from pymavlink.dialects.v10 import all as mavlink_1

from firmware_bridge.mavlink.frames import WITHOUT_EXTENSIONS, Codec, dialect
from firmware_bridge.mavlink.trust import Trust
from firmware_bridge.units import SECOND
from firmware_bridge.wire.internet import number_of
from hil_tests.rows import every
from hil_tests.unit.teleop.bench import CYCLE, rars
from hil_tests.unit.teleop.stations import ARM, FORCE, INTERVAL, Hand
from hil_tests.unit.teleop.timestamped import NOW

if TYPE_CHECKING:
    from hil_tests.unit.teleop.bench import RarsBench

HERE, THERE = number_of("10.0.0.1", 14550), number_of("10.0.0.2", 14550)
BEAT = mavlink_1.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 2)
SENT = {
    *(0, 1, 4, 22, 24, 30, 32, 33, 44, 47, 74, 76, 77, 109, 110, 111, 118, 120, 147, 148, 160, 175),
    *(242, 244, 245, 251, 252, 253, 6),
}
"""Numbers below 256 of all messages that this bridge sends."""


class Old:
    """A station that knows nothing but MAVLink 1, as pymavlink's own dialects of it read."""

    def __init__(self, bench: RarsBench, source: int = HERE) -> None:
        self.bench, self.source = bench, source
        self._words: Any = mavlink_1.MAVLink(None, srcSystem=255, srcComponent=190)
        self._words.robust_parsing = True

    def states(self, message: Any) -> list[Any]:
        frame = message.pack(self._words)
        self._words.seq = (self._words.seq + 1) & 0xFF
        return self.reads(self.bench.operator.receive(frame, self.bench.now, self.bench.decide, self.source))

    def reads(self, packets: Any) -> list[Any]:
        found: list[Any] = []
        for packet in packets:
            if packet.address == self.source:
                start, length, number = (packet.payload[place] for place in (0, 1, 5))
                assert start == 0xFE, "a frame of MAVLink 2"
                assert length == mavlink_1.mavlink_map[number].unpacker.size
                found += self._words.parse_buffer(bytearray(packet.payload)) or ()
        assert not [one for one in found if one.get_type() == "BAD_DATA"]
        return found

    def cycle(self) -> list[Any]:
        bench = self.bench
        bench.now += CYCLE
        bench.facts = replace(bench.facts, now=bench.now)
        return self.reads(bench.operator.report(bench.snapshot(), (), bench.now))

    def orders(self, command: int, *params: float) -> list[Any]:
        seven = (*params, *(0.0,) * (7 - len(params)))
        return self.states(mavlink_1.MAVLink_command_long_message(1, 1, command, 0, *seven))


@every("number", sorted(SENT))
def test_what_extensions_leave_of_a_message_is_what_mavlink_1_has(number: int) -> None:
    length = WITHOUT_EXTENSIONS.get(number, dialect.mavlink_map[number].unpacker.size)
    assert length == mavlink_1.mavlink_map[number].unpacker.size


def test_nothing_is_stated_whose_length_was_not_looked_up(bench: RarsBench) -> None:
    assert {row.number for row in bench.operator.streams if row.number < 256} <= SENT


def test_a_station_of_mavlink_1_is_reported_and_answered_in_it(bench: RarsBench) -> None:
    old = Old(bench)
    old.states(BEAT)
    received = Counter(one.get_type() for _ in range(100) for one in [*old.states(BEAT), *old.cycle()])
    assert received["HEARTBEAT"] in (5, 6)
    assert received["ATTITUDE"] == received["LOCAL_POSITION_NED"] == 100
    assert {"SYS_STATUS", "BATTERY_STATUS", "VFR_HUD", "NAMED_VALUE_FLOAT"} <= received.keys()
    assert not {"ODOMETRY", "WHEEL_DISTANCE", "CURRENT_MODE"} & received.keys(), "it has no numbers for them"


def test_it_arms_drives_and_stops(bench: RarsBench) -> None:
    old = Old(bench)
    old.states(BEAT)
    old.states(mavlink_1.MAVLink_manual_control_message(1, 0, 0, 0, 0, 0))
    [ack] = old.orders(ARM, 1.0)
    assert (ack.get_type(), ack.command, ack.result) == ("COMMAND_ACK", ARM, 0)
    old.states(mavlink_1.MAVLink_rc_channels_override_message(1, 1, *(0xFFFF, 0xFFFF, 2000), *(0xFFFF,) * 5))
    assert bench.command.speed_mps == 0.5
    [ack] = old.orders(ARM, 0.0, FORCE)
    assert ack.result == 0
    assert not bench.facts.armed
    version, ack = old.orders(512, 148)
    assert version.flight_sw_version >> 8 == 0x000100


def test_a_station_that_goes_over_to_mavlink_2_is_reported_in_it(bench: RarsBench) -> None:
    old = Old(bench)
    old.states(BEAT)
    assert old.cycle()
    new = Hand(bench, HERE)
    bench.now += CYCLE
    sent = [one for one in bench.operator.report(bench.snapshot(), (), bench.now) if one.address == HERE]
    assert {packet.payload[0] for packet in sent} == {0xFD}
    assert "ODOMETRY" in [one.get_type() for packet in sent for one in new.codec.decode(packet.payload)]


def test_two_stations_of_both_versions_each_receive_their_own_without_gaps(bench: RarsBench) -> None:
    old = Old(bench)
    new = Hand(bench, THERE)
    counts: dict[int, list[int]] = {HERE: [], THERE: []}
    for _ in range(60):
        old.states(BEAT)
        new.beats()
        bench.now += CYCLE
        for packet in bench.operator.report(bench.snapshot(), (), bench.now):
            if packet.address in counts:
                sequence = packet.payload[2] if packet.address == HERE else packet.payload[4]
                counts[packet.address].append(sequence)
    for numbers in counts.values():
        assert numbers == [(numbers[0] + place) & 0xFF for place in range(len(numbers))]
    assert len(counts[THERE]) > len(counts[HERE]) > 0


def test_a_foreign_node_of_mavlink_1_is_answered_in_it(bench: RarsBench) -> None:
    [pong] = Old(bench).states(mavlink_1.MAVLink_ping_message(11, 7, 0, 0))
    assert (pong.get_type(), pong.seq) == ("PING", 7)


def test_who_signs_what_he_states_sends_nothing_unsigned() -> None:
    bench = rars()
    bench.trust = Trust(key=bytes(range(32)), started_at=NOW)
    bench.restart()
    frame = Codec(255, 190).encode_1(dialect.MAVLink_command_long_message(1, 1, 185, 0, 1.0, *(0.0,) * 6))
    assert frame is not None
    sent = bench.operator.receive(frame, bench.now, bench.decide, HERE)
    assert [packet.payload[0] for packet in sent] == [0xFD] * len(sent)
    assert all(packet.payload[2] & 1 for packet in sent)


def counted(bench: RarsBench, hands: tuple[Hand, ...], cycles: int = 40) -> dict[int, Counter[str]]:
    """Let cycles pass; return each station's received messages."""
    received: dict[int, Counter[str]] = {hand.source: Counter() for hand in hands}
    for _ in range(cycles):
        bench.now += CYCLE
        bench.facts = replace(bench.facts, now=bench.now)
        for hand in hands:
            hand.beats()
        for packet in bench.operator.report(bench.snapshot(), (), bench.now):
            for hand in hands:
                if packet.address == hand.source:
                    received[hand.source].update(one.get_type() for one in hand.codec.decode(packet.payload))
    return received


def test_an_interval_is_that_of_the_station_that_requests(bench: RarsBench) -> None:
    first, second = Hand(bench, HERE), Hand(bench, THERE)
    assert first.result(INTERVAL, 331, 500_000) == 0
    assert second.result(INTERVAL, 30, -1) == 0
    received = counted(bench, (first, second))
    assert (received[HERE]["ODOMETRY"], received[HERE]["ATTITUDE"]) == (5, 40)  # the first at once
    assert (received[THERE]["ODOMETRY"], received[THERE]["ATTITUDE"]) == (40, 0)
    [reported, _] = first.order(510, 331)
    assert reported.interval_us == 500_000
    [reported, _] = second.order(510, 331)
    assert reported.interval_us == 50_000


def test_a_station_that_lapses_has_requested_nothing(bench: RarsBench) -> None:
    hand = Hand(bench, HERE)
    assert hand.result(INTERVAL, 331, -1) == 0
    bench.now += 6 * SECOND
    bench.report()
    hand.beats()
    assert counted(bench, (hand,))[HERE]["ODOMETRY"] == 40


def test_who_is_no_station_has_no_intervals(bench: RarsBench) -> None:
    ask = dialect.MAVLink_command_long_message(1, 1, INTERVAL, 0, 331.0, 20_000.0, *(0.0,) * 5)
    [answer] = bench.operator.receive(Codec(255, 190).encode(ask), bench.now, bench.decide, HERE)
    [ack] = Codec(9, 9).decode(answer.payload)
    assert (ack.command, ack.result) == (INTERVAL, 2)


def test_a_rate_that_is_a_parameter_is_that_of_all_who_have_requested_no_other(bench: RarsBench) -> None:
    first, second = Hand(bench, HERE), Hand(bench, THERE)
    second.result(INTERVAL, 331, 1_000_000)
    first.say(dialect.MAVLink_param_set_message(1, 1, b"RATE_ODOM", 10.0, 9))
    first.say(dialect.MAVLink_param_set_message(1, 1, b"RATE_ATT", 5.0, 9))
    received = counted(bench, (first, second))
    assert (received[HERE]["ODOMETRY"], received[THERE]["ODOMETRY"]) == (21, 3)  # the first at once
    assert (received[HERE]["ATTITUDE"], received[THERE]["ATTITUDE"]) == (11, 11)
