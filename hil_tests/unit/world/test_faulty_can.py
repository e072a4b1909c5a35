"""Damaged frames on the CAN bus: sent again, counted by the rules of ISO 11898-1, off the bus and back."""

import numpy as np
import pytest

from emulators.wires.confinement import Condition, Confinement
from emulators.wires.disturbance import Disturbance, Effect
from emulators.wires.faulty_can import WAITING, FaultyCanWire
from emulators.world import World, WorldError
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, frame_bits
from firmware_bridge.wire.can_error import (
    BUS_OFF,
    CONTROLLER,
    RECEIVE_OVERFLOW,
    RESTARTED,
    TRANSMIT_OVERFLOW,
    TRANSMIT_PASSIVE,
    Loss,
    decode_report,
)
from hil_tests.unit.world.players import Player, frame

Bus = tuple[World, FaultyCanWire, list[Player]]


def bus_of(*players: Player, depth: int | None = None) -> Bus:
    world, wire = World(), FaultyCanWire(1_000_000, depth=depth)
    for number, player in enumerate(players):
        world.attach(f"node{number}", player, {"can": wire})
    return world, wire, list(players)


def frames(player: Player) -> list[tuple[Nanoseconds, Packet]]:
    return [(at, packet) for at, packet in player.received if not packet.address & ERROR]


def reports(player: Player) -> list[int]:
    return [packet.address for _, packet in player.received if packet.address & ERROR]


def test_an_undisturbed_bus_is_as_any_other() -> None:
    world, wire, (_, hearer) = bus_of(Player((0, frame(0x080))), Player())
    world.run(SECOND)
    assert hearer.received == [(48_000, frame(0x080))]
    assert wire.damaged == 0


def test_a_damaged_frame_is_sent_again_after_the_error_flag() -> None:
    world, wire, (_, hearer) = bus_of(Player((0, frame(0x123, "01"))), Player())
    wire.disturb(Disturbance(count=1))
    world.run(SECOND)
    bits = frame_bits(0x123, b"\1")
    # Without its end of frame of 7 bits; flag and delimiter, 14; the space, 3; and once more.
    assert frames(hearer) == [((bits - 7 + 14 + 3 + bits) * 1000, frame(0x123, "01"))]
    assert wire.damaged == 1


def test_each_damage_costs_the_sender_eight_and_each_good_frame_gives_one_back() -> None:
    story = Player(*((k * MILLISECOND, frame(0x100)) for k in range(5)))
    world, wire, _ = bus_of(story, Player(), Player())
    wire.disturb(Disturbance(count=3))
    world.run(SECOND)
    assert wire.damaged == 3
    assert wire.confinement("node0").transmit == 3 * 8 - 5
    assert wire.confinement("node0").receive == 0
    assert wire.confinement("node1").receive == 0, "three errors, five good frames"


def test_a_sender_whose_frames_are_all_damaged_grows_passive_then_leaves_the_bus() -> None:
    world, wire, (sender, hearer) = bus_of(Player((0, frame(0x123))), Player())
    wire.disturb(Disturbance(sender="node0", end=20 * MILLISECOND))
    world.run(1_900_000)
    assert wire.damaged == 32, "eight each, 256 at the end"
    assert wire.confinement("node0").condition is Condition.OFF
    assert wire.confinement("node1").receive == 32
    assert wire.confinement("node1").condition is Condition.ACTIVE
    assert reports(sender) == [CONTROLLER, BUS_OFF]
    passive = next(packet for _, packet in sender.received if packet.address == CONTROLLER)
    assert decode_report(passive.payload)[0] == TRANSMIT_PASSIVE
    assert passive.payload[6] == 128
    assert frames(hearer) == []


def test_a_controller_that_is_off_returns_after_128_times_11_bits_with_what_waited() -> None:
    late = Player((0, frame(0x123)), (2_500_000, frame(0x124)))
    world, wire, (sender, hearer) = bus_of(late, Player((2_600_000, frame(0x200))))
    wire.disturb(Disturbance(sender="node0", end=1_800_000))
    world.run(SECOND)
    off = next(at for at, packet in sender.received if packet.address == BUS_OFF)
    back = next(at for at, packet in sender.received if packet.address == RESTARTED)
    assert back - off == 128 * 11 * 1000
    assert [packet.address for _, packet in frames(hearer)] == [0x124], "what was under way is lost"
    assert frames(sender) == [] or frames(sender)[0][0] > back, "off, it receives nothing"
    assert wire.confinement("node0").transmit == 0


def test_a_receiver_with_a_bad_plug_disturbs_all_until_it_is_passive() -> None:
    story = Player(*((k * MILLISECOND, frame(0x100 + k)) for k in range(40)))
    world, wire, (_, good, bad) = bus_of(story, Player(), Player())
    wire.disturb(Disturbance(receiver="node2", end=100 * MILLISECOND))
    world.run(SECOND)
    assert [packet.address for _, packet in frames(good)] == [0x100 + k for k in range(40)]
    assert frames(bad) == []
    assert wire.confinement("node2").condition is Condition.PASSIVE
    assert wire.damaged == 15, "nine each, 128 and more after fifteen"
    assert wire.confinement("node1").condition is Condition.ACTIVE


def test_a_full_queue_states_so_and_drops_the_newest() -> None:
    world, _, (sender, hearer) = bus_of(Player(*((0, frame(0x100 + k)) for k in range(5))), Player(), depth=3)
    world.run(SECOND)
    assert [packet.address for _, packet in frames(hearer)] == [0x100, 0x101, 0x102]
    assert reports(sender) == [CONTROLLER], "reported once until there is room again"


def test_the_counters_by_the_standard() -> None:
    counters = Confinement()

    def condition() -> Condition:
        return counters.condition

    for _ in range(14):
        assert not counters.failed_to_receive(first=True)
    assert counters.failed_to_receive(first=True)
    assert condition() is Condition.PASSIVE
    assert counters.receive == 135
    counters.failed_to_receive(first=True)
    assert counters.receive == 135, "a passive receiver stops to count"
    assert counters.received()
    assert (counters.receive, condition()) == (119, Condition.ACTIVE)
    for _ in range(15):
        assert not counters.failed_to_send()
    assert counters.failed_to_send()
    assert counters.transmit == 128
    assert counters.sent()
    assert condition() is Condition.ACTIVE
    counters.transmit = 255
    counters.failed_to_send()
    assert condition() is Condition.OFF
    counters.recover()
    assert (counters.transmit, counters.receive, condition()) == (0, 0, Condition.ACTIVE)


# Lost frames


def test_a_lost_frame_never_reaches_the_bus() -> None:
    world, wire, (_, hearer) = bus_of(
        Player(*((k * MILLISECOND, frame(0x100 + k)) for k in range(4))), Player()
    )
    wire.disturb(Disturbance(sender="node0", begin=MILLISECOND, end=3 * MILLISECOND, effect=Effect.LOSS))
    world.run(SECOND)
    assert [packet.address for _, packet in frames(hearer)] == [0x100, 0x103]
    assert (wire.lost, wire.damaged, wire.frames) == (2, 0, 2)


def test_a_frame_that_overruns_its_receiver_is_right_for_all_others() -> None:
    story = Player(*((k * MILLISECOND, frame(0x100 + k)) for k in range(4)))
    world, wire, (sender, slow, other) = bus_of(story, Player(), Player())
    wire.disturb(Disturbance(receiver="node1", end=3 * MILLISECOND, effect=Effect.OVERRUN))
    world.run(SECOND)
    assert [packet.address for _, packet in frames(slow)] == [0x103]
    assert len(frames(other)) == 4
    (report,) = (packet for _, packet in slow.received if packet.address & ERROR)
    assert decode_report(report.payload) == (RECEIVE_OVERFLOW, Loss.OBJECT), "reported once"
    assert reports(sender) == reports(other) == []
    assert wire.confinement("node1").receive == 0, "nothing was wrong on the bus"


@pytest.mark.parametrize("effect", list(Effect))
def test_a_share_is_drawn_from_a_generator_of_its_own(effect: Effect) -> None:
    def received(seed: int) -> list[int]:
        story = Player(*((k * MILLISECOND, frame(0x100 + k)) for k in range(100)))
        world, wire, (_, hearer, _) = bus_of(story, Player(), Player())
        chance = np.random.default_rng(seed)
        receiver = "node1" if effect is Effect.OVERRUN else None
        wire.disturb(Disturbance(receiver=receiver, effect=effect, share=0.3, generator=chance))
        world.run(SECOND)
        met = wire.damaged + wire.lost + 100 - len(frames(hearer))
        assert met > 15, "of a hundred"
        return [at for at, _ in frames(hearer)]

    assert received(1) == received(1)
    assert received(1) != received(2)


def test_a_disturbance_names_nodes_that_are_there() -> None:
    _, wire, _ = bus_of(Player(), Player())
    with pytest.raises(WorldError, match="no node 'node7'"):
        wire.disturb(Disturbance(sender="node7"))
    with pytest.raises(WorldError, match="no node 'node7'"):
        wire.cut(["node7"])


def test_a_disturbance_of_a_node_that_is_away_meets_it_when_it_is_back() -> None:
    beats = Player(*((k * MILLISECOND, frame(0x100 + k)) for k in range(30)))
    world, wire, (sender, hearer, _) = bus_of(beats, Player(), Player())
    world.run(2_500_000)
    world.detach("node1")
    wire.disturb(Disturbance(receiver="node1", effect=Effect.OVERRUN))
    wire.disturb(Disturbance(sender="node2", effect=Effect.LOSS))
    wire.disturb(Disturbance(receiver="node1", end=20 * MILLISECOND))
    world.run(9_500_000)
    assert wire.damaged == 0, "no one is there to see a frame wrongly"
    world.attach("node1", hearer, {"can": wire})
    world.run(15_500_000)
    assert wire.damaged > 0
    world.run(SECOND)
    assert CONTROLLER in reports(hearer)
    assert len(frames(hearer)) == 3, "those from before it went"
    assert not reports(sender) or wire.confinement("node0").condition is not Condition.OFF
    assert wire.lost == 0


# Cables


def test_a_cut_parts_the_bus_in_two() -> None:
    plan = [Player((MILLISECOND, frame(0x100 + k)), (9 * MILLISECOND, frame(0x200 + k))) for k in range(4)]
    world, wire, players = bus_of(*plan)
    wire.cut(["node2", "node3"])
    world.run(5 * MILLISECOND)
    assert [[p.address for _, p in frames(player)] for player in players] == [
        [0x101],
        [0x100],
        [0x103],
        [0x102],
    ]
    wire.repair()
    world.run(SECOND)
    assert all(len(frames(player)) == 4 for player in players)
    assert all(not reports(player) for player in players)


def test_a_node_alone_repeats_its_frame_until_it_is_passive_and_sends_it_when_the_cable_is_whole() -> None:
    many = Player(*((k * MILLISECOND, frame(0x100 + k)) for k in range(20)))
    world, wire, (sender, hearer) = bus_of(many, Player())
    wire.cut(["node1"])
    world.run(50 * MILLISECOND)
    assert frames(hearer) == []
    assert wire.confinement("node0").condition is Condition.PASSIVE
    assert wire.confinement("node0").transmit == 128, "an error of acknowledgement leads no further"
    wire.repair()
    world.run(SECOND)
    sent = [packet.address for _, packet in frames(hearer)]
    assert sent[:3] == [0x100, 0x101, 0x102], "the oldest ones have waited"
    assert len(sent) <= WAITING + 3, "there is no room for more; three had come while it was not yet passive"
    assert wire.lost == 20 - len(sent)
    assert wire.confinement("node0").transmit == 128 - len(sent)
    assert TRANSMIT_OVERFLOW in {
        decode_report(p.payload)[0] for _, p in sender.received if p.address == CONTROLLER
    }


def test_a_node_that_joins_acknowledges_what_has_waited() -> None:
    world, wire, _ = bus_of(Player((0, frame(0x100))), Player())
    wire.cut(["node1"])
    world.run(10 * MILLISECOND)
    late = Player()
    world.attach("late", late, {"can": wire})
    world.run(SECOND)
    assert [packet.address for _, packet in frames(late)] == [0x100]


def test_swapped_wires_destroy_everything_as_soon_as_their_node_wants_to_say_something() -> None:
    talker = Player(*((k * MILLISECOND, frame(0x100 + k)) for k in range(12)))
    swapped = Player((4_500_000, frame(0x300)))
    world, wire, (_, hearer, not_receiving) = bus_of(talker, Player(), swapped)
    wire.swap(["node2"])
    world.run(11_900_000)
    assert [packet.address for _, packet in frames(hearer)] == [0x100 + k for k in range(5)]
    assert frames(not_receiving) == []
    assert wire.confinement("node2").condition is Condition.PASSIVE
    assert wire.damaged > 32, "the talker has left the bus at least once"
    wire.repair()
    world.run(SECOND)
    assert 0x300 in {packet.address for _, packet in frames(hearer)}
    assert wire.confinement("node0").condition is Condition.ACTIVE


# Controllers


@pytest.mark.parametrize("until", [5 * MILLISECOND, 200 * MILLISECOND])
def test_a_controller_that_is_thrown_off_stays_off_until_it_is_restarted(until: Nanoseconds) -> None:
    story = Player(*((k * MILLISECOND, frame(0x100 + k)) for k in range(300)))
    world, wire, (sender, hearer) = bus_of(story, Player((100 * MILLISECOND, frame(0x700))))
    wire.throw_off("node0", until)
    world.run(SECOND)
    assert wire.damaged == 32
    off, back = (
        next(at for at, p in sender.received if p.address == event) for event in (BUS_OFF, RESTARTED)
    )
    assert back == max(until, off + 128 * 11 * 1000)
    instants = [at for at, _ in frames(hearer)]
    assert back < instants[0] < 299 * MILLISECOND < instants[-1]


def test_when_all_is_well_again_the_bus_is_the_plain_one() -> None:
    """Its frames come when those of a bus come that never had a fault."""

    def received(*, faulty: bool) -> list[tuple[Nanoseconds, Packet]]:
        story = Player(*((k * MILLISECOND, frame(0x100, "0102")) for k in range(500)))
        world, wire, (_, hearer, _) = bus_of(story, Player(), Player())
        if faulty:
            wire.disturb(Disturbance(end=5 * MILLISECOND, count=12))
            wire.cut(["node1"])
        world.run(20 * MILLISECOND)
        wire.repair()
        world.run(SECOND)
        assert wire.confinement("node0").transmit == 0
        return [(at, packet) for at, packet in frames(hearer) if at > 300 * MILLISECOND]

    assert received(faulty=True) == received(faulty=False)
