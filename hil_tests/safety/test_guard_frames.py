"""The guard's list: each frame that may leave, each bound crossed by one, and what leaves instead."""

import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import pytest

from firmware_bridge.node import CAN, OPERATOR, SERIAL, Packet, Reaction
from firmware_bridge.robot import Robot, find
from firmware_bridge.safety.guard import REMEMBERED, Guarded, Refusal
from firmware_bridge.safety.guard_rules import rules_for
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE

CYCLE: Final = 50 * MILLISECOND
STEER_END: Final = 134_953
"""60 degrees: rack 40.0 mm (4.7), 2.666 rad of pinion (4.8), 159 times 2000 quadcounts a turn."""
LIFT_END: Final = 2_890_879
"""86.7 mm of screw, 57.8 turns of 1.5 mm, 25 times 2000 quadcounts a turn."""
START_NODE: Final = Packet(CAN, 0x000, b"\x01\x00")


@dataclass
class Puppet:
    """A node that says what the test wrote down."""

    says: tuple[Packet, ...] = ()
    wake_at: Nanoseconds = NEVER
    heard: list[tuple[Packet | None, Nanoseconds]] = field(default_factory=list)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self.heard.append((packet, now))
        return self._said()

    def wake(self, now: Nanoseconds) -> Reaction:
        self.heard.append((None, now))
        return self._said()

    def _said(self) -> Reaction:
        said, self.says = self.says, ()
        return Reaction(said, self.wake_at)


class Stopping(Puppet):
    """A node that can be stopped."""

    breaks = False

    def stop(self, now: Nanoseconds) -> Reaction:
        if self.breaks:
            raise ValueError("no more")
        return self.wake(now)


@pytest.fixture(scope="module")
def machine() -> Robot:
    return find("rars")


class Bench:
    """A puppet behind a guard."""

    def __init__(self, robot: Robot, puppet: Puppet | None = None) -> None:
        self.puppet = puppet or Puppet()
        self.told: list[Refusal] = []
        self.guard = Guarded(self.puppet, rules_for(robot), self.told.append)

    def says(self, *packets: Packet, now: Nanoseconds = 0) -> tuple[Packet, ...]:
        self.puppet.says = packets
        return self.guard.wake(now).sent

    def refuses(self, packet: Packet, now: Nanoseconds = 0) -> tuple[str, tuple[Packet, ...]]:
        before = self.guard.refused
        sent = self.says(packet, now=now)
        assert self.guard.refused == before + 1
        refusal = self.guard.refusals[-1]
        assert (refusal.at, refusal.packet, refusal.sent) == (now, packet, sent)
        assert self.told[-1] is refusal
        return refusal.reason, sent


@pytest.fixture
def bench(machine: Robot) -> Bench:
    return Bench(machine)


def frame(address: int, text: str) -> Packet:
    return Packet(CAN, address, bytes.fromhex(text))


def wheel(node: int, word: int, rpm: int) -> Packet:
    return Packet(CAN, 0x500 + node, struct.pack("<Hi", word, rpm))


def position(node: int, word: int, counts: int) -> Packet:
    return Packet(CAN, 0x400 + node, struct.pack("<Hi", word, counts))


def write(node: int, index: int, subindex: int, raw: bytes) -> Packet:
    """Expedited download with its size, CiA 301."""
    command = 0x23 | (4 - len(raw)) << 2
    return Packet(
        CAN, 0x600 + node, bytes((command,)) + struct.pack("<HB", index, subindex) + raw.ljust(4, b"\0")
    )


def aborted(node: int, index: int, subindex: int) -> tuple[Packet, ...]:
    return (Packet(CAN, 0x600 + node, b"\x80" + struct.pack("<HBI", index, subindex, 0x0800_0000)),)


ADMITTED: Final = (
    *(frame(0x000, f"{command}{node:02x}") for command in ("01", "80", "81", "82") for node in range(5)),
    frame(0x080, ""),
    *(frame(0x764, state) for state in ("00", "04", "05", "7f")),
    *(
        wheel(node, word, rpm)
        for node in (1, 2)
        for word in (0x0000, 0x0002, 0x0006, 0x0007, 0x000B, 0x000F, 0x0080, 0x010F)
        for rpm in (-4000, -1, 0, 1, 4000)
    ),
    *(
        position(node, word, counts)
        for node, low, high in ((3, -STEER_END, STEER_END), (4, 0, LIFT_END))
        for word in (0x0000, 0x0002, 0x0006, 0x0007, 0x000B, 0x000F, 0x003F, 0x0080, 0x010F)
        for counts in (low, low + 1, 0, high - 1, high)
    ),
    *(frame(0x600 + node, "4041600000000000") for node in (1, 2, 3, 4)),
    frame(0x601, "40ffff0000000000"),
    frame(0x601, "6000000000000000"),
    frame(0x601, "7000000000000000"),
    frame(0x601, "8000100000000008"),
)

REFUSED: Final = (
    # Network management: stop, unknown commands, strangers, lengths.
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
        (Packet(CAN, address, bytes(6)), f"identifier 0x{address:X} is not listed")
        for address in (
            0x001, 0x07F, 0x081, 0x181, 0x201, 0x301, 0x401, 0x402, 0x403 | EXTENDED, 0x405, 0x500, 0x503,
            0x504, 0x501 | EXTENDED, 0x501 | REMOTE, 0x501 | ERROR, 0x581, 0x600, 0x605, 0x701, 0x763, 0x765,
            0x7E5,
        )
    ),
)  # fmt: skip

SET_POINTS_REFUSED: Final = (
    *(
        (wheel(node, 0x000F, rpm), f"target {rpm} rpm is not within -4000 to 4000 rpm")
        for node in (1, 2)
        for rpm in (4001, -4001, 2**31 - 1, -(2**31))
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
    assert bench.says(packet) == (packet,)
    assert bench.guard.refused == 0
    assert bench.guard.refusals == ()


@pytest.mark.parametrize(("packet", "reason"), REFUSED, ids=str)
def test_an_unlisted_frame_stops_every_axis_that_has_power(bench: Bench, packet: Packet, reason: str) -> None:
    assert bench.refuses(packet) == (reason, ())
    bench.says(wheel(1, 0x000F, 500), position(3, 0x003F, 700), position(4, 0x0006, 9))
    safe = (wheel(1, 0x000F, 0), position(3, 0x010F, 700))
    assert bench.refuses(packet) == (reason, safe)


@pytest.mark.parametrize(("packet", "reason"), SET_POINTS_REFUSED, ids=str)
def test_a_set_point_out_of_bounds_is_replaced_by_its_axis_at_rest(
    bench: Bench, packet: Packet, reason: str
) -> None:
    node = packet.address & 0x7F
    make = wheel if node < 3 else position
    # Never told anything: it has no power, and gets none.
    assert bench.refuses(packet) == (reason, (make(node, 0, 0),))
    bench.says(make(node, 0x000F, 77))
    rest = wheel(node, 0x000F, 0) if node < 3 else position(node, 0x010F, 77)
    assert bench.refuses(packet) == (reason, (rest,))


@pytest.mark.parametrize("word", [0x0000, 0x0002, 0x0006, 0x0007, 0x000B, 0x0080])
def test_the_safe_frame_never_gives_power_to_a_drive_that_has_none(bench: Bench, word: int) -> None:
    bench.says(wheel(1, 0x000F, 100), wheel(1, word, 0), position(4, 0x003F, 50), position(4, word, 60))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, word, 0),)
    assert bench.refuses(position(4, 0x003F, -1))[1] == (position(4, word, 60),)
    assert bench.refuses(frame(0x123, ""))[1] == ()


@pytest.mark.parametrize("word", [0x000F, 0x010F])
def test_the_safe_frame_leaves_power_where_there_is_power(bench: Bench, word: int) -> None:
    bench.says(wheel(2, word, 100), position(3, word, -5))
    assert bench.refuses(frame(0x123, ""))[1] == (wheel(2, 0x000F, 0), position(3, 0x010F, -5))


def test_every_frame_is_judged_in_its_place(bench: Bench) -> None:
    sent = bench.says(
        frame(0x080, ""), wheel(1, 0x000F, 5000), Packet(OPERATOR, 0, b"text"), wheel(2, 0x000F, 300)
    )
    assert sent == (
        frame(0x080, ""), wheel(1, 0x0000, 0), Packet(OPERATOR, 0, b"text"), wheel(2, 0x000F, 300)
    )  # fmt: skip
    assert bench.guard.refused == 1


def test_datagrams_of_the_operator_pass_untouched(bench: Bench) -> None:
    packets = (Packet(OPERATOR, 0x123, b"\xff" * 300), Packet(OPERATOR, 0x501, b""))
    assert bench.says(*packets) == packets
    assert bench.guard.refused == 0


def test_a_link_that_is_not_listed_is_refused(bench: Bench) -> None:
    bench.says(wheel(1, 0x000F, 100))
    packet = Packet(SERIAL, 0x501, struct.pack("<Hi", 0x000F, 200))
    assert bench.refuses(packet) == ("link 'serial' is not listed", (wheel(1, 0x000F, 0),))


def test_packets_and_wakes_reach_the_node(bench: Bench) -> None:
    bench.puppet.wake_at = 77
    assert bench.guard.receive(frame(0x181, "4002"), 5) == Reaction((), 77)
    assert bench.guard.wake(6) == Reaction((), 77)
    assert bench.puppet.heard == [(frame(0x181, "4002"), 5), (None, 6)]


def test_what_a_node_says_to_a_packet_is_judged_as_well(bench: Bench) -> None:
    bench.puppet.says = (wheel(1, 0x000F, 5000),)
    assert bench.guard.receive(frame(0x080, ""), 3).sent == (wheel(1, 0, 0),)
    assert bench.guard.refusals[0].at == 3


def test_refusals_are_all_counted_and_the_newest_kept(machine: Robot) -> None:
    guard = Guarded(Puppet(), rules_for(machine))
    for n in range(REMEMBERED + 5):
        guard.node = Puppet((frame(0x123, f"{n % 256:02x}"),))
        guard.wake(n)
    assert guard.refused == 105
    assert [refusal.at for refusal in guard.refusals] == list(range(5, 105))


# What may be written over SDO: object, sub-index, bytes, values that may, values just beyond.
FOLLOWING: Final = 4_000
WRITES: Final = (
    (1, 0x1017, 0, 2, (100,), (99, 101, 0)),
    (1, 0x1016, 1, 4, (100 << 16 | 200, 0), (100 << 16 | 201, 100 << 16 | 199, 99 << 16 | 200, 1)),
    (1, 0x6007, 0, 2, (3,), (0, 1, 2, 4)),
    (1, 0x605E, 0, 2, (2,), (0, 1, 3, 0xFFFF)),
    (1, 0x1003, 0, 1, (0,), (1,)),
    (1, 0x6040, 0, 2, (0x0000, 0x0002, 0x000B), (0x0001, 0x0006, 0x0007, 0x000F, 0x003F, 0x0080, 0x010F)),
    (1, 0x6402, 0, 2, (1,), (0, 2, 10)),
    (1, 0x2210, 1, 4, (500,), (499, 501)),
    (1, 0x6410, 1, 2, (0, 10_000), (10_001,)),
    (1, 0x6410, 2, 2, (0, 20_000), (20_001,)),
    (1, 0x6410, 5, 2, (1, 40), (0, 41)),
    (1, 0x6410, 4, 4, (1, 4_000), (0, 4_001)),
    (1, 0x607F, 0, 4, (1, 4_000), (0, 4_001)),
    (1, 0x6065, 0, 4, (1, 20_000), (0, 20_001, 2**32 - 1)),
    (1, 0x6060, 0, 1, (3,), (1, 2, 4, 6, 0xFE, 0xFF)),
    (3, 0x6060, 0, 1, (1,), (0, 2, 3, 0xFF)),
    (1, 0x6086, 0, 2, (0,), (1,)),
    (1, 0x6081, 0, 4, (1, 4_000), (0, 4_001)),
    (1, 0x6083, 0, 4, (1, 6_600), (0, 6_601)),
    (1, 0x6084, 0, 4, (6_600,), (6_599, 6_601)),
    (1, 0x6085, 0, 4, (6_600,), (6_599, 6_601)),
    (3, 0x607D, 1, 4, (-STEER_END - FOLLOWING, STEER_END + FOLLOWING), (-STEER_END - FOLLOWING - 1,)),
    (3, 0x607D, 2, 4, (-STEER_END - FOLLOWING, STEER_END + FOLLOWING), (STEER_END + FOLLOWING + 1,)),
    (4, 0x607D, 1, 4, (-FOLLOWING, LIFT_END + FOLLOWING), (-FOLLOWING - 1, LIFT_END + FOLLOWING + 1)),
    # Receive PDOs: the wheels' fourth and the position axes' third carry set-points, the others are off.
    *((1, 0x1400 + n, 1, 4, (0x8000_0201 + 0x100 * n,), (0x201 + 0x100 * n,)) for n in range(3)),
    (1, 0x1403, 1, 4, (0x8000_0501, 0x501), (0x502, 0x8000_0502, 0x500)),
    (3, 0x1402, 1, 4, (0x8000_0403, 0x403), (0x404, 0x503)),
    *((3, 0x1400 + n, 1, 4, (0x8000_0203 + 0x100 * n,), (0x203 + 0x100 * n,)) for n in (0, 1, 3)),
    (1, 0x1403, 2, 1, (1, 255), (0, 2, 253, 254)),
    (1, 0x1603, 0, 1, (0, 2), (1, 3, 8)),
    (1, 0x1603, 1, 4, (0x6040_0010,), (0x6060_0008, 0)),
    (1, 0x1603, 2, 4, (0x60FF_0020,), (0x607A_0020, 0x6083_0020)),
    (3, 0x1602, 2, 4, (0x607A_0020,), (0x60FF_0020,)),
    # Transmit PDOs carry what they like under their own identifiers.
    *(
        (2, 0x1800 + n, 1, 4, (0x4000_0182 + 0x100 * n, 0xC000_0182 + 0x100 * n), (0x182 + 0x100 * n, 0))
        for n in range(4)
    ),
    *((2, 0x1800 + n, 2, 1, (1, 255), (0, 2, 254)) for n in range(4)),
    *((2, 0x1800 + n, 3, 2, (0, 10, 0xFFFF), ()) for n in range(4)),
    *((2, 0x1A00 + n, 0, 1, (0, 3, 8), (9,)) for n in range(4)),
    *((2, 0x1A00 + n, 1, 4, (0, 0x6041_0010, 2**32 - 1), ()) for n in range(4)),
    *((2, 0x1A03, entry, 4, (0, 2**32 - 1), ()) for entry in range(1, 9)),
)
GAINS: Final = (
    (0x60F6, 1, "current_p"), (0x60F6, 2, "current_i"), (0x60F9, 1, "velocity_p"), (0x60F9, 2, "velocity_i"),
    (0x60F9, 4, "velocity_feedforward"), (0x60F9, 5, "acceleration_feedforward"),
    (0x60FB, 1, "position_p"), (0x60FB, 2, "position_i"), (0x60FB, 3, "position_d"),
    (0x60FB, 4, "position_velocity_feedforward"), (0x60FB, 5, "position_acceleration_feedforward"),
)  # fmt: skip


def raw(value: int, size: int) -> bytes:
    return (value & ((1 << 8 * size) - 1)).to_bytes(size, "little")


@pytest.mark.parametrize(("node", "index", "subindex", "size", "may", "beyond"), WRITES)
def test_an_object_may_be_written_within_its_bounds(
    bench: Bench,
    node: int,
    index: int,
    subindex: int,
    *,
    size: int,
    may: Sequence[int],
    beyond: Sequence[int],
) -> None:
    for value in may:
        packet = write(node, index, subindex, raw(value, size))
        assert bench.says(packet) == (packet,)
    for value in beyond:
        reason, sent = bench.refuses(write(node, index, subindex, raw(value, size)))
        assert sent == aborted(node, index, subindex)
        assert f"0x{index:04X}" in reason
        assert "allowed is" in reason
    for wrong in {1, 2, 3, 4} - {size}:
        reason, sent = bench.refuses(write(node, index, subindex, bytes(wrong)))
        assert f"written with {wrong} bytes, it has {size}" in reason
        assert sent == aborted(node, index, subindex)


@pytest.mark.parametrize(("index", "subindex", "name"), GAINS)
def test_gains_are_those_of_the_robot_file(machine: Robot, index: int, subindex: int, name: str) -> None:
    for axis in machine.axes:
        bench = Bench(machine)
        gain = getattr(axis.gains, name)
        packet = write(axis.node, index, subindex, raw(gain, 2))
        assert bench.says(packet) == (packet,)
        for other in (gain + 1, gain - 1):
            assert bench.refuses(write(axis.node, index, subindex, raw(other, 2)))[1] == aborted(
                axis.node, index, subindex
            )


@pytest.mark.parametrize(
    ("index", "subindex"),
    [
        (0x607A, 0), (0x60FF, 0), (0x2062, 0), (0x206B, 0), (0x2030, 0), (0x1010, 1), (0x1011, 1), (0x2000, 0),
        (0x1014, 0), (0x1016, 2), (0x60C5, 0), (0x6098, 0), (0x607D, 1), (0x607D, 2), (0x1404, 1), (0x1600, 1),
        (0x1603, 3), (0x1804, 1), (0x1A00, 9), (0x6040, 1),
    ],
)  # fmt: skip
def test_no_other_object_may_be_written(bench: Bench, index: int, subindex: int) -> None:
    # Node 1 is a wheel: position limits are none of its business.
    reason, sent = bench.refuses(write(1, index, subindex, bytes(4)))
    assert reason.endswith("is not an object that may be written")
    assert sent == aborted(1, index, subindex)


@pytest.mark.parametrize(
    ("payload", "reason"),
    [
        ("2017100002000000", "SDO command 0x20 is not listed"),
        ("2117100002000000", "SDO command 0x21 is not listed"),
        ("2217100064000000", "SDO command 0x22 is not listed"),
        ("3317100064000000", "SDO command 0x33 is not listed"),
        ("0064000000000000", "SDO command 0x00 is not listed"),
        ("0b64000000000000", "SDO command 0x0B is not listed"),
        ("c017100000000000", "SDO command 0xC0 is not listed"),
        ("a317100000000000", "SDO command 0xA3 is not listed"),
        ("e317100000000000", "SDO command 0xE3 is not listed"),
        ("40416000000000", "an SDO request of 7 bytes"),
        ("404160", "an SDO request of 3 bytes"),
        ("", "an SDO request of 0 bytes"),
    ],
)
def test_other_services_are_answered_with_an_abort(bench: Bench, payload: str, reason: str) -> None:
    packet = frame(0x602, payload)
    told, sent = bench.refuses(packet)
    assert told == reason
    assert sent == (
        Packet(CAN, 0x602, b"\x80" + packet.payload[1:4].ljust(3, b"\0") + bytes.fromhex("00000008")),
    )


def test_a_drive_with_power_keeps_its_watch_over_the_bridge(bench: Bench) -> None:
    ends_watch = write(2, 0x1016, 1, bytes(4))
    bench.says(wheel(1, 0x000F, 0))
    assert bench.says(ends_watch) == (ends_watch,)
    for word in (0x000F, 0x010F):
        bench.says(wheel(2, word, 0))
        reason, sent = bench.refuses(ends_watch)
        assert reason == "0x1016:01 set to 0 while node 2 has power"
        assert sent == aborted(2, 0x1016, 1)
        keeps = write(2, 0x1016, 1, raw(100 << 16 | 200, 4))
        assert bench.says(keeps) == (keeps,)
        zero_elsewhere = write(2, 0x1003, 0, bytes(1))
        assert bench.says(zero_elsewhere) == (zero_elsewhere,)
    bench.says(wheel(2, 0x0006, 0))
    assert bench.says(ends_watch) == (ends_watch,)


@pytest.mark.parametrize("command", [0x80, 0x81, 0x82])
@pytest.mark.parametrize("addressed", [0, 2])
def test_a_drive_that_moves_is_not_taken_off_the_bus(bench: Bench, command: int, addressed: int) -> None:
    leave = Packet(CAN, 0x000, bytes((command, addressed)))
    bench.says(wheel(1, 0x000F, 0), wheel(2, 0x000F, 1), position(3, 0x000F, 5))
    assert bench.says(START_NODE) == (START_NODE,)
    reason, sent = bench.refuses(leave)
    assert reason == "node 2 moves and would no longer hear set-points"
    assert sent == (wheel(1, 0x000F, 0), wheel(2, 0x000F, 0), position(3, 0x010F, 5))
    # It was stopped instead, so the next try is allowed; afterwards it counts as without power.
    assert bench.says(leave) == (leave,)
    left = () if addressed == 0 else (wheel(1, 0x000F, 0), position(3, 0x010F, 5))
    assert bench.refuses(frame(0x123, ""))[1] == left


def test_another_drive_may_leave_the_bus(bench: Bench) -> None:
    bench.says(wheel(2, 0x000F, 1))
    leave = frame(0x000, "8001")
    assert bench.says(leave) == (leave,)


@pytest.mark.parametrize(
    ("packet", "moves"),
    [
        (wheel(1, 0x000F, 1), True),
        (wheel(1, 0x000F, -1), True),
        (wheel(1, 0x000F, 0), False),
        (wheel(1, 0x010F, 1), False),
        (wheel(1, 0x0006, 1), False),
        (position(4, 0x003F, 0), True),
        (position(4, 0x003F, 9), True),
        (position(4, 0x000F, 9), False),
        (position(4, 0x010F, 9), False),
    ],
)
def test_what_counts_as_moving(bench: Bench, packet: Packet, *, moves: bool) -> None:
    bench.says(packet)
    leave = frame(0x000, "8000")
    assert (bench.says(leave) != (leave,)) is moves


def test_a_controlword_over_sdo_takes_the_power_away(bench: Bench) -> None:
    bench.says(wheel(1, 0x000F, 0), write(1, 0x6040, 0, b"\x0b\x00"))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, 0x000B, 0),)


def test_an_upload_of_the_controlword_changes_nothing(bench: Bench) -> None:
    bench.says(wheel(1, 0x000F, 0), frame(0x601, "4040600000000000"))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, 0x000F, 0),)
