"""What stations send beside commands: sticks, set-points, parameters, missions, time; and strangers."""

from __future__ import annotations

import math
import struct
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_bridge import robot as robots
from firmware_bridge.intent import NEVER_HEARD, Arm, ClearEmergencyStop, EmergencyStop, Intent, Verdict
from firmware_bridge.teleop.mavlink import Codec, dialect
from firmware_bridge.teleop.operator import Operator
from firmware_bridge.teleop.parameters import PARAMETERS
from firmware_bridge.units import MILLISECOND, SECOND

if TYPE_CHECKING:
    from hil_tests.unit.teleop.conftest import Bench

RARS = robots.find("rars")


def types(messages: list[Any]) -> list[str]:
    return [one.get_type() for one in messages]


def texts(messages: list[Any]) -> list[str]:
    return [one.text for one in messages if one.get_type() == "STATUSTEXT"]


def zeros(count: int) -> str:
    return "00 " * count


# Station 255/190 asks, robot 1/1 answers with its first frame; made with pymavlink 2.4.50's `all` dialect.
EXCHANGES = {
    "arm": (
        f"FD 20 00 00 00 FF BE 4C 00 00 00 00 80 3F {zeros(24)} 90 01 01 01 9E 4E",
        "FD 0A 00 00 00 01 01 4D 00 00 90 01 00 00 00 00 00 00 FF BE 6A 53",
    ),
    "disarm by force": (
        f"FD 20 00 00 00 FF BE 4C 00 00 00 00 00 00 00 98 A5 46 {zeros(20)} 90 01 01 01 BC EA",
        "FD 0A 00 00 00 01 01 4D 00 00 90 01 00 00 00 00 00 00 FF BE 6A 53",
    ),
    "60 mm/s and 0.1 rad/s": (
        (
            f"FD 35 00 00 00 FF BE 54 00 00 E8 03 00 00 {zeros(12)} 8F C2 75 3D"
            f"{zeros(24)} CD CC CC 3D E7 05 01 01 08 2C 0A"
        ),
        "",
    ),
    "half speed, a quarter left": (
        "FD 0B 00 00 00 FF BE 45 00 00 F4 01 00 00 00 00 06 FF 00 00 01 BA 03",
        "",
    ),
    "heartbeat of the station": ("FD 09 00 00 00 FF BE 00 00 00 00 00 00 00 06 08 00 04 03 3D 48", ""),
}


@pytest.mark.parametrize(("asked", "answered"), EXCHANGES.values(), ids=EXCHANGES.keys())
def test_exchanges_byte_for_byte(bench: Bench, asked: str, answered: str) -> None:
    replies = bench.operator.hear(bytes.fromhex(asked), 0, bench.decide)
    assert b"".join(replies) == bytes.fromhex(answered)


def test_the_frames_of_the_two_set_points_mean_this(bench: Bench) -> None:
    bench.send(bytes.fromhex(EXCHANGES["half speed, a quarter left"][0]))
    intent = bench.operator.intent
    assert (intent.speed_mps, intent.steer_rad) == pytest.approx((0.25, math.radians(15.0)))
    bench.operator = Operator(RARS)
    bench.send(bytes.fromhex(EXCHANGES["60 mm/s and 0.1 rad/s"][0]))
    intent = bench.operator.intent
    # clockwise with R = 0.6 m: atan(0.515 / (0.6 - 0.105)) to the right
    assert (intent.speed_mps, math.degrees(intent.steer_rad)) == pytest.approx((0.06, -46.134), abs=1e-3)


def test_before_anybody_speaks_nothing_is_wanted(bench: Bench) -> None:
    assert bench.operator.intent == Intent()
    assert bench.operator.intent.heard_at == NEVER_HEARD


def test_a_stick_becomes_the_intent_and_its_time(bench: Bench) -> None:
    bench.now = 7 * SECOND
    assert bench.stick(x=500, r=-500) == []
    intent = bench.operator.intent
    assert (intent.speed_mps, intent.heard_at) == (0.25, 7 * SECOND)
    assert intent.steer_rad == pytest.approx(0.5236, abs=1e-4)


def test_a_set_point_at_standstill_keeps_the_steering(bench: Bench) -> None:
    bench.stick(r=-500)
    steer = bench.operator.intent.steer_rad
    bench.target(0.0, 0.3)
    assert bench.operator.intent.steer_rad == steer


def test_what_is_refused_changes_nothing_and_is_no_sign_of_life(bench: Bench) -> None:
    bench.stick(x=500)
    before = bench.operator.intent
    bench.now += SECOND
    assert texts(bench.target(float("nan")))
    assert texts(bench.stick(x=2000))
    assert texts(bench.target(0.2, frame=1))
    assert bench.operator.intent == before
    assert bench.operator.dropped.refused == 3


def test_refusals_are_not_told_at_the_rate_of_a_joystick(bench: Bench) -> None:
    told = 0
    for _ in range(100):
        told += bool(bench.target(0.2, frame=1))
        bench.now += 50 * MILLISECOND
    assert told == 3


def test_the_newest_of_two_stations_counts(bench: Bench) -> None:
    other = Codec(254, 190)
    bench.stick(x=500)
    bench.send(other.encode(dialect.MAVLink_manual_control_message(1, 100, 0x7FFF, 0, 0, 0)))
    assert bench.operator.intent.speed_mps == pytest.approx(0.05)
    bench.stick(x=-500)
    assert bench.operator.intent.speed_mps == pytest.approx(-0.25)


def test_an_overtaken_set_point_is_forgotten(bench: Bench) -> None:
    early = bench.station.encode(dialect.MAVLink_manual_control_message(1, 1000, 0, 0, 0, 0))
    bench.stick(x=0)
    bench.now += 20 * MILLISECOND
    bench.send(early)
    assert bench.operator.intent.speed_mps == 0.0
    assert bench.operator.dropped.overtaken == 1
    bench.send(early)
    assert bench.operator.dropped.overtaken == 2


def test_a_datagram_that_arrives_twice_is_one_sign_of_life(bench: Bench) -> None:
    twice = bench.station.encode(dialect.MAVLink_manual_control_message(1, 100, 0, 0, 0, 0))
    bench.send(twice)
    bench.now += 20 * MILLISECOND
    bench.send(twice)
    assert bench.operator.intent.heard_at == 0
    assert bench.operator.dropped.overtaken == 1


def test_a_station_that_starts_anew_is_heard_after_a_quarter_of_a_second(bench: Bench) -> None:
    for _ in range(100):
        bench.stick()
    bench.station = Codec(255, 190)
    bench.now += 249 * MILLISECOND
    bench.stick(x=100)
    assert bench.operator.intent.speed_mps == 0.0
    bench.now += 1 * MILLISECOND
    bench.stick(x=100)
    assert bench.operator.intent.speed_mps == pytest.approx(0.05)


def test_an_overtaken_stop_button_still_stops(bench: Bench) -> None:
    early = bench.station.encode(dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, 4))
    bench.stick()
    bench.send(early)
    assert bench.asked == [EmergencyStop()]


def test_a_stop_button_on_a_broken_stick_still_stops(bench: Bench) -> None:
    bench.stick(x=0x7FFE, buttons=4)
    assert bench.asked == [EmergencyStop()]


def test_the_stop_button_asks_until_the_robot_is_stopped_and_not_on(bench: Bench) -> None:
    bench.report()
    bench.stick(buttons=4)
    bench.stick(buttons=4)
    assert len(bench.asked) == 2
    bench.report()
    bench.stick(buttons=4)
    assert len(bench.asked) == 2


def test_buttons_switch_when_they_go_down(bench: Bench) -> None:
    seen = []
    for buttons in (0, 1, 1, 0, 2, 3, 0, 3):
        bench.stick(buttons=buttons)
        seen.append((bench.operator.intent.detector, bench.operator.intent.headlamp))
    assert seen == [
        (False, False), (True, False), (True, False), (True, False),
        (True, True), (False, True), (False, True), (True, False),
    ]  # fmt: skip


def test_a_button_that_is_down_from_the_start_switches_nothing(bench: Bench) -> None:
    bench.stick(buttons=3)
    assert (bench.operator.intent.detector, bench.operator.intent.headlamp) == (False, False)


def test_the_lifts_stick_takes_over_from_its_target_and_not_before(bench: Bench) -> None:
    bench.order(400, 1)
    bench.report()
    bench.order(187, 0)
    seen = []
    for buttons in (0, 8, 0):
        bench.stick(z=500, buttons=buttons)
        intent = bench.operator.intent
        seen.append((intent.lift_m is not None, round(intent.lift_rate_mps, 6)))
    assert seen == [(True, 0.0), (False, 0.05), (False, 0.0)]


@pytest.mark.parametrize("target", [0, 1])
def test_sticks_for_us(bench: Bench, target: int) -> None:
    bench.stick(x=100, target=target)
    assert bench.operator.intent.speed_mps > 0.0


def test_sticks_for_others(bench: Bench) -> None:
    bench.stick(x=100, target=2)
    assert bench.operator.intent == Intent()
    assert bench.operator.dropped.foreign == 1


def test_our_own_words_come_back_unheard(bench: Bench) -> None:
    echo = Codec(1, 1).encode(dialect.MAVLink_command_long_message(0, 0, 400, 0, 1, 0, 0, 0, 0, 0, 0))
    assert bench.send(echo) == []
    assert bench.asked == []
    assert bench.operator.dropped.echoed == 1


def test_several_messages_in_one_datagram_are_heard_in_order(bench: Bench) -> None:
    encode = bench.station.encode
    first = encode(dialect.MAVLink_manual_control_message(1, 100, 0, 0, 0, 0))
    second = encode(dialect.MAVLink_command_long_message(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0))
    third = encode(dialect.MAVLink_manual_control_message(1, 200, 0, 0, 0, 0))
    assert types(bench.send(first + b"noise" + second + third)) == ["COMMAND_ACK"]
    assert bench.operator.intent.speed_mps == pytest.approx(0.1)
    assert bench.operator.counters.corrupt == 1


def test_qgroundcontrol_gets_through_its_connection(bench: Bench) -> None:
    bench.report()
    version, ack = bench.order(512, 148)
    assert (version.get_type(), ack.result) == ("AUTOPILOT_VERSION", 0)
    for modes_or_metadata in (435, 397):
        [ack] = bench.order(512, modes_or_metadata)
        assert ack.result == 3
    assert bench.say(dialect.MAVLink_param_request_list_message(1, 1)) == []
    asked_at = bench.now
    first = [one for one in bench.report() if one.get_type() == "PARAM_VALUE"]
    assert first
    assert bench.now - asked_at <= 100 * MILLISECOND
    [count] = bench.say(dialect.MAVLink_mission_request_list_message(1, 1))
    assert (count.get_type(), count.count) == ("MISSION_COUNT", 0)


def test_mavsdk_learns_the_version_before_the_first_report(bench: Bench) -> None:
    assert types(bench.order(512, 148)) == ["AUTOPILOT_VERSION", "COMMAND_ACK"]


def test_parameters_are_listed_once_each_and_slowly(bench: Bench) -> None:
    bench.say(dialect.MAVLink_param_request_list_message(1, 1))
    cycles = [[one for one in bench.report() if one.get_type() == "PARAM_VALUE"] for _ in range(10)]
    assert max(map(len, cycles)) <= 6
    listed = [one for cycle in cycles for one in cycle]
    assert [one.param_index for one in listed] == list(range(len(PARAMETERS)))
    assert [one.param_id for one in listed] == [row.name for row in PARAMETERS]
    assert {one.param_count for one in listed} == {len(PARAMETERS)}
    assert {one.param_type for one in listed} == {9}


def test_a_list_asked_for_again_begins_again(bench: Bench) -> None:
    bench.say(dialect.MAVLink_param_request_list_message(1, 1))
    bench.report()
    bench.say(dialect.MAVLink_param_request_list_message(1, 1))
    listed = [one.param_index for _ in range(10) for one in bench.report() if one.get_type() == "PARAM_VALUE"]
    assert listed == list(range(len(PARAMETERS)))


def test_parameter_names_fit_and_are_distinct() -> None:
    names = [row.name for row in PARAMETERS]
    assert len(set(names)) == len(names)
    assert all(1 <= len(name) <= 16 for name in names)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("WHEEL_R", 0.05),
        ("SPD_MAX", 0.5),
        ("STR_MAX", 60.0),
        ("RAD_MIN", 0.415),
        ("CMD_TMO", 0.5),
        ("ACC_MAX", 1.41264),
    ],
)
def test_a_parameter_is_read_by_name_and_by_index(bench: Bench, name: str, value: float) -> None:
    [by_name] = bench.say(dialect.MAVLink_param_request_read_message(1, 1, name.encode(), -1))
    assert by_name.param_value == pytest.approx(value)
    [by_index] = bench.say(dialect.MAVLink_param_request_read_message(1, 1, b"", by_name.param_index))
    assert by_index.param_id == name


@pytest.mark.parametrize(
    ("name", "index"), [("NO_SUCH", -1), ("", -1), ("WHEEL_R", len(PARAMETERS)), ("WHEEL_R", -2)]
)
def test_an_unknown_parameter_is_an_error(bench: Bench, name: str, index: int) -> None:
    [error] = bench.say(dialect.MAVLink_param_request_read_message(1, 1, name.encode(), index))
    assert (error.get_type(), error.error, error.param_id) == ("PARAM_ERROR", 1, name)
    assert (error.target_system, error.target_component) == (255, 190)


def set_parameter(bench: Bench, name: str, value: float) -> list[Any]:
    return bench.say(dialect.MAVLink_param_set_message(1, 1, name.encode(), value, 9))


@pytest.mark.parametrize("row", [row for row in PARAMETERS if row.writable is None], ids=lambda row: row.name)
def test_a_limit_cannot_be_changed_from_afar(bench: Bench, row: Any) -> None:
    replies = set_parameter(bench, row.name, 99.0)
    [value] = [one for one in replies if one.get_type() == "PARAM_VALUE"]
    assert value.param_value == struct.unpack("<f", struct.pack("<f", row.first(bench.robot)))[0]
    assert any("read-only" in text for text in texts(replies))


@pytest.mark.parametrize("wrong", [20.1, -0.1, float("nan"), float("inf"), -float("inf")])
def test_a_rate_out_of_range_is_answered_with_the_old_value(bench: Bench, wrong: float) -> None:
    replies = set_parameter(bench, "RATE_ODOM", wrong)
    [value] = [one for one in replies if one.get_type() == "PARAM_VALUE"]
    assert value.param_value == 20.0
    assert any("0 to 20 Hz" in text for text in texts(replies))


@pytest.mark.parametrize(("rate", "messages"), [(20.0, 20), (5.0, 1 + 5), (0.0, 0)])
def test_a_rate_is_set_and_kept(bench: Bench, rate: float, messages: int) -> None:
    [value] = set_parameter(bench, "RATE_ODOM", rate)
    assert value.param_value == rate
    assert sum(one.get_type() == "ODOMETRY" for _ in range(20) for one in bench.report()) == messages


def test_a_name_goes_up_to_its_first_nul(bench: Bench) -> None:
    [value] = bench.say(dialect.MAVLink_param_request_read_message(1, 1, b"SPD_MAX\0junk", -1))
    assert value.param_id == "SPD_MAX"


@pytest.mark.parametrize("kind", [0, 1, 2, 255])
def test_there_is_no_mission(bench: Bench, kind: int) -> None:
    [count] = bench.say(dialect.MAVLink_mission_request_list_message(1, 1, kind))
    assert (count.count, count.mission_type, count.target_system) == (0, kind, 255)
    [ack] = bench.say(dialect.MAVLink_mission_count_message(1, 1, 5, kind))
    assert (ack.get_type(), ack.type, ack.mission_type) == (
        "MISSION_ACK",
        dialect.MAV_MISSION_UNSUPPORTED,
        kind,
    )
    [ack] = bench.say(dialect.MAVLink_mission_clear_all_message(1, 1, kind))
    assert ack.type == dialect.MAV_MISSION_ACCEPTED
    for request in (dialect.MAVLink_mission_request_message, dialect.MAVLink_mission_request_int_message):
        [ack] = bench.say(request(1, 1, 0, kind))
        assert ack.type == dialect.MAV_MISSION_INVALID_SEQUENCE


def test_clocks_are_compared(bench: Bench) -> None:
    bench.now = 123_456_789
    [reply] = bench.say(dialect.MAVLink_timesync_message(0, 987))
    assert (reply.tc1, reply.ts1) == (123_456_789, 987)
    assert bench.say(dialect.MAVLink_timesync_message(5, 987)) == []
    bench.now = 0
    [reply] = bench.say(dialect.MAVLink_timesync_message(0, 987))
    assert reply.tc1 != 0


def test_a_ping_is_answered_and_an_answer_is_not(bench: Bench) -> None:
    [reply] = bench.say(dialect.MAVLink_ping_message(11, 7, 0, 0))
    assert (reply.time_usec, reply.seq, reply.target_system, reply.target_component) == (11, 7, 255, 190)
    assert bench.say(dialect.MAVLink_ping_message(11, 7, 1, 1)) == []


ADDRESSED = [number for number, kind in dialect.mavlink_map.items() if number < 20_000]


@given(
    st.lists(
        st.tuples(
            st.sampled_from(sorted(ADDRESSED)), st.binary(min_size=1, max_size=255), st.binary(max_size=5)
        ),
        max_size=5,
    )
)
@settings(max_examples=300)
def test_whatever_strangers_send_is_answered_without_an_exception(
    frames: list[tuple[int, bytes, bytes]],
) -> None:
    operator = Operator(RARS)
    datagram = b""
    for number, payload, junk in frames:
        body = bytes([len(payload), 0, 0, 0, 255, 190]) + number.to_bytes(3, "little") + payload
        crc = dialect.x25crc(body)
        crc.accumulate(bytes([dialect.mavlink_map[number].crc_extra]))
        datagram += b"\xfd" + body + crc.crc.to_bytes(2, "little") + junk
    station = Codec(255, 190)
    for reply in operator.hear(datagram, 5, lambda _: Verdict(accepted=False, reason="no")):
        [_] = station.decode(reply)


floats = st.floats(width=32)


@given(
    st.sampled_from([400, 185, 5300, 187, 181, 405, 512, 520, 511, 510, 176, 179, 246, 21]),
    st.tuples(*[floats] * 7),
)
@settings(max_examples=300)
def test_every_command_has_exactly_one_answer(command: int, params: tuple[float, ...]) -> None:
    operator, station = Operator(RARS), Codec(255, 190)
    order = station.encode(dialect.MAVLink_command_long_message(1, 1, command, 0, *params))
    replies = operator.hear(order, 5, lambda _: Verdict(accepted=True, reason=""))
    answers = [message for reply in replies for message in station.decode(reply)]
    assert [one.command for one in answers if one.get_type() == "COMMAND_ACK"] == [command]


def test_arming_and_clearing_take_the_lifts_target_away(bench: Bench) -> None:
    for command, params, request in ((400, (1,), Arm), (5300, (1,), ClearEmergencyStop)):
        bench.snapshot = replace(bench.snapshot, armed=True)
        bench.report()
        bench.order(187, 0)
        assert bench.operator.intent.lift_m is not None
        bench.order(command, *params)
        assert isinstance(bench.asked[-1], request)
        assert bench.operator.intent.lift_m is None
