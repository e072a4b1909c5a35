"""Two stations behind one router that call themselves alike: seen by their numbers, and what each may do."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from firmware_bridge.intent import EmergencyStop
from firmware_bridge.mavlink.frames import FAR, FAR_LEAST, LEAST, Codec, FrameNumbers, dialect
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.teleop.bench import RarsBench, rars
from hil_tests.unit.teleop.received import texts

EVERY = 40 * MILLISECOND


def repeats(numbered: FrameNumbers, frames: Iterator[tuple[int, int]]) -> list[bool]:
    """Return for each of these frames, 40 ms apart, True if two senders were seen: number and content."""
    return [
        numbered.receive(number & 0xFF, content, at * EVERY) or numbered.two
        for at, (number, content) in enumerate(frames)
    ]


@given(begin=st.integers(0, 255), lost=st.lists(st.booleans(), min_size=50, max_size=400))
def test_of_one_station_frames_may_be_lost(begin: int, lost: list[bool]) -> None:
    frames = ((begin + at, at) for at, gone in enumerate(lost) if not gone)
    assert not any(repeats(FrameNumbers(), frames))


@given(
    order=st.lists(st.integers(-60, 60), min_size=50, max_size=300),
    doubled=st.sets(st.integers(0, 299), max_size=100),
)
def test_of_one_station_frames_may_be_overtaken_and_doubled(order: list[int], doubled: set[int]) -> None:
    came = sorted(range(len(order)), key=lambda at: at + order[at] / 10.0)
    frames = [at for at in came for _ in range(2 if at in doubled else 1)]
    assert not any(repeats(FrameNumbers(), ((at, at) for at in frames)))


@pytest.mark.parametrize("late", [5, 16, 17, 50, FAR])
def test_one_station_whose_frames_come_late_for_a_while_is_one(late: int) -> None:
    on_time = list(range(40))
    # So many frames wait on their way; then each of them comes beside one that does not.
    both = [at for behind in range(40, 40 + late) for at in (behind + late, behind)]
    frames = [*on_time, *both, *range(40 + 2 * late, 200 + 2 * late)]
    assert not any(repeats(FrameNumbers(), ((at, at) for at in frames)))


@pytest.mark.parametrize("restarts", [[20], [20, 60], [5, 10, 15]])
def test_a_station_that_begins_again_is_one(restarts: list[int]) -> None:
    begins = [0, *restarts, 120]
    frames = ((at - begin, at) for begin, end in pairwise(begins) for at in range(begin, end))
    assert not any(repeats(FrameNumbers(), frames))


@given(apart=st.integers(1, 255), joins=st.integers(5, 60))
@example(apart=127, joins=5)
@example(apart=128, joins=5)
@example(apart=129, joins=5)
@example(apart=20, joins=60)
@example(apart=100, joins=60)
def test_two_are_seen_and_distinguished(apart: int, joins: int) -> None:
    numbered = FrameNumbers()
    for at in range(joins):
        assert not numbered.receive(at & 0xFF, at, at * EVERY)
    stated, seen_after = [], None
    for at in range(joins, joins + 400):
        first = numbered.receive(at & 0xFF, at, at * EVERY)
        later = numbered.receive((at + apart) & 0xFF, 1_000_000 + at, at * EVERY + EVERY // 2)
        stated.append((first, later))
        seen_after = at - joins + 1 if numbered.two and seen_after is None else seen_after
    assert numbered.two
    # Numbers that are near look like late frames until they come again; of others the steps back are far.
    near = min(apart, 256 - apart) <= FAR + 1
    assert seen_after is not None
    assert seen_after <= (FAR + 1 + LEAST if near else FAR_LEAST + 1)
    if apart == 1:
        assert stated[-1] in {(False, True), (True, False)}, (
            "who joins with the next number is the first to say it"
        )
    else:
        assert stated[-1] == (False, True)
        assert not any(first for first, _ in stated), "who was there first is never taken for the other"


def test_when_one_of_them_is_gone_there_is_one() -> None:
    numbered = FrameNumbers()

    def speak(at: int, *, both: bool) -> bool:
        if both:
            numbered.receive(at & 0xFF, at, at * EVERY)
        return numbered.receive((at + 9) & 0xFF, 1_000_000 + at, at * EVERY + EVERY // 2) or numbered.two

    assert [speak(at, both=True) for at in range(200)][-1]
    alone = [speak(at, both=False) for at in range(200, 200 + 4 * SECOND // EVERY)]
    assert not any(alone[3 * SECOND // EVERY :])


class Two:
    """Two stations on one link, 255/190 both, and the message of each, 20 times a second."""

    def __init__(self) -> None:
        self.bench: RarsBench = rars()
        self.first, self.second = Codec(255, 190), Codec(255, 190)
        self.skip(self.first, 40)

    def skip(self, codec: Codec, count: int) -> None:
        for _ in range(count):
            codec.encode(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))

    def say(self, first: Any, second: Any, seconds: float) -> list[str]:
        """Let both send so long; return the texts that they receive."""
        received: list[str] = []
        for _ in range(round(seconds * 20)):
            for codec, message in ((self.first, first), (self.second, second)):
                if message is not None:
                    self.bench.now += 25 * MILLISECOND
                    sent = self.bench.operator.receive(
                        codec.encode(message), self.bench.now, self.bench.decide
                    )
                    received += texts([it for packet in sent for it in Codec(9, 9).decode(packet.payload)])
        reported = self.bench.operator.report(self.bench.snapshot(), (), self.bench.now)
        received += texts([it for packet in reported for it in Codec(9, 9).decode(packet.payload)])
        return received


def stick(x: int, buttons: int = 0) -> Any:
    return dialect.MAVLink_manual_control_message(1, x, 0, 0, 0, buttons)


def test_the_later_one_is_named_and_moves_nothing_and_the_first_goes_on_to_drive() -> None:
    two = Two()
    two.say(stick(400), None, 2.0)
    received = two.say(stick(400), stick(-800), 3.0)
    assert any("two stations call themselves 255/190" in text for text in received)
    commands = set()
    for _ in range(20):
        two.say(stick(400), stick(-800), 0.05)
        commands.add(round(two.bench.operator.intent.command.speed_mps, 3))
    assert commands == {0.2}


def test_who_of_both_lets_go_lets_go() -> None:
    two = Two()
    two.say(stick(400), stick(400), 4.0)
    for first, second in ((stick(0), stick(400)), (stick(400), stick(0))):
        for _ in range(20):
            two.say(first, second, 0.05)
            intent = two.bench.operator.intent
            assert intent.command.speed_mps == 0.0
            assert intent.deflected == ""
        two.say(stick(400), stick(400), 2.0)
        assert two.bench.operator.intent.command.speed_mps == pytest.approx(0.2)


def test_the_later_one_may_stop_it() -> None:
    two = Two()
    two.say(stick(400), stick(400), 4.0)
    assert two.bench.requested == []
    two.say(stick(400), stick(400, 1 << 2), 0.1)
    assert EmergencyStop() in two.bench.requested
