"""The CAN bus: exact times, arbitration, reception by all other nodes, load."""

import hypothesis.strategies as st
import pytest
from hypothesis import given, settings

from emulators.wires import CanWire
from emulators.world import World, WorldError
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE, frame_bits
from hil_tests.lanes import examples
from hil_tests.unit.world.players import Echo, Player, frame

Bus = tuple[World, CanWire, list[Player], list[tuple[Nanoseconds, str, int]]]


def bus_of(*players: Player, bit_rate: int = 1_000_000) -> Bus:
    world, wire = World(), CanWire(bit_rate)
    seen: list[tuple[Nanoseconds, str, int]] = []
    wire.observe(lambda now, sender, packet: seen.append((now, sender, packet.address)))
    for number, player in enumerate(players):
        world.attach(f"node{number}", player, {"can": wire})
    return world, wire, list(players), seen


@pytest.mark.parametrize(
    ("bit_rate", "end"),
    [(1_000_000, 48_000), (800_000, 60_000), (500_000, 96_000), (125_000, 384_000), (20_000, 2_400_000)],
)
def test_a_frame_takes_its_bits_at_the_bit_rate(bit_rate: int, end: Nanoseconds) -> None:
    world, _, (_, hearer), _ = bus_of(Player((0, frame(0x080))), Player(), bit_rate=bit_rate)
    world.run(SECOND)
    assert hearer.received == [(end, frame(0x080))]


@pytest.mark.parametrize("bit_rate", [0, -1, 83_333, 3])
def test_a_bit_is_a_whole_number_of_nanoseconds(bit_rate: int) -> None:
    with pytest.raises(WorldError, match="whole number of nanoseconds"):
        CanWire(bit_rate)


def test_everybody_receives_but_the_sender() -> None:
    world, _, (one, two, three), _ = bus_of(Player((0, frame(0x123, "01"))), Player(), Player())
    world.run(SECOND)
    assert one.received == []
    assert two.received == three.received == [(frame_bits(0x123, b"\1") * 1000, frame(0x123, "01"))]


def test_frames_keep_the_interframe_space() -> None:
    world, _, _, seen = bus_of(Player((0, frame(0x080)), (0, frame(0x080)), (51_500, frame(0x080))), Player())
    world.run(SECOND)
    assert [now for now, _, _ in seen] == [48_000, 48_000 + 51_000, 48_000 + 2 * 51_000]


def test_a_frame_that_comes_in_the_interframe_space_waits_for_its_end() -> None:
    world, _, _, seen = bus_of(Player((0, frame(0x080)), (49_000, frame(0x080))), Player())
    world.run(SECOND)
    assert [now for now, _, _ in seen] == [48_000, 99_000]


def test_nodes_that_begin_at_one_instant_arbitrate_whichever_was_first() -> None:
    low, high = Player((7, frame(0x700))), Player((7, frame(0x080)))
    world, _, _, seen = bus_of(low, high)
    world.run(SECOND)
    assert [address for _, _, address in seen] == [0x080, 0x700]


def test_the_lowest_of_the_waiting_heads_goes_next_and_a_queue_keeps_its_order() -> None:
    one = Player((0, frame(0x300)), (1, frame(0x200)), (1, frame(0x001)))
    two = Player((1, frame(0x123 | REMOTE)), (1, frame(0x123 << 18 | EXTENDED)))
    three = Player((1, frame(0x123)))
    world, wire, _, seen = bus_of(one, two, three)
    world.run(SECOND)
    order = [0x300, 0x123, 0x123 | REMOTE, 0x123 << 18 | EXTENDED, 0x200, 0x001]
    assert [address for _, _, address in seen] == order
    assert wire.clashes == 0


def drive_that_answers_sync(address: int) -> Echo:
    return Echo(lambda packet: [Packet("can", address, bytes(8))] if packet.address == 0x080 else [])


def test_answers_to_one_frame_come_in_the_order_of_their_identifiers() -> None:
    world, wire = World(), CanWire(1_000_000)
    master = Player((0, frame(0x080)))
    world.attach("master", master, {"can": wire})
    for node in (3, 1, 4, 2):
        world.attach(f"drive{node}", drive_that_answers_sync(0x280 + node), {"can": wire})
    world.run(SECOND)
    assert [packet.address for _, packet in master.received] == [0x281, 0x282, 0x283, 0x284]
    at = 48_000
    for received_at, packet in master.received:
        at += 3_000 + frame_bits(packet.address, packet.payload) * 1_000
        assert received_at == at


def test_two_nodes_with_one_identifier_are_counted() -> None:
    world, wire, _, _ = bus_of(Player((0, frame(0x181))), Player((0, frame(0x181))))
    world.run(SECOND)
    assert wire.clashes == 1


def test_a_frame_whose_sender_is_cut_off_under_way_is_destroyed() -> None:
    world, wire, (_, hearer), _ = bus_of(Player((0, frame(0x080)), (0, frame(0x081))), Player())
    world.silence("node0", 47_999)
    world.run(SECOND)
    assert hearer.received == []
    assert (wire.frames, wire.destroyed) == (1, 1)


def test_a_frame_whose_sender_is_detached_under_way_is_destroyed_and_the_bus_goes_on() -> None:
    world, wire, (_, hearer), _ = bus_of(Player((0, frame(0x080))), Player((9, frame(0x700))))
    world.run(1_000)
    world.detach("node0")
    third = Player()
    world.attach("third", third, {"can": wire})
    world.run(SECOND)
    assert hearer.received == []
    assert [packet.address for _, packet in third.received] == [0x700]


def test_links_have_the_names_that_their_nodes_give_them() -> None:
    world, wire = World(), CanWire(1_000_000)
    hearer = Player()
    world.attach("one", Player((0, frame(0x080))), {"can": wire})
    world.attach("two", hearer, {"bus": wire})
    world.run(SECOND)
    assert hearer.received == [(48_000, Packet("bus", 0x080, b""))]


def test_what_is_no_frame_is_refused_where_it_is_sent() -> None:
    world, _, _, _ = bus_of(Player((0, Packet("can", ERROR, b""))))
    with pytest.raises(ValueError, match="not a frame"):
        world.run(SECOND)


def test_the_load_counts_frames_and_spaces() -> None:
    world, wire, _, _ = bus_of(Player(*((k * MILLISECOND, frame(0x080)) for k in range(200))), Player())
    world.run(SECOND)
    assert wire.frames == 200
    assert wire.bits == 200 * 48
    assert wire.load_percent() == pytest.approx(200 * 51e-6 * 100)
    assert wire.peak_percent() == pytest.approx(100 * 51e-6 / 0.1 * 100)


def test_a_bus_that_never_rests_is_full() -> None:
    world, wire, _, _ = bus_of(Player(*((0, frame(0x080)) for _ in range(20_000))), Player())
    world.run(SECOND)
    assert wire.load_percent() == pytest.approx(100, abs=0.01)
    assert 99.9 < wire.peak_percent() <= 100


@settings(max_examples=examples(50))
@given(
    st.lists(
        st.tuples(st.integers(0, 3), st.integers(0, 3_000_000), st.integers(0, 0x7FF), st.binary(max_size=8)),
        max_size=40,
    )
)
def test_the_bus_carries_everything_once_in_whole_bits_and_one_at_a_time(
    story: list[tuple[int, int, int, bytes]],
) -> None:
    players = [
        Player(*((at, Packet("can", a, c)) for who, at, a, c in story if who == own)) for own in range(4)
    ]
    world, wire, _, seen = bus_of(*players)
    world.run(SECOND)
    assert sorted(address for _, _, address in seen) == sorted(address for _, _, address, _ in story)
    for number, player in enumerate(players):
        assert len(player.received) == len(story) - sum(who == number for who, _, _, _ in story)
        begun = None
        for ended, packet in player.received:
            start = ended - frame_bits(packet.address, packet.payload) * 1_000
            assert begun is None or start >= begun + 3_000
            begun = ended
    assert wire.frames == len(story)


class Choosy(Player):
    """Listens to one identifier, until it listens to another."""

    wanted = 0x100

    def listens(self, packet: Packet) -> bool:
        return packet.address == self.wanted


def test_a_node_behind_an_acceptance_filter_receives_what_it_listens_to_at_that_time() -> None:
    plan = [(at * MILLISECOND, frame(address)) for at in range(4) for address in (0x100, 0x200)]
    choosy, open_minded = Choosy(), Player()
    world, wire, _, seen = bus_of(Player(*plan), choosy, open_minded)
    world.run(2 * MILLISECOND - 1)
    choosy.wanted = 0x200
    world.run(SECOND)
    assert [packet.address for _, packet in choosy.received] == [0x100, 0x100, 0x200, 0x200]
    assert len(open_minded.received) == len(seen) == wire.frames == len(plan)
