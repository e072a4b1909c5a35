"""Exchanges with a station byte for byte, and further requests of a ground station as it connects."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.teleop.received import types

if TYPE_CHECKING:
    from hil_tests.unit.teleop.bench import RarsBench


def zeros(count: int) -> str:
    return "00 " * count


# Station 255/190 sends a request, robot 1/1 answers with its first frame; made with pymavlink 2.4.50's `all`
# dialect.
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


@pytest.mark.parametrize(("requested", "answered"), EXCHANGES.values(), ids=EXCHANGES.keys())
def test_exchanges_byte_for_byte(bench: RarsBench, requested: str, answered: str) -> None:
    replies = bench.operator.receive(bytes.fromhex(requested), 0, bench.decide)
    assert b"".join(reply.payload for reply in replies) == bytes.fromhex(answered)


def test_the_frames_of_the_two_set_points_mean_this(bench: RarsBench) -> None:
    bench.send(bytes.fromhex(EXCHANGES["half speed, a quarter left"][0]))
    assert bench.command.speed_mps == 0.25
    assert bench.command.steer_rad == pytest.approx(math.radians(15.0))
    bench.restart()
    bench.send(bytes.fromhex(EXCHANGES["60 mm/s and 0.1 rad/s"][0]))
    # clockwise with R = 0.6 m: atan(0.515 / (0.6 - 0.105)) to the right
    assert bench.command.speed_mps == pytest.approx(0.06)
    assert bench.command.steer_rad == pytest.approx(math.radians(-46.134), abs=1e-5)


def test_qgroundcontrol_gets_through_its_connection(bench: RarsBench) -> None:
    bench.report()
    version, ack = bench.order(512, 148)
    assert (version.get_type(), ack.result) == ("AUTOPILOT_VERSION", 0)
    *modes, ack = bench.order(512, 435)
    assert ([one.mode_name for one in modes], ack.result) == (["Manual", "Guided", "Hold"], 0)
    assert [(one.number_modes, one.mode_index) for one in modes] == [(3, 1), (3, 2), (3, 3)]
    [ack] = bench.order(512, 397)  # COMPONENT_METADATA
    assert ack.result == 3
    assert bench.say(dialect.MAVLink_param_request_list_message(1, 1)) == []
    requested_at = bench.now
    first = [one for one in bench.report() if one.get_type() == "PARAM_VALUE"]
    assert first
    assert bench.now - requested_at <= 100 * MILLISECOND
    [count] = bench.say(dialect.MAVLink_mission_request_list_message(1, 1))
    assert (count.get_type(), count.count) == ("MISSION_COUNT", 0)


def test_mavsdk_learns_the_version_before_the_first_report(bench: RarsBench) -> None:
    assert types(bench.order(512, 148)) == ["AUTOPILOT_VERSION", "COMMAND_ACK"]


@pytest.mark.parametrize("kind", [0, 1, 2, 255])
def test_there_is_no_mission(bench: RarsBench, kind: int) -> None:
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


def test_clocks_are_compared(bench: RarsBench) -> None:
    bench.now = 123_456_789
    [reply] = bench.say(dialect.MAVLink_timesync_message(0, 987))
    assert (reply.tc1, reply.ts1) == (123_456_789, 987)
    assert bench.say(dialect.MAVLink_timesync_message(5, 987)) == []
    bench.now = 0
    [reply] = bench.say(dialect.MAVLink_timesync_message(0, 987))
    assert reply.tc1 != 0


def test_a_ping_is_answered_and_an_answer_is_not(bench: RarsBench) -> None:
    [reply] = bench.say(dialect.MAVLink_ping_message(11, 7, 0, 0))
    assert (reply.time_usec, reply.seq, reply.target_system, reply.target_component) == (11, 7, 255, 190)
    assert bench.say(dialect.MAVLink_ping_message(11, 7, 1, 1)) == []
