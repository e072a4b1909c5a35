"""The world: order, time, physics, and that two runs are one."""

import hashlib

import hypothesis.strategies as st
import pytest
from hypothesis import given, settings

from emulators.wires import CanWire, DatagramWire
from emulators.world import MOST_KEPT, World, WorldError
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds
from hil_tests.lanes import examples
from hil_tests.unit.world.players import Echo, Player, Ticks, frame


class Alarm:
    """Wakes at the instants of a list, and writes its name into a common book."""

    def __init__(self, name: str, book: list[str], *times: Nanoseconds) -> None:
        self._name = name
        self._book = book
        self._times = list(times)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        raise AssertionError((packet, now))

    def wake(self, now: Nanoseconds) -> Reaction:
        self._book.append(f"{self._name}{now}")
        return Reaction((), self._times.pop(0) if self._times else NEVER)


def test_every_node_is_first_woken_at_the_instant_of_its_arrival() -> None:
    world, first, late = World(), Player(), Player()
    world.attach("first", first, {})
    world.run(5)
    world.attach("late", late, {})
    world.run(9)
    assert first.woken == [0]
    assert late.woken == [5]
    assert world.now == 9


def test_what_happens_at_one_instant_happens_in_the_order_in_which_it_was_requested() -> None:
    world = World()
    book: list[str] = []
    world.attach("a", Alarm("a", book, 7, 9), {})
    world.attach("b", Alarm("b", book, 3, 7, 9), {})
    world.attach("c", Alarm("c", book, 7), {})
    world.run(20)
    assert book == ["a0", "b0", "c0", "b3", "a7", "c7", "b7", "a9", "b9"]


def test_a_new_command_replaces_the_old_one() -> None:
    class Sleeper(Player):
        def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
            super().receive(packet, now)
            return Reaction((), now + 5)

        def wake(self, now: Nanoseconds) -> Reaction:
            super().wake(now)
            return Reaction((), 100 if now == 0 else NEVER)

    world, link, sleeper = World(), DatagramWire(), Sleeper()
    world.attach("sleeper", sleeper, {"operator": link})
    world.attach("caller", Player((50, Packet("operator", 0, b"x"))), {"operator": link})
    world.run(200)
    assert sleeper.woken == [0, 55]


def test_a_command_for_the_past_means_now_and_a_run_includes_its_end() -> None:
    world = World()
    book: list[str] = []
    world.attach("a", Alarm("a", book, 10, 4), {})
    world.run(10)
    assert book == ["a0", "a10", "a10"]


def test_time_that_stands_still_is_noticed() -> None:
    class Restless(Player):
        def wake(self, now: Nanoseconds) -> Reaction:
            return Reaction((), now)

    world = World()
    world.attach("restless", Restless(), {})
    with pytest.raises(WorldError, match="time stands still at 0 ns"):
        world.run(1)


def test_the_physics_moves_before_anything_is_delivered() -> None:
    physics = Ticks(100)
    world, link = World(physics), DatagramWire(delay=250)
    seen: list[tuple[Nanoseconds, Nanoseconds]] = []
    link.observe(lambda now, _sender, _packet: seen.append((now, physics.reached)))
    world.attach("caller", Player((0, Packet("operator", 0, b"x"))), {"operator": link})
    world.attach("hearer", Player(), {"operator": link})
    world.run(1000)
    assert seen == [(250, 200)]
    assert physics.reached == 1000
    assert physics.requested == sorted(set(physics.requested)), "each instant is requested once"


def test_nodes_that_the_physics_names_are_woken_at_the_instant_it_reached_and_may_send() -> None:
    class Siren(Player):
        def wake(self, now: Nanoseconds) -> Reaction:
            self.woken.append(now)
            return Reaction((Packet("operator", 0, b"!"),) if now else (), NEVER)

    physics = Ticks(100, (300, "siren"), (700, "siren"))
    world, link, siren, hearer = World(physics), DatagramWire(delay=50), Siren(), Player()
    world.attach("siren", siren, {"operator": link})
    world.attach("hearer", hearer, {"operator": link})
    world.run(1000)
    assert siren.woken == [0, 300, 700]
    assert [now for now, _ in hearer.received] == [350, 750]


def test_the_physics_may_name_a_node_that_is_gone_but_none_that_never_was() -> None:
    world = World(Ticks(100, (300, "gone")))
    world.attach("gone", Player(), {})
    world.detach("gone")
    world.run(1000)
    world = World(Ticks(100, (300, "no one")))
    with pytest.raises(WorldError, match="wakes 'no one'"):
        world.run(1000)


def test_a_silent_node_neither_receives_nor_sends_but_lives_on() -> None:
    world, link = World(), DatagramWire()
    plan = [(at, Packet("operator", 0, bytes([at]))) for at in (10, 20, 30)]
    one, two = Player(*plan), Player(*plan)
    world.attach("one", one, {"operator": link})
    world.attach("two", two, {"operator": link})
    world.silence("one", 20)
    world.run(25)
    assert [now for now, _ in one.received] == [10]
    assert [now for now, _ in two.received] == [10]
    assert one.woken == [0, 10, 20]
    world.silence("one", NEVER)
    world.run(100)
    assert [now for now, _ in one.received] == [10, 30]


def test_a_detached_node_is_gone_and_its_name_is_free() -> None:
    world, link = World(), DatagramWire()
    plan = [(at, Packet("operator", 0, b"x")) for at in (10, 20)]
    one, two, again = Player(*plan), Player(*plan), Player()
    world.attach("one", one, {"operator": link})
    world.attach("two", two, {"operator": link})
    world.run(15)
    world.detach("one")
    world.attach("one", again, {"operator": link})
    world.run(100)
    assert one.woken == [0, 10]
    assert [now for now, _ in two.received] == [10]
    assert [now for now, _ in again.received] == [20]


@pytest.mark.parametrize("mistake", ["silence", "detach"])
def test_a_wrong_name_is_answered_with_the_right_ones(mistake: str) -> None:
    world = World()
    world.attach("left", Player(), {})
    with pytest.raises(WorldError, match="no node 'lfet'; there are: left"):
        world.silence("lfet", 0) if mistake == "silence" else world.detach("lfet")


def test_wrong_wiring_is_refused() -> None:
    world, wire = World(), CanWire(1_000_000)
    world.attach("one", Player((5, Packet("serial", 0, b""))), {"can": wire})
    with pytest.raises(WorldError, match="'one' already"):
        world.attach("one", Player(), {})
    with pytest.raises(WorldError, match="another world"):
        World().attach("two", Player(), {"can": wire})
    with pytest.raises(WorldError, match="sends on 'serial'"):
        world.run(10)
    with pytest.raises(WorldError, match="run back"):
        world.run(1)


def test_the_trace_is_the_sum_of_its_lines() -> None:
    world, bus = World(), CanWire(1_000_000, name="can0")
    world.attach("master", Player((0, frame(0x080)), (0, frame(0x701, "05"))), {"can": bus})
    world.attach("drive", Player(), {"can": bus})
    world.attach("other", Player(), {"can": bus})
    world.run(SECOND)
    # 48 bits, 3 bits of space, 56 bits: one line for each frame, for any number of receivers.
    lines = b"48000 can0 master 00000080 \n" + b"106000 can0 master 00000701 05\n"
    assert world.trace_sha256 == hashlib.sha256(lines).hexdigest()


def test_each_wire_has_a_hash_of_its_own_and_observers_see_the_lines() -> None:
    world, bus, link = World(), CanWire(1_000_000, name="bus"), DatagramWire(name="air")
    other = Packet("operator", 0, b"\x01")
    world.attach("bridge", Player((0, frame(0x080)), (SECOND, other)), {"can": bus, "operator": link})
    world.attach("drive", Player(), {"can": bus})
    seen: list[bytes] = []
    world.observe(seen.append)
    assert world.links_sha256 == {}
    moment = world.snapshot()
    world.run(SECOND)
    assert seen == [b"48000 bus bridge 00000080 \n", b"1000000000 air bridge 00000000 01\n"]
    whole = {"air": hashlib.sha256(seen[1]).hexdigest(), "bus": hashlib.sha256(seen[0]).hexdigest()}
    assert world.links_sha256 == whole
    world.restore(moment)
    assert world.links_sha256 == {}
    world.run(SECOND)
    assert world.links_sha256 == whole


Story = list[tuple[int, int, int, bytes]]
stories = st.lists(
    st.tuples(
        st.integers(0, 3), st.integers(0, 2 * MILLISECOND), st.integers(0, 0x7FF), st.binary(max_size=8)
    ),
    max_size=30,
)


def reported(story: Story, *stops: Nanoseconds) -> tuple[str, list[list[tuple[Nanoseconds, Packet]]], int]:
    world, bus = World(Ticks(100_000, (500_000, "0"), (1_500_000, "2"))), CanWire(500_000)
    players = [
        Player(*((at, Packet("can", address, content)) for who, at, address, content in story if who == name))
        for name in range(3)
    ]
    echo = Echo(lambda packet: [Packet("can", 0x700, packet.payload)] if packet.address < 0x100 else [])
    for name, player in enumerate(players):
        world.attach(str(name), player, {"can": bus})
    world.attach("echo", echo, {"can": bus})
    for stop in (*sorted(stops), 20 * MILLISECOND):
        world.run(stop)
    return world.trace_sha256, [player.received for player in players], bus.bits


@settings(max_examples=examples(60))
@given(stories, st.lists(st.integers(0, 20 * MILLISECOND), max_size=5))
def test_two_runs_are_one_run_however_often_they_are_halted(story: Story, stops: list[Nanoseconds]) -> None:
    assert reported(story) == reported(story, *stops)


def datagram(number: int) -> Packet:
    return Packet("operator", 0, number.to_bytes(2, "big"))


def test_what_comes_to_a_node_that_does_not_run_waits_for_it_and_then_it_is_woken() -> None:
    world, link = World(), DatagramWire()
    sleeper = Player((20, datagram(1)), (60, datagram(2)))
    caller = Player((30, datagram(3)), (40, datagram(4)), (70, datagram(5)))
    world.attach("sleeper", sleeper, {"operator": link})
    world.attach("caller", caller, {"operator": link})
    world.run(10)
    world.suspend("sleeper")
    world.run(50)
    before = world.snapshot()
    assert (sleeper.received, sleeper.woken, caller.received) == ([], [0], [])
    world.resume("sleeper")
    world.run(90)
    went = world.trace_sha256
    assert sleeper.received == [(50, datagram(3)), (50, datagram(4)), (70, datagram(5))]
    assert sleeper.woken == [0, 50, 60]
    assert caller.received == [(50, datagram(1)), (60, datagram(2))]
    world.restore(before)
    world.resume("sleeper")
    world.run(90)
    assert world.trace_sha256 == went


def test_as_much_waits_for_a_node_that_does_not_run_as_a_socket_holds() -> None:
    world, link, sleeper = World(), DatagramWire(), Player()
    world.attach("sleeper", sleeper, {"operator": link})
    world.attach("caller", Player(*((10, datagram(number)) for number in range(300))), {"operator": link})
    world.suspend("sleeper")
    world.run(20)
    world.resume("sleeper")
    world.run(30)
    assert [packet for _, packet in sleeper.received] == [datagram(number) for number in range(MOST_KEPT)]
