"""Frames byte for byte, in both directions; and bytes that are no frames."""

import os
import subprocess
import sys
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from firmware_bridge.mavlink.frames import Codec, concerns, dialect, text_of
from hil_tests.lanes import examples
from hil_tests.rows import every

STATION, ROBOT = (255, 190), (1, 1)


def zeros(count: int) -> str:
    return "00 " * count


# Made with pymavlink 2.4.50's `all` dialect and checked by hand against common.xml: sender, message, frame.
GOLDEN = [
    pytest.param(
        ROBOT,
        dialect.MAVLink_heartbeat_message(10, 0, 0xC1, 0, 4, 3),
        "FD 09 00 00 00 01 01 00 00 00 00 00 00 00 0A 00 C1 04 03 BC CC",
        id="heartbeat of the armed robot",
    ),
    pytest.param(
        STATION,
        dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3),
        "FD 09 00 00 00 FF BE 00 00 00 00 00 00 00 06 08 00 04 03 3D 48",
        id="heartbeat of the station",
    ),
    pytest.param(
        STATION,
        dialect.MAVLink_command_long_message(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0),
        f"FD 20 00 00 00 FF BE 4C 00 00 00 00 80 3F {zeros(24)} 90 01 01 01 9E 4E",
        id="arm",
    ),
    pytest.param(
        ROBOT,
        dialect.MAVLink_command_ack_message(400, 0, 0, 0, 255, 190),
        "FD 0A 00 00 00 01 01 4D 00 00 90 01 00 00 00 00 00 00 FF BE 6A 53",
        id="arm is accepted",
    ),
    pytest.param(
        STATION,
        dialect.MAVLink_command_long_message(1, 1, 400, 0, 0, 21196, 0, 0, 0, 0, 0),
        f"FD 20 00 00 00 FF BE 4C 00 00 00 00 00 00 00 98 A5 46 {zeros(20)} 90 01 01 01 BC EA",
        id="disarm by force",
    ),
    pytest.param(
        STATION,
        dialect.MAVLink_command_long_message(1, 1, 512, 0, 148, 0, 0, 0, 0, 0, 0),
        f"FD 20 00 00 00 FF BE 4C 00 00 00 00 14 43 {zeros(24)} 00 02 01 01 63 2F",
        id="request AUTOPILOT_VERSION",
    ),
    pytest.param(
        ROBOT,
        dialect.MAVLink_command_ack_message(512, 3, 0, 0, 255, 190),
        "FD 0A 00 00 00 01 01 4D 00 00 00 02 03 00 00 00 00 00 FF BE 5A 12",
        id="a request is unsupported",
    ),
    pytest.param(
        STATION,
        dialect.MAVLink_set_position_target_local_ned_message(
            1000, 1, 1, 8, 1511, 0, 0, 0, 0.06, 0, 0, 0, 0, 0, 0, 0.1
        ),
        f"FD 35 00 00 00 FF BE 54 00 00 E8 03 00 00 {zeros(12)} 8F C2 75 3D {zeros(24)}"
        " CD CC CC 3D E7 05 01 01 08 2C 0A",
        id="60 mm/s and 0.1 rad/s",
    ),
    pytest.param(
        STATION,
        dialect.MAVLink_manual_control_message(1, 500, 0, 0, -250, 0),
        "FD 0B 00 00 00 FF BE 45 00 00 F4 01 00 00 00 00 06 FF 00 00 01 BA 03",
        id="half speed, a quarter left",
    ),
    pytest.param(
        ROBOT,
        dialect.MAVLink_mission_count_message(255, 190, 0),
        "FD 04 00 00 00 01 01 2C 00 00 00 00 FF BE 81 22",
        id="no mission",
    ),
    pytest.param(
        ROBOT,
        dialect.MAVLink_param_value_message(b"WHEEL_R", 0.05, 9, 12, 3),
        f"FD 19 00 00 00 01 01 16 00 00 CD CC 4C 3D 0C 00 03 00 57 48 45 45 4C 5F 52 {zeros(9)} 09 81 3D",
        id="a parameter",
    ),
    pytest.param(
        ROBOT,
        dialect.MAVLink_statustext_message(4, b"GCS Failsafe"),
        "FD 0D 00 00 00 01 01 FD 00 00 04 47 43 53 20 46 61 69 6C 73 61 66 65 B5 AC",
        id="a text",
    ),
    pytest.param(
        ROBOT,
        dialect.MAVLink_extended_sys_state_message(0, 1),
        "FD 02 00 00 00 01 01 F5 00 00 00 01 16 E9",
        id="on the ground",
    ),
    pytest.param(
        ROBOT,
        dialect.MAVLink_named_value_float_message(1000, b"STEER", 0.5),
        "FD 0D 00 00 00 01 01 FB 00 00 E8 03 00 00 00 00 00 3F 53 54 45 45 52 BE EB",
        id="a named value",
    ),
]
SIGNED = bytes.fromhex(
    "FD 09 01 00 00 FF BE 00 00 00 00 00 00 00 06 08 00 04 03 DA B0 01 78 56 34 12 00 00 00 73 89 DC 92 24"
)
ARM = bytes.fromhex(f"FD 20 00 00 00 FF BE 4C 00 00 00 00 80 3F {zeros(24)} 90 01 01 01 9E 4E")


def fields(message: Any) -> dict[str, Any]:
    return {name: getattr(message, name) for name in message.get_fieldnames()}


@pytest.mark.parametrize(("sender", "message", "frame"), GOLDEN)
def test_a_message_becomes_this_frame(sender: tuple[int, int], message: Any, frame: str) -> None:
    assert Codec(*sender).encode(message) == bytes.fromhex(frame)


@pytest.mark.parametrize(("sender", "message", "frame"), GOLDEN)
def test_this_frame_becomes_the_message(sender: tuple[int, int], message: Any, frame: str) -> None:
    [received] = Codec(9, 9).decode(bytes.fromhex(frame))
    assert (received.get_srcSystem(), received.get_srcComponent()) == sender
    assert fields(received) == {
        name: pytest.approx(value, rel=1e-7) if isinstance(value, float) else value
        for name, value in fields(message).items()
    }


@pytest.mark.parametrize(("sender", "message", "frame"), GOLDEN)
def test_garbage_around_a_frame_is_counted_and_skipped(
    sender: tuple[int, int], message: Any, frame: str
) -> None:
    codec = Codec(9, 9)
    wire = bytes.fromhex(frame)
    received = codec.decode(b"\xfd\xfe\x00\xfd" + wire + b"\xfe\xfd\x20" + wire + b"\xfd\xff")
    assert [one.get_type() for one in received] == [message.get_type()] * 2
    assert (codec.counters.frames, codec.counters.corrupt) == (2, 3)
    assert received[0].get_srcSystem() == sender[0]


def test_sequence_numbers_count_up_and_wrap_around() -> None:
    codec = Codec(1, 1)
    message = dialect.MAVLink_extended_sys_state_message(0, 1)
    assert [codec.encode(message)[4] for _ in range(258)] == [*range(256), 0, 1]


@every("at", range(len(ARM)))
def test_one_wrong_bit_anywhere_is_no_command(at: int) -> None:
    for bit in range(8):
        codec = Codec(9, 9)
        wrong = bytearray(ARM)
        wrong[at] ^= 1 << bit
        received = codec.decode(bytes(wrong))
        assert received == []
        # A wrong message number may name a message that we lack; no one can check its checksum.
        assert codec.counters.corrupt + codec.counters.unknown == 1


@every("length", range(len(ARM)))
def test_a_cut_datagram_does_not_harm_the_next_one(length: int) -> None:
    codec = Codec(9, 9)
    assert codec.decode(ARM[:length]) == []
    assert len(codec.decode(ARM)) == 1


def test_a_mavlink_1_frame_is_understood() -> None:
    gate = dialect.MAVLink(None, srcSystem=255, srcComponent=190)
    message = dialect.MAVLink_command_long_message(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
    [received] = Codec(9, 9).decode(message.pack(gate, force_mavlink1=True))
    assert fields(received) == fields(message)


def test_a_signed_frame_is_read_without_checking_its_signature() -> None:
    [received] = Codec(9, 9).decode(SIGNED)
    assert received.get_type() == "HEARTBEAT"


def test_an_incompatible_frame_is_dropped() -> None:
    assert Codec(9, 9).decode(ARM[:2] + b"\x02" + ARM[3:]) == []


def test_a_message_that_no_one_knows_is_skipped_whole() -> None:
    codec = Codec(9, 9)
    unknown = b"\xfd\x03\x00\x00\x00\xff\xbe\xff\xff\x7f" + b"\xfd\xfe\xfd" + b"\x00\x00"
    assert [one.get_type() for one in codec.decode(unknown + ARM)] == ["COMMAND_LONG"]
    assert (codec.counters.unknown, codec.counters.corrupt) == (1, 0)


def test_only_wanted_messages_are_unpacked() -> None:
    codec = Codec(9, 9)
    assert codec.decode(ARM, wanted={0}) == []
    assert len(codec.decode(ARM, wanted={76})) == 1


def test_the_environment_cannot_switch_the_checksum_off() -> None:
    wrong = ARM[:-1] + bytes([ARM[-1] ^ 1])
    script = (
        "from firmware_bridge.mavlink.frames import Codec\n"
        f"print(len(Codec(9, 9).decode(bytes.fromhex('{wrong.hex()}'))))"
    )
    run = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "MAV_IGNORE_CRC": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout == "0\n"


@pytest.mark.parametrize(
    ("target", "is_ours"),
    [
        ((1, 1), True),
        ((0, 0), True),
        ((1, 0), True),
        ((0, 1), True),
        ((2, 1), False),
        ((1, 2), False),
        ((255, 190), False),
    ],
)
def test_a_target_of_zero_is_everybody(target: tuple[int, int], is_ours: bool) -> None:  # noqa: FBT001 - a table
    message = dialect.MAVLink_param_request_list_message(*target)
    assert concerns(message, 1, 1) is is_ours


def test_a_message_without_a_target_concerns_everybody() -> None:
    assert concerns(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3), 1, 1)


def test_a_text_field_ends_at_its_first_nul() -> None:
    assert text_of(b"SPD_MAX\0rest") == "SPD_MAX"
    assert text_of("SPD_MAX") == "SPD_MAX"
    assert text_of(b"\xff\xe4A") == "??A"


@given(st.binary(max_size=600))
@example(b"\xfd" * 300)
@example(b"\xfe" * 300)
@settings(max_examples=examples(200))
def test_no_bytes_make_the_codec_raise(datagram: bytes) -> None:
    Codec(1, 1).decode(datagram)


@given(st.sampled_from(sorted(dialect.mavlink_map)), st.binary(min_size=1, max_size=255))
@settings(max_examples=examples(300))
def test_no_payload_under_a_right_checksum_makes_the_codec_raise(number: int, payload: bytes) -> None:
    body = bytes([len(payload), 0, 0, 0, 255, 190]) + number.to_bytes(3, "little") + payload
    crc = dialect.x25crc(body)
    crc.accumulate(bytes([dialect.mavlink_map[number].crc_extra]))
    [received] = Codec(1, 1).decode(b"\xfd" + body + crc.crc.to_bytes(2, "little"))
    assert received.get_msgId() == number
