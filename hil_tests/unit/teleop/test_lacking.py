"""Protocols that the bridge lacks: refused at once, by their own means, and changing nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.mavlink.lacking import (
    ACK,
    FILE_NOT_FOUND,
    INVALID_SESSION,
    LACKING,
    NAK,
    UNKNOWN_COMMAND,
)
from firmware_bridge.units import MILLISECOND, SECOND
from firmware_bridge.wire.internet import number_of
from hil_tests.unit.teleop.bench import rars, target_message
from hil_tests.unit.teleop.received import texts, types
from hil_tests.unit.teleop.stations import ARM, Hand

if TYPE_CHECKING:
    from hil_tests.unit.teleop.bench import RarsBench

OPEN, LIST, READ, BURST, RESET, CREATE = 4, 3, 5, 15, 2, 6
HERE, THERE = number_of("10.0.0.1", 14550), number_of("10.0.0.2", 14550)


def ftp(opcode: int, *, sequence: int = 7, session: int = 0, data: bytes = b"@PARAM/param.pck") -> Any:
    """Return a request as mavlink.io, "File Transfer Protocol", lays it out."""
    head = sequence.to_bytes(2, "little") + bytes((session, opcode, len(data), 0, 0, 0)) + bytes(4)
    return dialect.MAVLink_file_transfer_protocol_message(0, 1, 1, (head + data).ljust(251, b"\0"))


@pytest.mark.parametrize(
    ("opcode", "error"),
    [
        (OPEN, FILE_NOT_FOUND),
        (LIST, FILE_NOT_FOUND),
        (READ, INVALID_SESSION),
        (BURST, INVALID_SESSION),
        (CREATE, 1),
        (99, UNKNOWN_COMMAND),
        (RESET, None),
        (1, None),
    ],
)
def test_a_file_transfer_ends_at_once(bench: RarsBench, opcode: int, error: int | None) -> None:
    [answer] = bench.say(ftp(opcode))
    payload = bytes(answer.payload)
    assert (answer.target_system, answer.target_component) == (255, 190)
    assert int.from_bytes(payload[:2], "little") == 8
    assert (payload[3], payload[5]) == (ACK if error is None else NAK, opcode)
    assert (payload[4], payload[12]) == ((0, 0) if error is None else (1, error))


@pytest.mark.parametrize("opcode", [ACK, NAK])
def test_an_answer_is_not_answered(bench: RarsBench, opcode: int) -> None:
    assert bench.say(ftp(opcode)) == []


def test_the_sequence_number_of_a_file_transfer_goes_round(bench: RarsBench) -> None:
    [answer] = bench.say(ftp(LIST, sequence=0xFFFF))
    assert bytes(answer.payload)[:2] == b"\0\0"


def test_there_are_no_logs(bench: RarsBench) -> None:
    [entry] = bench.say(dialect.MAVLink_log_request_list_message(1, 1, 0, 0xFFFF))
    assert (entry.get_type(), entry.num_logs, entry.last_log_num) == ("LOG_ENTRY", 0, 0)
    [data] = bench.say(dialect.MAVLink_log_request_data_message(1, 1, 3, 90, 90))
    assert (data.get_type(), data.id, data.ofs, data.count) == ("LOG_DATA", 3, 90, 0)


@pytest.mark.parametrize("kind", [0, 1, 2])
def test_parts_and_items_of_missions_are_refused_with_their_kind(bench: RarsBench, kind: int) -> None:
    part = dialect.MAVLink_mission_write_partial_list_message(1, 1, 0, 3, kind)
    item = dialect.MAVLink_mission_item_int_message(1, 1, 0, 0, 16, 0, 1, 0.0, 0.0, 0.0, 0.0, 0, 0, 0.0, kind)
    for message, result in (
        (part, dialect.MAV_MISSION_UNSUPPORTED),
        (item, dialect.MAV_MISSION_INVALID_SEQUENCE),
    ):
        [ack] = bench.say(message)
        assert (ack.get_type(), ack.type, ack.mission_type) == ("MISSION_ACK", result, kind)


def test_the_old_fence_and_rally_points_are_none(bench: RarsBench) -> None:
    [fence] = bench.say(dialect.MAVLink_fence_fetch_point_message(1, 1, 2))
    assert (fence.get_type(), fence.idx, fence.count) == ("FENCE_POINT", 2, 0)
    [rally] = bench.say(dialect.MAVLink_rally_fetch_point_message(1, 1, 2))
    assert (rally.get_type(), rally.idx, rally.count) == ("RALLY_POINT", 2, 0)


def test_the_version_is_sent_in_its_own_message_to_who_requests_it(bench: RarsBench) -> None:
    assert types(bench.say(dialect.MAVLink_autopilot_version_request_message(1, 1))) == ["AUTOPILOT_VERSION"]


@given(st.sampled_from(sorted(LACKING)), st.binary(max_size=255))
def test_whatever_is_requested_is_answered_once_and_changes_nothing(number: int, payload: bytes) -> None:
    bench = rars()
    kind = dialect.mavlink_map[number]
    size = kind.unpacker.size
    message = dialect.MAVLink(None).decode(bytearray(_frame(number, payload.ljust(size, b"\0")[:size], kind)))
    before = bench.operator.intent
    assert len(bench.send(bytes(message.get_msgbuf()))) <= 1
    assert (bench.requested, bench.operator.intent) == ([], before)


def _frame(number: int, payload: bytes, kind: Any) -> bytes:
    head = bytes((len(payload), 0, 0, 0, 255, 190)) + number.to_bytes(3, "little")
    checksum = dialect.x25crc(head + payload + bytes((kind.crc_extra,))).crc
    return b"".join((b"\xfd", head, payload, int(checksum).to_bytes(2, "little")))


SET_POINTS = (
    dialect.MAVLink_set_attitude_target_message(0, 1, 1, 0, (1.0, 0.0, 0.0, 0.0), 0.0, 0.0, 0.0, 0.5),
    dialect.MAVLink_set_position_target_global_int_message(0, 1, 1, 6, 0xDE7, 0, 0, *(0.5,) * 9),
    dialect.MAVLink_set_actuator_control_target_message(0, 0, 1, 1, (0.5,) * 8),
)


@pytest.mark.parametrize("message", SET_POINTS, ids=lambda one: str(one.get_type()))
def test_a_set_point_of_another_kind_is_refused_in_words_now_and_then(bench: RarsBench, message: Any) -> None:
    reported = []
    for _ in range(200):  # ten seconds at 20 Hz
        reported += texts(bench.say(message))
        bench.now += 50 * MILLISECOND
    assert "".join(reported[:2]) == f"{message.get_type()} refused: send SET_POSITION_TARGET_LOCAL_NED"
    assert len([one for one in reported if "refused" in one]) == 3, "at once, after 2 s and 4 s more"
    assert bench.operator.intent.received_at < 0
    assert bench.operator.dropped.refused == 200


def test_it_stops_no_one_elses_driving(bench: RarsBench) -> None:
    driver, other = Hand(bench, HERE), Hand(bench, THERE)
    driver.stick()
    driver.result(ARM, 1)
    driver.say(target_message(0.2))
    bench.now += SECOND // 10
    assert "moves nothing" in "".join(texts(other.say(SET_POINTS[0])))
    assert bench.command.speed_mps == pytest.approx(0.2)
