"""Effects of a fault on a datagram link, beside its own delay, jitter and loss."""

import numpy as np
import pytest

from emulators.wires import DatagramWire, Impairment
from emulators.world import World
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.unit.world.players import Player

COUNT = 100
Received = list[tuple[Nanoseconds, bytes]]


def carried(*impairments: Impairment, jitter: Nanoseconds = 0) -> tuple[Received, DatagramWire]:
    """Return the arrivals of a datagram each ms, by a link of 1 ms and its own chance."""
    wire = DatagramWire(MILLISECOND, jitter, 0.0, np.random.default_rng(7))
    world, hearer = World(), Player()
    story = Player(*((k * MILLISECOND, Packet("operator", 0, bytes((k,)))) for k in range(COUNT)))
    world.attach("operator", story, {"operator": wire})
    world.attach("bridge", hearer, {"operator": wire})
    for one in impairments:
        wire.impair(one)
    world.run(SECOND)
    return [(at, packet.payload) for at, packet in hearer.received], wire


def test_datagrams_of_a_time_are_lost() -> None:
    received, wire = carried(Impairment(begin=10 * MILLISECOND, end=20 * MILLISECOND, lost=True))
    assert [payload[0] for _, payload in received] == [*range(10), *range(20, COUNT)]
    assert wire.lost == 10


def test_late_datagrams_are_overtaken_at_the_end() -> None:
    received, _ = carried(Impairment(end=5 * MILLISECOND, late=10 * MILLISECOND))
    assert [at for at, payload in received if payload[0] < 5] == [(k + 11) * MILLISECOND for k in range(5)]
    assert [payload[0] for _, payload in received[:6]] == [5, 6, 7, 8, 9, 0]


@pytest.mark.parametrize("after", [0, 3 * MILLISECOND])
def test_doubled_datagrams_come_twice(after: Nanoseconds) -> None:
    received, _ = carried(Impairment(again=after))
    assert sorted(received) == sorted(
        (at, bytes((k,)))
        for k in range(COUNT)
        for at in ((k + 1) * MILLISECOND, (k + 1) * MILLISECOND + after)
    )


def test_an_impairment_of_one_sender_leaves_the_other_alone() -> None:
    assert carried(Impairment(sender="bridge", lost=True))[0] == carried()[0]


def test_impairments_add_up() -> None:
    late = Impairment(late=2 * MILLISECOND)
    received, _ = carried(late, late, Impairment(begin=50 * MILLISECOND, lost=True))
    assert received == [((k + 5) * MILLISECOND, bytes((k,))) for k in range(50)]


def test_its_chance_is_its_own() -> None:
    def lossy(seed: int) -> Impairment:
        return Impairment(share=0.3, generator=np.random.default_rng(seed), lost=True)

    plain = {payload: at for at, payload in carried(jitter=MILLISECOND)[0]}
    one, other = carried(lossy(1), jitter=MILLISECOND)[0], carried(lossy(2), jitter=MILLISECOND)[0]
    assert carried(lossy(1), jitter=MILLISECOND)[0] == one != other
    assert 50 < len(one) < 90
    assert all(plain[payload] == at for at, payload in one), "the link's own jitter is the same"
