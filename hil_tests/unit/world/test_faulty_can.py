"""Damaged frames on the CAN bus: sent again, counted by the rules of ISO 11898-1, off the bus and back."""

from emulators.wires.confinement import Condition, Confinement
from emulators.wires.faulty_can import Disturbance, FaultyCanWire
from emulators.world import World
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, frame_bits
from firmware_bridge.wire.can_error import BUS_OFF, CONTROLLER, RESTARTED, TRANSMIT_PASSIVE, decode_report
from hil_tests.unit.world.players import Player, frame

Bus = tuple[World, FaultyCanWire, list[Player]]


def bus_of(*players: Player, depth: int | None = None) -> Bus:
    world, wire = World(), FaultyCanWire(1_000_000, depth=depth)
    for number, player in enumerate(players):
        world.attach(f"node{number}", player, {"can": wire})
    return world, wire, list(players)


def frames(player: Player) -> list[tuple[Nanoseconds, Packet]]:
    return [(at, packet) for at, packet in player.heard if not packet.address & ERROR]


def reports(player: Player) -> list[int]:
    return [packet.address for _, packet in player.heard if packet.address & ERROR]


def test_an_undisturbed_bus_is_as_any_other() -> None:
    world, wire, (_, hearer) = bus_of(Player((0, frame(0x080))), Player())
    world.run(SECOND)
    assert hearer.heard == [(48_000, frame(0x080))]
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
    passive = next(packet for _, packet in sender.heard if packet.address == CONTROLLER)
    assert decode_report(passive.payload)[0] == TRANSMIT_PASSIVE
    assert passive.payload[6] == 128
    assert frames(hearer) == []


def test_a_controller_that_is_off_returns_after_128_times_11_bits_with_what_waited() -> None:
    late = Player((0, frame(0x123)), (2_500_000, frame(0x124)))
    world, wire, (sender, hearer) = bus_of(late, Player((2_600_000, frame(0x200))))
    wire.disturb(Disturbance(sender="node0", end=1_800_000))
    world.run(SECOND)
    off = next(at for at, packet in sender.heard if packet.address == BUS_OFF)
    back = next(at for at, packet in sender.heard if packet.address == RESTARTED)
    assert back - off == 128 * 11 * 1000
    assert [packet.address for _, packet in frames(hearer)] == [0x124], "what was under way is lost"
    assert frames(sender) == [] or frames(sender)[0][0] > back, "off, it hears nothing"
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


def test_a_full_queue_says_so_and_drops_the_newest() -> None:
    world, _, (sender, hearer) = bus_of(Player(*((0, frame(0x100 + k)) for k in range(5))), Player(), depth=3)
    world.run(SECOND)
    assert [packet.address for _, packet in frames(hearer)] == [0x100, 0x101, 0x102]
    assert reports(sender) == [CONTROLLER], "told once until there is room again"


def test_the_counters_by_the_standard() -> None:
    counters = Confinement()

    def condition() -> Condition:
        return counters.condition

    for _ in range(14):
        assert not counters.failed_to_hear(first=True)
    assert counters.failed_to_hear(first=True)
    assert condition() is Condition.PASSIVE
    assert counters.receive == 135
    counters.failed_to_hear(first=True)
    assert counters.receive == 135, "a passive receiver stops to count"
    assert counters.heard()
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
