import numpy as np
import pytest

from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.slow_link.conditions import Conditions, ConditionsError, conditions
from firmware_bridge.slow_link.conditions import LinkDirection as Direction
from firmware_bridge.slow_link.node import Pipe, SlowLink, before_operator, before_robot
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds, to_seconds


class Echo:
    """Node that answers each packet at once on its link, and sends one by itself at 1 s."""

    def __init__(self) -> None:
        self.received: list[tuple[float, bytes]] = []
        self.wake_at: Nanoseconds = SECOND

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self.received.append((to_seconds(now), packet.payload))
        return Reaction((packet,), self.wake_at)

    def wake(self, now: Nanoseconds) -> Reaction:
        if now < self.wake_at:
            return Reaction((), self.wake_at)
        self.wake_at = NEVER
        return Reaction((Packet(OPERATOR, 0, b"by itself"),), NEVER)

    def stop(self, _now: Nanoseconds) -> Reaction:
        self.wake_at = NEVER
        return Reaction((Packet(OPERATOR, 0, b"last word"),), NEVER)


def chance(stream: int = 0) -> np.random.Generator:
    return np.random.default_rng([7, stream])


def carried(way: Direction, count: int, every: Nanoseconds, size: int = 10) -> list[tuple[Nanoseconds, int]]:
    """Send numbered packets; return when which of them arrive."""
    pipe, came = Pipe(way, chance()), []
    for number in range(count):
        pipe.put(Packet(OPERATOR, number, bytes(size)), number * every)
    while (at := pipe.next_at) != NEVER:
        came += [(at, packet.address) for packet in pipe.arrived(at)]
    return came


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("delay=0.5", Conditions(Direction(delay=250 * MILLISECOND), Direction(delay=250 * MILLISECOND))),
        ("up.delay=0.5", Conditions(Direction(delay=500 * MILLISECOND))),
        ("down.delay=0.1, delay=1", Conditions(Direction(delay=SECOND // 2), Direction(delay=SECOND // 10))),
        ("jitter=0.1", Conditions(Direction(jitter=SECOND // 10), Direction(jitter=SECOND // 10))),
        ("up.loss=0.2,up.burst=3", Conditions(Direction(loss=0.2, burst=3.0))),
        ("down.duplicate=1,down.bandwidth=9600,down.queue=2",
         Conditions(down=Direction(duplicate=1.0, bandwidth=9600.0, queue=2 * SECOND))),
    ],
)  # fmt: skip
def test_a_links_words_are_read(text: str, expected: Conditions) -> None:
    assert conditions(text) == expected


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("dealy=0.5", "there is no key 'dealy'; perhaps 'delay'?"),
        ("delay", "give delay=NUMBER"),
        ("uq.delay=1", "there is no direction 'uq'; there are: up, down"),
        ("up.lose=1", "there is no key 'lose'; perhaps 'loss'?"),
        ("loss=1.5", "must be from 0 to 1"),
        ("delay=nan", "must be from 0 to 60"),
        ("delay=soon", "'soon' is not a number"),
        ("delay=1,delay=2", "delay is given twice"),
        ("loss=0.9,burst=2", "bursts of 2 up lose at most 0.67 of all"),
        ("", "there is no key ''"),
    ],
)
def test_wrong_words_are_one_line_with_what_was_meant(text: str, reported: str) -> None:
    with pytest.raises(ConditionsError) as refused:
        conditions(text)
    assert reported in str(refused.value)
    assert "\n" not in str(refused.value)


def test_each_way_has_its_own_delay_and_other_links_have_none() -> None:
    link = before_robot(Echo(), OPERATOR, conditions("up.delay=0.3,down.delay=0.2"), chance(), chance(1))
    word, frame = Packet(OPERATOR, 5, b"go"), Packet(CAN, 5, b"go")
    assert link.receive(frame, 0) == Reaction((frame,), SECOND)
    assert link.receive(word, 0) == Reaction((), 300 * MILLISECOND)
    assert link.wake(300 * MILLISECOND) == Reaction((), 500 * MILLISECOND)
    assert link.wake(500 * MILLISECOND) == Reaction((word,), SECOND)
    assert link.wake(SECOND) == Reaction((), 1_200 * MILLISECOND)
    assert link.wake(1_200 * MILLISECOND).sent[0].payload == b"by itself"


def test_before_an_operator_up_is_what_he_states() -> None:
    link = before_operator(Echo(), OPERATOR, conditions("up.delay=0.3"), chance(), chance(1))
    assert link.receive(Packet(OPERATOR, 0, b"seen"), 0) == Reaction((), 300 * MILLISECOND)


def test_without_conditions_nothing_is_changed() -> None:
    link = SlowLink(Echo(), OPERATOR, into=Pipe(Direction(), chance()), out=Pipe(Direction(), chance()))
    bare, word = Echo(), Packet(OPERATOR, 0, b"go")
    assert link.receive(word, 5) == bare.receive(word, 5)
    assert link.wake(SECOND) == bare.wake(SECOND)


def test_the_last_word_goes_the_slow_way_and_what_comes_then_is_received_by_no_one() -> None:
    echo = Echo()
    link = before_robot(echo, OPERATOR, conditions("delay=0.4"), chance(), chance(1))
    link.receive(Packet(OPERATOR, 0, b"too late"), 0)
    assert link.stop(0) == Reaction((), 200 * MILLISECOND)
    done = link.wake(200 * MILLISECOND)
    assert (done.sent[0].payload, done.wake_at, echo.received) == (b"last word", NEVER, [])


def test_a_jitter_stays_within_its_bound_and_lets_packets_overtake() -> None:
    came = carried(Direction(delay=100 * MILLISECOND, jitter=50 * MILLISECOND), 400, 10 * MILLISECOND)
    late = [at - number * 10 * MILLISECOND for at, number in came]
    assert 100 * MILLISECOND <= min(late) < 103 * MILLISECOND
    assert 147 * MILLISECOND < max(late) <= 150 * MILLISECOND
    assert [number for _, number in came] != sorted(number for _, number in came)


@pytest.mark.parametrize(("burst", "in_a_row"), [(0.0, 1.25), (1.0, 1.0), (5.0, 5.0)])
def test_losses_have_their_share_and_their_length(burst: float, in_a_row: float) -> None:
    came = {number for _, number in carried(Direction(loss=0.2, burst=burst), 20_000, 1)}
    lost = [number not in came for number in range(20_000)]
    begins = sum(now and not before for before, now in zip([False, *lost], lost, strict=False))
    assert sum(lost) / 20_000 == pytest.approx(0.2, rel=0.1)
    assert sum(lost) / begins == pytest.approx(in_a_row, rel=0.1)


def test_a_duplicate_comes_twice_and_each_has_its_own_jitter() -> None:
    came = carried(Direction(jitter=SECOND, duplicate=1.0), 20, SECOND)
    assert sorted(number for _, number in came) == sorted([*range(20), *range(20)])
    assert len({at for at, _ in came}) == 40


def test_a_narrow_link_sends_one_after_the_other_and_loses_what_would_wait_too_long() -> None:
    # 96 bytes at 9,600 bit/s with start and stop bits take 100 ms; one comes each 50 ms.
    came = carried(Direction(bandwidth=9_600.0, queue=200 * MILLISECOND), 10, 50 * MILLISECOND, size=96)
    assert [at // MILLISECOND for at, _ in came] == [100, 200, 300, 400, 500, 600, 700]
    assert [number for _, number in came] == [0, 1, 2, 3, 4, 6, 8]


def test_one_seed_is_one_run_and_one_key_more_leaves_the_others_chance() -> None:
    lossy = Direction(loss=0.3)
    assert carried(lossy, 100, 1) == carried(lossy, 100, 1)
    slow = carried(Direction(loss=0.3, jitter=5, duplicate=0.5), 100, 1)
    assert {number for _, number in slow} == {number for _, number in carried(lossy, 100, 1)}
