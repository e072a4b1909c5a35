"""Any frames of third parties at any time: no exception, and nothing moves that was not armed."""

from typing import TYPE_CHECKING

from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_bridge import robot_types
from firmware_bridge.bridge import Bridge
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.units import MILLISECOND, Nanoseconds
from hil_tests.lanes import examples

if TYPE_CHECKING:
    from collections.abc import Callable

    from hil_tests.unit.bridge.bench import Bench

NODES = (0, 1, 2, 3, 4, 5, 100)
FUNCTIONS = (0x000, 0x080, 0x100, 0x180, 0x200, 0x280, 0x380, 0x480, 0x500, 0x580, 0x600, 0x700, 0x7E4)
FLAGS = (0, 0, 0, 0, 1 << 29, 1 << 30, 1 << 31)

addresses = st.builds(lambda f, n, g: f | n | g, *map(st.sampled_from, (FUNCTIONS, NODES, FLAGS)))
frames = st.builds(lambda a, p: Packet(CAN, a, p), addresses, st.binary(max_size=8))
likely = st.builds(
    lambda a, p: Packet(CAN, a, p),
    st.sampled_from([f | n for f in (0x080, 0x180, 0x280, 0x580, 0x700) for n in (1, 2, 3, 4)]),
    st.one_of(
        st.binary(min_size=8, max_size=8),
        st.sampled_from(
            [
                bytes.fromhex(text)
                for text in (
                    "00", "05", "7f", "3703", "4307001892010200", "4300100092010200", "43181001fb000000",
                    "4318100200002064", "4b41600040010000", "6040600000000000", "4100100005000000",
                    "0545504f53320000", "8000100000000206", "1186208000000000", "3703000000000700",
                )
            ]
        ),
    ),
)  # fmt: skip
datagrams = st.builds(lambda p: Packet(OPERATOR, 0, p), st.binary(max_size=40))


@settings(max_examples=examples(60))
@given(
    st.lists(
        st.tuples(st.one_of(frames, likely, datagrams), st.integers(0, 120 * MILLISECOND)),
        max_size=60,
    )
)
def test_no_packets_make_the_bridge_raise_or_move(script: list[tuple[Packet, int]]) -> None:
    bridge = Bridge(robot_types.find("rars"), ROBOT_TYPE)
    now: Nanoseconds = 0
    sent = list(bridge.wake(now).sent)
    for packet, gap in script:
        now += gap
        reaction = bridge.receive(packet, now)
        sent += reaction.sent
        while reaction.wake_at <= now:
            reaction = bridge.wake(now)
            sent += reaction.sent
        sent += bridge.wake(now).sent
    for _ in range(100):
        reaction = bridge.wake(now)
        sent += reaction.sent
        now = min(max(reaction.wake_at, now), now + 50 * MILLISECOND)
    bridge.stop(now)
    wheels = [p.payload for p in sent if p.link == CAN and p.address in (0x501, 0x502)]
    assert all(payload[2:] == bytes(4) for payload in wheels)


@settings(max_examples=examples(15))
@given(st.lists(st.tuples(likely, st.integers(0, 40)), max_size=60))
def test_no_frames_make_a_running_bridge_raise_or_move(
    new_bench: "Callable[[], Bench]", script: list[tuple[Packet, int]]
) -> None:
    bench = new_bench()
    bench.starts()
    begin = bench.now
    bench.speed = 0.4
    for packet, wait_ms in script:
        bench.bus.carry(bench.places["lift"], packet)
        bench.runs(wait_ms / 1000.0)
    bench.runs(0.5)
    words = [target for name in ("left", "right") for _, target in bench.words(name, begin)]
    assert set(words) <= {0}
    bench.stops()
    bench.runs(5)
    assert bench.bridge.finished
