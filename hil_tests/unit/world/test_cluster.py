"""Several nodes and their physics as one."""

import pytest

from emulators.gateway import Cluster
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds
from hil_tests.unit.world.players import Echo, Player, Ticks, frame


def test_members_wake_when_they_are_due_and_their_packets_reach_the_bus_and_the_others() -> None:
    one, two = Player((10, frame(0x181)), (30, frame(0x182))), Player((20, frame(0x281)))
    cluster = Cluster({"one": one, "two": two})
    assert cluster.wake(0) == Reaction((), 10)
    assert cluster.wake(10) == Reaction((frame(0x181),), 20)
    assert cluster.wake(20) == Reaction((frame(0x281),), 30)
    assert cluster.wake(35) == Reaction((frame(0x182),), NEVER)
    assert one.woken == [0, 10, 35]
    assert one.received == [(20, frame(0x281))]
    assert two.received == [(10, frame(0x181)), (35, frame(0x182))]


def test_after_a_pause_who_answers_is_received_before_the_one_who_has_waited_for_it() -> None:
    class Waiting(Player):
        def wake(self, now: Nanoseconds) -> Reaction:
            self.woken.append(now)
            return Reaction((), NEVER if now else 500)

        def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
            super().receive(packet, now)
            return Reaction((), NEVER)

    patient, other = Waiting(), Player((10, frame(0x581)))
    cluster = Cluster({"gateway": patient, "far": other})
    cluster.wake(0)
    assert cluster.wake(700).sent == (frame(0x581),)
    assert patient.received == [(700, frame(0x581))]
    assert patient.woken == [0]


def test_a_packet_from_the_bus_reaches_every_member_and_answers_are_exchanged() -> None:
    def answer(packet: Packet) -> list[Packet]:
        return [frame(0x281)] if packet.address == 0x080 else []

    echo, hearer = Echo(answer), Player()
    cluster = Cluster({"echo": echo, "hearer": hearer})
    assert cluster.receive(frame(0x080), 5).sent == (frame(0x281),)
    assert hearer.received == [(5, frame(0x080)), (5, frame(0x281))]
    assert echo.received == [(5, frame(0x080))]


def test_the_physics_is_polled_and_wakes_members_at_the_instant_it_reached() -> None:
    class Siren(Player):
        def wake(self, now: Nanoseconds) -> Reaction:
            self.woken.append(now)
            return Reaction((frame(0x081),) if now else (), NEVER)

    physics, siren, other = Ticks(100, (300, "siren")), Siren(), Player()
    cluster = Cluster({"siren": siren, "other": other}, physics, poll=MILLISECOND)
    assert cluster.wake(0) == Reaction((), MILLISECOND)
    assert cluster.wake(950) == Reaction((frame(0x081),), 950 + MILLISECOND)
    assert physics.reached == 900
    assert siren.woken == [0, 300]
    assert other.received == [(300, frame(0x081))]
    cluster.receive(frame(0x080), 1_250)
    assert physics.reached == 1_200


def test_a_silent_member_neither_receives_nor_sends_but_lives_on() -> None:
    one, two = Player((10, frame(0x181)), (20, frame(0x182))), Player()
    cluster = Cluster({"one": one, "two": two})
    cluster.silence("one", 15)
    cluster.wake(0)
    assert cluster.wake(10).sent == (frame(0x181),)
    assert cluster.wake(20).sent == ()
    cluster.receive(frame(0x080), 25)
    assert one.received == []
    assert one.woken == [0, 10, 20]
    assert two.received == [(10, frame(0x181)), (25, frame(0x080))]


def test_a_member_that_is_not_there_cannot_be_silenced() -> None:
    with pytest.raises(KeyError):
        Cluster({"one": Player()}).silence("two", 0)
