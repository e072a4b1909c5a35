"""Frames in words: one row for each service, mapping and mode followed; anything has a text."""

import hypothesis.strategies as st
import pytest
from hypothesis import given

from firmware_bridge.canopen.address import Address
from firmware_bridge.dissector.canopen import Canopen
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE
from firmware_bridge.wire.can_error import BUS_OFF

ON = "power stage on, remote (NMT operational)"
ROWS = [
    (0x000, "0103", "NMT start, node 3"),
    (0x000, "8200", "NMT reset communication, all nodes"),
    (0x000, "07", "NMT: no command"),
    (0x080, "", "SYNC"),
    (0x083, "0000000000000000", "EMCY node 3: no error; error register 0x00 (no error)"),
    (
        0x083,
        "2032040000000000",
        "EMCY node 3: 0x3220, under-voltage; error register 0x04 (voltage)",
    ),
    (0x083, "2032", "EMCY node 3: too short"),
    (0x100, "", "TIME"),
    (0x603, "4041600000000000", "SDO request, node 3: read 0x6041 Statusword"),
    (
        0x583,
        "4B41600050020000",
        f"SDO response, node 3: 0x6041 Statusword = 0x0250 (no state of the drive, {ON})",
    ),
    (
        0x603,
        "2B40600006000000",
        "SDO request, node 3: write 0x6040 Controlword = 0x0006 (shutdown)",
    ),
    (0x583, "6040600000000000", "SDO response, node 3: 0x6040 Controlword written"),
    (0x603, "22816000F4010000", "SDO request, node 3: write 0x6081 Profile Velocity = 500 rpm"),
    (0x603, "2F606000FE000000", "SDO request, node 3: write 0x6060 Modes of Operation = -2 (velocity)"),
    (
        0x583,
        "8041600002000106",
        "SDO response, node 3: abort, 0x6041 Statusword: 0x06010002 object is read-only",
    ),
    (0x603, "2100200010000000", "SDO request, node 3: write 0x2000 Node ID, segments of 16 bytes to come"),
    (0x603, "E0", "SDO request, node 3: no SDO transfer"),
    (0x703, "00", "boot-up, node 3"),
    (0x703, "85", "heartbeat, node 3: operational"),
    (0x703, "33", "heartbeat, node 3: no state"),
    (0x703 | REMOTE, "00", "remote request of 0x703"),
    (0x183 | REMOTE, "", "remote request of TPDO 1, node 3"),
    (0x7E5, "0401000000000000", "LSS: switch global 01 00 00 00 00 00 00"),
    (
        0x183,
        "3707",
        (
            "TPDO 1, node 3 (default mapping): 0x6041 Statusword = 0x0737 "
            f"(operation enabled, {ON}, target reached)"
        ),
    ),
    (0x183, "37", "TPDO 1, node 3 (default mapping): bytes that do not fit its mapping"),
    (
        0x503,
        "0F00FFFFFFFF",
        (
            "RPDO 4, node 3 (default mapping): 0x6040 Controlword = 0x000F (enable operation), "
            "0x60FF Target Velocity = -1 rpm"
        ),
    ),
    (0x180, "00", "a PDO of an unknown node"),
    (0x7FF, "00", "no CANopen service"),
    (0x123 | EXTENDED, "00", "a frame with 29 bits, no CANopen"),
    (BUS_OFF, "0000000000000000", "report of the controller: bus off"),
]


@pytest.mark.parametrize(("address", "content", "text"), ROWS)
def test_a_frame_in_words(address: int, content: str, text: str) -> None:
    assert Canopen().read("someone", Packet(CAN, address, bytes.fromhex(content))) == text


def read(reader: Canopen, *frames: tuple[int, str]) -> str:
    for address, content in frames:
        text = reader.read("someone", Packet(CAN, address, bytes.fromhex(content)))
    return text


REMAPPED = (
    (0x603, "2F001A0000000000"),  # no objects in transmit PDO 1
    (0x603, "23001A0120006460"),  # 0x6064, 32 bits
    (0x603, "2F001A0001000000"),
    (0x603, "2300180185010040"),  # COB-ID 0x185
)


def test_a_mapping_is_followed_and_forgotten_with_a_restart() -> None:
    reader, sample = Canopen(), (0x185, "D2040000")
    assert read(reader, *REMAPPED, sample) == "TPDO 1, node 3: 0x6064 Position Actual Value = 1234 qc"
    assert "do not fit" in read(reader, (0x703, "00"), sample)
    assert "do not fit" in read(reader, *REMAPPED, (0x000, "8100"), sample)


def test_a_mapping_that_was_saved_outlives_a_restart() -> None:
    save = (0x603, "2310100173617665")
    assert "Position Actual" in read(Canopen(), *REMAPPED, save, (0x703, "00"), (0x185, "D2040000"))


def test_the_mode_gives_the_bits_their_names() -> None:
    homing = (0x603, "2F60600006000000")
    assert "homing attained" in read(Canopen(), homing, (0x183, "3717"))


def test_segments_are_of_the_object_that_was_requested() -> None:
    requested = ((0x603, "4008100000000000"), (0x583, "410810000D000000"), (0x603, "6000000000000000"))
    reader = Canopen()
    assert read(reader, *requested) == "SDO request, node 3: next segment of 0x1008 Manufacturer Device Name"
    assert read(reader, (0x583, "0145504F53320000")) == (
        "SDO response, node 3: segment of 0x1008 Manufacturer Device Name, the last: 45 50 4F 53 32 00 00"
    )


flags = st.sampled_from((0, EXTENDED, REMOTE, ERROR))
frames = st.lists(st.tuples(st.integers(0, 0x7FF), flags, st.binary(max_size=8)), min_size=1, max_size=20)


@given(frames)
def test_whatever_comes_has_a_text(sent: list[tuple[int, int, bytes]]) -> None:
    reader = Canopen()
    for number, flag, content in sent:
        assert reader.read("someone", Packet(CAN, number | flag, content))


WRITE_COUNT, READ_COUNT = (0x603, "2F001A0001000000"), (0x583, "4F001A0001000000")
WRITE_ENTRY, READ_ENTRY = (0x603, "23001A0110004160"), (0x583, "43001A0110004160")
STATUS = (0x183, "3707")
BOOT_UP = (0x703, "00")


@pytest.mark.parametrize(
    "known_by", [(WRITE_ENTRY, WRITE_COUNT), (READ_COUNT, READ_ENTRY), (WRITE_COUNT, READ_ENTRY)]
)
def test_a_default_mapping_is_marked_until_it_is_written_or_read_and_again_after_a_boot_up(
    known_by: tuple[tuple[int, str], ...],
) -> None:
    reader = Canopen()
    assert read(reader, STATUS).startswith("TPDO 1, node 3 (default mapping): ")
    assert read(reader, known_by[0], STATUS).startswith("TPDO 1, node 3 (default mapping): ")
    assert read(reader, known_by[1], STATUS).startswith("TPDO 1, node 3: ")
    assert read(reader, BOOT_UP, STATUS).startswith("TPDO 1, node 3 (default mapping): ")


def test_a_mapping_that_was_saved_is_no_default_after_a_boot_up() -> None:
    saved = (0x603, "2310100173617665")
    assert read(Canopen(), WRITE_ENTRY, WRITE_COUNT, saved, BOOT_UP, STATUS).startswith("TPDO 1, node 3: ")


def test_a_mapping_of_a_data_sheet_is_no_default() -> None:
    sheet = {Address(0x1A00, 0): 1, Address(0x1A00, 1): 0x60410010, Address(0x1800, 1): 0x183}
    assert read(Canopen(sheet=sheet), STATUS).startswith("TPDO 1, node 3: ")
