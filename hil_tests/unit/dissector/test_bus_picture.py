"""Picture of a bus from listening: frame by frame, by the robot's mapping, and from a recording."""

import lzma
from pathlib import Path
from typing import Final

import hypothesis.strategies as st
import pytest
from hypothesis import given

from firmware_bridge import robot_types
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.dissector.expected import can_links, expected_on
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.recording import parse_candump
from firmware_bridge.units import MILLISECOND, SECOND
from firmware_bridge.wire.can import EXTENDED, INTERFRAME_BITS, REMOTE, frame_bits
from firmware_bridge.wire.can_error import BUS_OFF, encode_report
from hil_tests.rows import every

MASTERS: Final = Path(__file__).parents[2] / "recordings" / "rars" / "canopen-master.log.xz"
ON: Final = "power stage on, remote (NMT operational)"

MARK: Final = " (default mapping)"
STORY: Final = [
    (0, 0x703, "00", ["node 3 is there", "node 3: restarted"]),
    (1, 0x703, "7F", ["node 3: pre-operational"]),
    (101, 0x703, "7F", []),
    (110, 0x603, "4041600000000000", []),
    (111, 0x583, "4B41600040050000", ["node 3: statusword 0x0540 (switch on disabled, target reached)"]),
    (112, 0x583, "4B41600040050000", []),
    (113, 0x183, "3705", []),  # of what it consists, no one has seen yet
    (120, 0x603, "2F001A0001000000", []),
    (121, 0x603, "23011A0010004160", []),
    # How many objects it has, is its default only.
    (122, 0x183, "3707", [f"node 3: statusword 0x0737 (operation enabled, {ON}, target reached){MARK}"]),
    (123, 0x183, "37", []),  # too short for its mapping
    (130, 0x603, "2B40600006000000", []),
    (
        131,
        0x583,
        "8040600000000206",
        ["SDO response, node 3: abort, 0x6040 Controlword: 0x06020000 no such object"],
    ),
    (140, 0x000, "0103", ["NMT start, node 3"]),
    (
        150,
        0x083,
        "2032040000000000",
        ["EMCY node 3: 0x3220, under-voltage; error register 0x04 (voltage)"],
    ),
    (151, 0x083, "0000000000000000", ["EMCY node 3: no error; error register 0x00 (no error)"]),
    (201, 0x703, "05", ["node 3: operational"]),
    (400, 0x703, "05", []),
    (600, 0x080, "", []),
    (601, 0x080, "", ["node 3: no heartbeat for more than 2 x 100 ms"]),
    (1100, 0x080, "", []),
    (1200, 0x703, "05", ["node 3: its heartbeat is back"]),
    (1201, 0x703 | REMOTE, "00", []),
    (1202, BUS_OFF, encode_report().hex(), ["report of the controller: bus off"]),
    (1300, 0x703, "00", ["node 3: restarted"]),
]
"""Milliseconds, identifier, bytes, and what has changed."""


def frame(address: int, content: str) -> Packet:
    return Packet(CAN, address, bytes.fromhex(content))


def reported(rows: list[tuple[int, int, str, list[str]]]) -> BusPicture:
    picture = BusPicture(1_000_000)
    for at, address, content, _ in rows:
        picture.note(at * MILLISECOND, frame(address, content))
    return picture


def test_each_change_is_reported_once() -> None:
    picture = BusPicture(1_000_000)
    for at, address, content, changes in STORY:
        found = picture.note(at * MILLISECOND, frame(address, content))
        assert list(found) == changes, f"at {at} ms"


def test_what_is_known_of_a_node_is_what_it_stated_last() -> None:
    picture = reported(STORY[:17])
    (node,) = picture.nodes
    assert (node.node, node.network, node.period) == (3, NmtState.OPERATIONAL, 100 * MILLISECOND)
    assert node.status.startswith("0x0737 (operation enabled")
    assert (node.emergencies, node.emergency) == (1, "no error; error register 0x00 (no error)")
    assert picture.error is not None
    assert (picture.error.at, picture.error.text) == (150 * MILLISECOND, STORY[14][3][0])
    (node,) = reported(STORY[:22]).nodes
    assert (node.missing, node.period) == (False, 100 * MILLISECOND), "silence is no period"
    (node,) = reported(STORY).nodes
    assert (node.network, node.period, node.status) == (NmtState.PRE_OPERATIONAL, None, ""), (
        "a restart forgets"
    )


def test_a_pdo_is_read_by_a_mapping_that_was_seen_and_else_shown_as_it_is() -> None:
    rows = {title: stated for _, title, stated, _, _ in reported(STORY[:7]).messages()}
    assert rows["TPDO 1, node 3"] == "37 05, by a mapping that is not known"
    rows = {title: stated for _, title, stated, _, _ in reported(STORY[:10]).messages()}
    # Only the number of its objects was seen.
    read = rows["TPDO 1, node 3 (default mapping)"]
    assert read == f"0x6041 Statusword = 0x0737 (operation enabled, {ON}, target reached)"
    rows = {title: stated for _, title, stated, _, _ in reported(STORY[:11]).messages()}
    assert rows["TPDO 1, node 3 (default mapping)"] == "bytes that do not fit its mapping"


def test_a_robot_file_names_the_drives_and_their_pdos_even_after_a_restart() -> None:
    robot = robot_types.find("rars")
    (link,) = can_links(robot)
    axis = robot.axes_on(link)[0]
    node = Epos2Axis.of(axis).node
    picture = BusPicture(1_000_000, tuple(expected_on(robot, link)))
    sample = frame(0x280 + node, "3707E80300000A00")
    changes = [*picture.note(0, frame(0x700 + node, "00")), *picture.note(1, sample)]
    assert changes[2:] == [f"node {node}: statusword 0x0737 (operation enabled, {ON}, target reached)"]
    assert picture.nodes[0].title == axis.title
    stated = {address: text for address, _, text, _, _ in picture.messages()}[0x280 + node]
    assert "0x6064 Position Actual Value = 1000 qc" in stated
    assert stated.endswith("0x2027 Current Actual Value Averaged = 10 mA")


def test_drives_of_any_maker_are_read_by_the_standard() -> None:
    robot = robot_types.find("servo_axis")
    (link,) = can_links(robot)
    picture = BusPicture(1_000_000, tuple(expected_on(robot, link)))
    changes = [*picture.note(0, frame(0x701, "00")), *picture.note(1, frame(0x281, "3706E80300000A00"))]
    assert changes[2:] == [
        "node 1: statusword 0x0637 (operation enabled, voltage enabled, remote, target reached)"
    ]
    stated = {address: text for address, _, text, _, _ in picture.messages()}[0x281]
    assert "0x6064 Position Actual Value = 1000 position units" in stated
    assert stated.endswith("0x6078 Current Actual Value = 10 1/1000")
    (failed,) = picture.note(2, frame(0x081, "1186000000000000"))
    assert failed.startswith("EMCY node 1: 0x8611, following error")


def test_a_node_of_a_maker_who_is_not_known_is_read_by_the_standard_and_its_pdos_are_not() -> None:
    picture = BusPicture(1_000_000)
    picture.note(0, frame(0x605, "4018100100000000"))
    picture.note(1, frame(0x585, "43181001CD0B0000"))
    picture.note(2, frame(0x605, "4041600000000000"))
    (state,) = picture.note(3, frame(0x585, "4B41600037060000"))
    assert state == "node 5: statusword 0x0637 (operation enabled, voltage enabled, remote, target reached)"
    picture.note(4, frame(0x185, "3706"))
    rows = {address: text for address, _, text, _, _ in picture.messages()}
    assert rows[0x185] == "37 06, by a mapping that is not known"


def test_rates_and_load_are_those_of_the_last_second_by_the_bits_on_the_wire() -> None:
    picture = BusPicture(125_000)
    beat = frame(0x703, "05")
    for at in range(0, 3000, 10):
        picture.note(at * MILLISECOND, beat)
    bits = frame_bits(beat.address, beat.payload) + INTERFRAME_BITS
    assert picture.load_percent == pytest.approx(100 * 100 * bits / 125_000)
    assert picture.peak_percent == pytest.approx(picture.load_percent)
    assert picture.mean_percent == pytest.approx(300 * bits / 125_000 / 2.99 * 100)
    ((address, _, _, count, rate),) = picture.messages()
    assert (address, count, rate) == (0x703, 300, 100.0)
    assert [*picture.pass_time(3500 * MILLISECOND)] == ["node 3: no heartbeat for more than 2 x 10 ms"]
    assert next(picture.messages())[4] == 49.0
    picture.pass_time(5 * SECOND)
    assert (picture.load_percent, next(picture.messages())[4]) == (0.0, 0.0)


def test_a_burst_is_a_peak_and_no_load_goes_beyond_all() -> None:
    picture = BusPicture(20_000)
    for at in range(400):
        picture.note(at * MILLISECOND, frame(0x123, "FFFFFFFFFFFFFFFF"))
    assert (picture.load_percent, picture.peak_percent) == (100.0, 100.0)


@given(
    st.lists(
        st.tuples(
            st.integers(0, 300),
            st.integers(0, 0x7FF),
            st.sampled_from([0, EXTENDED, REMOTE]),
            st.binary(max_size=8),
        )
    )
)
def test_whatever_comes_leaves_a_picture(frames: list[tuple[int, int, int, bytes]]) -> None:
    picture, now = BusPicture(1_000_000), 0
    for later, number, flag, content in frames:
        now += later * MILLISECOND
        assert all(picture.note(now, Packet(CAN, number | flag, content))), "a change has a text"
    assert sum(count for _, _, _, count, _ in picture.messages()) == picture.frames == len(frames)
    assert 0.0 <= picture.load_percent <= 100.0
    assert all(title for _, title, _, _, _ in picture.messages())


def test_nothing_received_is_a_picture_too() -> None:
    picture = BusPicture(1_000_000)
    assert picture.pass_time(SECOND) == ()
    assert (picture.nodes, [*picture.messages()], picture.load_percent, picture.error) == ((), [], 0.0, None)


def test_a_recording_of_a_third_party_master_is_one_picture_and_always_the_same() -> None:
    lines = lzma.decompress(MASTERS.read_bytes()).decode().splitlines()
    pictures = [BusPicture(1_000_000), BusPicture(1_000_000)]
    for picture in pictures:
        for line in lines:
            at, _, packet = parse_candump(line)
            picture.note(at, packet)
    one, other = pictures
    assert (list(one.messages()), one.nodes) == (list(other.messages()), other.nodes)
    assert one.frames == len(lines)
    assert [node.node for node in one.nodes] == [1, 2, 3, 4]
    assert one.error is not None
    assert one.error.text.endswith("abort, 0x6041 Statusword: 0x06010002 object is read-only")
    assert sum(count for _, _, _, count, _ in one.messages()) == len(lines)


def beats(*milliseconds: float) -> BusPicture:
    """Return a bus on which node 1 has sent its heartbeat at these instants, which count from 2019."""
    picture = BusPicture(1_000_000)
    for at in milliseconds:
        picture.note(round(at * MILLISECOND) - 10**9 * SECOND, Packet(CAN, 0x701, b"\x05"))
    return picture


@every(
    ("instants", "period_ms"),
    [
        # Six at once, as a controller sends them that comes back to the bus, or an adapter hands them over.
        ([*range(0, 1000, 100), *(2000 + k * 0.06 for k in range(6)), *range(2100, 5000, 100)], 100),
        ([*(k * 0.06 for k in range(6)), *range(100, 1000, 100)], 100),
        # Its period was set to another one while it was watched.
        ([*range(0, 1000, 100), *range(2000, 12_000, 1000)], 1000),
        ([*range(0, 10_000, 1000), *range(10_000, 11_000, 100)], 100),
        # One that was lost.
        ([0, 100, 200, 300, 500, 600, 700], 100),
    ],
)
def test_a_heartbeat_that_goes_on_is_not_missing_for_ever(instants: list[float], period_ms: int) -> None:
    picture = beats(*instants)
    (node,) = picture.nodes
    assert node.period == pytest.approx(period_ms * MILLISECOND, rel=0.01)
    end = picture.now
    picture.pass_time(end + 2 * period_ms * MILLISECOND)
    assert not node.missing
    picture.pass_time(end + 2 * period_ms * MILLISECOND + MILLISECOND)
    assert node.missing, "and one that ends is"


def test_a_node_does_what_the_network_command_states_until_it_states_otherwise() -> None:
    picture = BusPicture(1_000_000)
    for at, (address, text, state) in enumerate(
        (
            (0x701, "00", NmtState.PRE_OPERATIONAL),  # it goes on by itself after its boot-up
            (0x000, "0101", NmtState.OPERATIONAL),
            (0x000, "0200", NmtState.STOPPED),
            (0x000, "0102", NmtState.STOPPED),  # another node
            (0x701, "05", NmtState.OPERATIONAL),
            (0x000, "8001", NmtState.PRE_OPERATIONAL),
            (0x000, "8101", None),
            (0x701, "00", NmtState.PRE_OPERATIONAL),
        )
    ):
        picture.note(at * MILLISECOND, Packet(CAN, address, bytes.fromhex(text)))
        assert picture.nodes[0].network is state, f"{address:03X}#{text}"


def test_instants_count_from_the_first_frame_whatever_the_year() -> None:
    picture = beats(0, 250, 500)
    assert picture.elapsed == 500 * MILLISECOND
    assert picture.mean_percent > 0.0


def test_a_node_that_states_that_it_is_maxons_is_read_by_the_default_mapping() -> None:
    picture = BusPicture(1_000_000)
    status = Packet(CAN, 0x181, bytes.fromhex("4007"))
    picture.note(0, status)
    assert picture.nodes[0].status == ""
    picture.note(1, Packet(CAN, 0x581, bytes.fromhex("43181001FB000000")))
    picture.note(2, status)
    assert picture.nodes[0].status.startswith("0x0740 (switch on disabled")


def test_a_data_sheet_gives_the_mapping_of_all_others() -> None:
    sheet = {Address(0x1A00, 0): 1, Address(0x1A00, 1): 0x6061_0008}
    picture = BusPicture(1_000_000, sheet=sheet)
    picture.note(0, Packet(CAN, 0x181, b"\x03"))
    ((_, title, stated, _, _),) = picture.messages()
    assert (title, stated.split(" ")[0]) == ("TPDO 1, node 1", "0x6061")
    assert BusPicture(1_000_000, device="epos2").note(0, Packet(CAN, 0x181, b"\x40\x07"))
