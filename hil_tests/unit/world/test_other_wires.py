"""The serial line's byte times and buffers, the datagram link's delay, jitter and loss."""

import numpy as np
import pytest

from emulators.wires import DatagramWire, Inbox, SerialWire
from emulators.world import World, WorldError
from firmware_bridge.packet import Packet
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds
from hil_tests.unit.world.players import Player


def line(wire: SerialWire, sender: Player, hearer: Player) -> World:
    world = World()
    world.attach("pc", sender, {"serial": wire})
    world.attach("board", hearer, {"serial": wire})
    return world


def test_every_byte_takes_ten_bits_and_fractions_do_not_add_up() -> None:
    hearer = Player()
    line(SerialWire(115_200), Player((0, Packet("serial", 0, bytes(range(100))))), hearer).run(SECOND)
    assert [packet.payload[0] for _, packet in hearer.received] == list(range(100))
    assert [now for now, _ in hearer.received] == [(k + 1) * 10 * SECOND // 115_200 for k in range(100)]


def test_bytes_queue_behind_those_that_are_being_sent_and_both_ways_are_free() -> None:
    one = Player((0, Packet("serial", 0, b"ab")), (500 * MICROSECOND, Packet("serial", 0, b"c")))
    two = Player((500 * MICROSECOND, Packet("serial", 0, b"z")))
    line(SerialWire(10_000), one, two).run(SECOND)
    assert [(now // MILLISECOND, packet.payload) for now, packet in two.received] == [
        (1, b"a"),
        (2, b"b"),
        (3, b"c"),
    ]
    assert one.received == [(1_500 * MICROSECOND, Packet("serial", 0, b"z"))]


def test_a_late_reader_gets_chunks_and_loses_what_its_buffer_cannot_hold() -> None:
    # 1 byte a millisecond, read every 10 ms, 8 bytes of room: bytes 9 and 10 of each ten are lost.
    wire = SerialWire(10_000, {"board": Inbox(buffer_bytes=8, read_every=10 * MILLISECOND)})
    hearer = Player()
    line(wire, Player((500 * MICROSECOND, Packet("serial", 0, bytes(range(20))))), hearer).run(SECOND)
    assert hearer.received == [
        (10 * MILLISECOND, Packet("serial", 0, bytes(range(8)))),
        (20 * MILLISECOND, Packet("serial", 0, bytes([9, *range(10, 17)]))),
        (30 * MILLISECOND, Packet("serial", 0, bytes([19]))),
    ]
    assert wire.overruns("board") == 3
    assert wire.overruns("pc") == 0


def test_a_serial_line_has_two_ends() -> None:
    wire = SerialWire(9_600)
    world = line(wire, Player(), Player())
    with pytest.raises(WorldError, match="two ends"):
        world.attach("third", Player(), {"serial": wire})


def test_a_detached_end_sends_no_more() -> None:
    wire, hearer = SerialWire(10_000), Player()
    world = line(wire, Player((0, Packet("serial", 0, b"abc"))), hearer)
    world.run(1_500 * MICROSECOND)
    world.detach("pc")
    world.run(SECOND)
    assert [packet.payload for _, packet in hearer.received] == [b"a"]


def test_lines_that_cannot_be_are_refused() -> None:
    with pytest.raises(WorldError, match="0 baud"):
        SerialWire(0)
    with pytest.raises(WorldError, match="inbox of 'x'"):
        SerialWire(9_600, {"x": Inbox(0, 1)})


def received_times(wire: DatagramWire, count: int) -> list[tuple[Nanoseconds, bytes]]:
    world, hearer = World(), Player()
    plan = ((k * MILLISECOND, Packet("operator", 0, k.to_bytes(2, "big"))) for k in range(count))
    world.attach("operator", Player(*plan), {"operator": wire})
    world.attach("bridge", hearer, {"operator": wire})
    world.run(SECOND * count)
    return [(now, packet.payload) for now, packet in hearer.received]


def test_without_chance_every_datagram_arrives_after_the_delay() -> None:
    assert received_times(DatagramWire(delay=3 * MILLISECOND), 2) == [
        (3 * MILLISECOND, b"\0\0"),
        (4 * MILLISECOND, b"\0\1"),
    ]


def test_jitter_stays_in_bounds_and_overtakes() -> None:
    wire = DatagramWire(5 * MILLISECOND, jitter=4 * MILLISECOND, generator=np.random.default_rng(1))
    times = received_times(wire, 500)
    late = [now - int.from_bytes(content, "big") * MILLISECOND - 5 * MILLISECOND for now, content in times]
    assert len(times) == 500
    assert all(0 <= extra <= 4 * MILLISECOND for extra in late)
    assert max(late) > 3 * MILLISECOND
    assert [content for _, content in times] != sorted(content for _, content in times)


def test_loss_is_counted_and_the_generator_decides() -> None:
    def lossy(seed: int) -> DatagramWire:
        return DatagramWire(loss=0.3, generator=np.random.default_rng(seed))

    wire = lossy(1)
    times = received_times(wire, 1000)
    assert wire.sent == 1000
    assert len(times) == 1000 - wire.lost
    assert 240 < wire.lost < 360
    assert received_times(lossy(1), 1000) == times
    assert received_times(lossy(2), 1000) != times


@pytest.mark.parametrize(
    ("delay", "jitter", "loss"), [(-1, 0, 0.0), (0, -1, 0.0), (0, 0, 1.1), (0, 0, 0.5), (0, 5, 0.0)]
)
def test_links_that_cannot_be(delay: Nanoseconds, jitter: Nanoseconds, loss: float) -> None:
    with pytest.raises(WorldError, match="link 'operator'"):
        DatagramWire(delay, jitter, loss)
