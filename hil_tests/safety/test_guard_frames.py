"""The guard's list: each frame that may leave, each bound crossed by one, and what leaves instead."""

import struct
from typing import Final

import pytest

from firmware_bridge.node import CAN, OPERATOR, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.guard import guarded
from firmware_bridge.safety.guard.guard import REMEMBERED
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE
from hil_tests.safety.guard_bench import LINK, Bench, ScriptedNode, frame, position, wheel

STEER_END: Final = 134_953
"""60 degrees: rack 40.0 mm (4.7), 2.666 rad of pinion (4.8), 159 times 2000 quadcounts a turn."""
TOP_RPM: Final = 3_972
"""16 rad/s at the wheel, 26 times, are 3972.5 turns a minute."""
LIFT_END: Final = 2_890_879
"""86.7 mm of screw, 57.8 turns of 1.5 mm, 25 times 2000 quadcounts a turn."""

ADMITTED: Final = (
    *(frame(0x000, f"{command}{node:02x}") for command in ("01", "80", "82") for node in range(5)),
    frame(0x080, ""),
    *(frame(0x764, state) for state in ("00", "04", "05", "7f")),
    *(
        wheel(node, word, rpm)
        for node in (1, 2)
        for word in (0x0000, 0x0002, 0x0006, 0x0007, 0x000B, 0x000F, 0x0080, 0x010F)
        for rpm in (-TOP_RPM, -TOP_RPM + 1, -1, 0, 1, TOP_RPM - 1, TOP_RPM)
    ),
    *(
        position(node, word, counts)
        for node, low, high in ((3, -STEER_END, STEER_END), (4, 0, LIFT_END))
        for word in (0x0000, 0x0002, 0x0006, 0x0007, 0x000B, 0x000F, 0x003F, 0x0080, 0x010F)
        for counts in (low, low + 1, 0, high - 1, high)
    ),
    *(frame(0x200 + node, braking) for node in (1, 2) for braking in ("3a070000", "18150000")),
    *(frame(0x600 + node, "4041600000000000") for node in (1, 2, 3, 4)),
    frame(0x601, "40ffff0000000000"),
    frame(0x601, "6000000000000000"),
    frame(0x601, "7000000000000000"),
    frame(0x601, "8000100000000008"),
)

REFUSED: Final = (
    # Quick stop decelerations: 1850 to 5400 rpm/s.
    (frame(0x201, "39070000"), "quick stop deceleration of 1849 rpm/s is not within 1850 to 5400 rpm/s"),
    (frame(0x202, "19150000"), "quick stop deceleration of 5401 rpm/s is not within 1850 to 5400 rpm/s"),
    (frame(0x201, "00000000"), "quick stop deceleration of 0 rpm/s is not within 1850 to 5400 rpm/s"),
    (frame(0x201, "181500"), "3 bytes where 4 are mapped"),
    (frame(0x201, ""), "0 bytes where 4 are mapped"),
    # Network management: stop, unknown commands, third parties, lengths.
    (frame(0x000, "0200"), "content '02 00' is not listed"),
    (frame(0x000, "0201"), "content '02 01' is not listed"),
    (frame(0x000, "0300"), "content '03 00' is not listed"),
    (frame(0x000, "0105"), "content '01 05' is not listed"),
    (frame(0x000, "8164"), "content '81 64' is not listed"),
    (frame(0x000, "01"), "content '01' is not listed"),
    (frame(0x000, "010000"), "content '01 00 00' is not listed"),
    (frame(0x000, ""), "content '' is not listed"),
    (frame(0x080, "00"), "content '00' is not listed"),
    (frame(0x764, "06"), "content '06' is not listed"),
    (frame(0x764, ""), "content '' is not listed"),
    (frame(0x764, "0505"), "content '05 05' is not listed"),
    # Identifiers: PDOs that are off, other nodes, the drives' own, flags.
    *(
        (Packet(LINK, address, bytes(6)), f"identifier 0x{address:X} is not listed")
        for address in (
            0x001, 0x07F, 0x081, 0x181, 0x203, 0x204, 0x301, 0x401, 0x402, 0x403 | EXTENDED, 0x405, 0x500,
            0x503, 0x504, 0x501 | EXTENDED, 0x501 | REMOTE, 0x501 | ERROR, 0x581, 0x600, 0x605, 0x701,
            0x763, 0x765, 0x7E5,
        )
    ),
)  # fmt: skip

SET_POINTS_REFUSED: Final = (
    *(
        (wheel(node, 0x000F, rpm), f"target {rpm} rpm is not within -3972 to 3972 rpm")
        for node in (1, 2)
        for rpm in (TOP_RPM + 1, -TOP_RPM - 1, 4000, 2**31 - 1, -(2**31))
    ),
    *(
        (position(3, 0x003F, counts), f"target {counts} qc is not within {-STEER_END} to {STEER_END} qc")
        for counts in (STEER_END + 1, -STEER_END - 1, 2**31 - 1)
    ),
    *(
        (position(4, 0x010F, counts), f"target {counts} qc is not within 0 to {LIFT_END} qc")
        for counts in (LIFT_END + 1, -1, -(2**31))
    ),
    *(
        (wheel(1, word, 0), f"controlword 0x{word:04X} is not listed")
        for word in (0x0001, 0x0003, 0x000A, 0x000C, 0x001F, 0x003F, 0x008F, 0x0100, 0x800F, 0xFFFF)
    ),
    *(
        (position(3, word, 0), f"controlword 0x{word:04X} is not listed")
        for word in (0x0001, 0x001F, 0x005F, 0x007F, 0x00BF, 0x013F, 0x100F)
    ),
    (frame(0x501, "0f0000000000ff"), "7 bytes where 6 are mapped"),
    (frame(0x501, "0f00000000"), "5 bytes where 6 are mapped"),
    (frame(0x403, ""), "0 bytes where 6 are mapped"),
)


@pytest.mark.parametrize("packet", ADMITTED, ids=str)
def test_a_listed_frame_leaves_untouched(bench: Bench, packet: Packet) -> None:
    assert bench.states(packet) == (packet,)
    assert bench.guard.refused == 0
    assert bench.guard.refusals == ()


@pytest.mark.parametrize(("packet", "reason"), REFUSED, ids=str)
def test_an_unlisted_frame_stops_every_axis_that_has_power(bench: Bench, packet: Packet, reason: str) -> None:
    assert bench.refuses(packet) == (reason, ())
    bench.states(wheel(1, 0x000F, 500), position(3, 0x003F, 700), position(4, 0x0006, 9))
    safe = (wheel(1, 0x000F, 0), position(3, 0x010F, 700))
    assert bench.refuses(packet) == (reason, safe)


@pytest.mark.parametrize(("packet", "reason"), SET_POINTS_REFUSED, ids=str)
def test_a_set_point_out_of_bounds_is_replaced_by_its_axis_at_rest(
    bench: Bench, packet: Packet, reason: str
) -> None:
    node = packet.address & 0x7F
    make = wheel if node < 3 else position
    # Without any command so far: it has no power, and gets none.
    assert bench.refuses(packet) == (reason, (make(node, 0, 0),))
    bench.states(make(node, 0x000F, 77))
    rest = wheel(node, 0x000F, 0) if node < 3 else position(node, 0x010F, 77)
    assert bench.refuses(packet) == (reason, (rest,))


@pytest.mark.parametrize("word", [0x0000, 0x0002, 0x0006, 0x0007, 0x000B, 0x0080])
def test_the_safe_frame_never_gives_power_to_a_drive_that_has_none(bench: Bench, word: int) -> None:
    bench.states(wheel(1, 0x000F, 100), wheel(1, word, 0), position(4, 0x003F, 50), position(4, word, 60))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, word, 0),)
    assert bench.refuses(position(4, 0x003F, -1))[1] == (position(4, word, 60),)
    assert bench.refuses(frame(0x123, ""))[1] == ()


@pytest.mark.parametrize("word", [0x000F, 0x010F])
def test_the_safe_frame_leaves_power_where_there_is_power(bench: Bench, word: int) -> None:
    bench.states(wheel(2, word, 100), position(3, word, -5))
    assert bench.refuses(frame(0x123, ""))[1] == (wheel(2, 0x000F, 0), position(3, 0x010F, -5))


def test_every_frame_is_judged_in_its_place(bench: Bench) -> None:
    sent = bench.states(
        frame(0x080, ""), wheel(1, 0x000F, 5000), Packet(OPERATOR, 0, b"text"), wheel(2, 0x000F, 300)
    )
    assert sent == (
        frame(0x080, ""), wheel(1, 0x0000, 0), Packet(OPERATOR, 0, b"text"), wheel(2, 0x000F, 300)
    )  # fmt: skip
    assert bench.guard.refused == 1


def test_datagrams_of_the_operator_pass_untouched(bench: Bench) -> None:
    packets = (Packet(OPERATOR, 0x123, b"\xff" * 300), Packet(OPERATOR, 0x501, b""))
    assert bench.states(*packets) == packets
    assert bench.guard.refused == 0


def test_a_link_that_is_not_listed_is_refused(bench: Bench) -> None:
    bench.states(wheel(1, 0x000F, 100))
    for link in (SERIAL, CAN, ""):
        packet = Packet(link, 0x501, struct.pack("<Hi", 0x000F, 200))
        assert bench.refuses(packet) == (f"link '{link}' is not listed", (wheel(1, 0x000F, 0),))


def test_packets_and_wakes_reach_the_node(bench: Bench) -> None:
    bench.scripted.wake_at = 77
    assert bench.guard.receive(frame(0x181, "4002"), 5) == Reaction((), 77)
    assert bench.guard.wake(6) == Reaction((), 77)
    assert bench.scripted.received == [(frame(0x181, "4002"), 5), (None, 6)]


def test_what_a_node_states_to_a_packet_is_judged_as_well(bench: Bench) -> None:
    bench.scripted.states = (wheel(1, 0x000F, 5000),)
    assert bench.guard.receive(frame(0x080, ""), 3).sent == (wheel(1, 0, 0),)
    assert bench.guard.refusals[0].at == 3


def test_refusals_are_all_counted_and_the_newest_kept(robot: AnyRobot) -> None:
    guard = guarded(ScriptedNode(), robot)
    for n in range(REMEMBERED + 5):
        guard.node = ScriptedNode((frame(0x123, f"{n % 256:02x}"),))
        guard.wake(n)
    assert guard.refused == 105
    assert [refusal.at for refusal in guard.refusals] == list(range(5, 105))


def test_a_mirrored_lift_counts_downwards(robot: AnyRobot) -> None:
    axes = tuple(axis.model_copy(update={"direction": -1}) for axis in robot.axes)
    bench = Bench(robot.model_copy(update={"axes": axes}))
    for low, high, node in ((-LIFT_END, 0, 4), (-STEER_END, STEER_END, 3)):
        for counts in (low, high):
            assert bench.states(position(node, 0x003F, counts)) == (position(node, 0x003F, counts),)
        for counts in (low - 1, high + 1):
            assert "is not within" in bench.refuses(position(node, 0x003F, counts))[0]
