"""The guard's own watchdog, at both edges, and the orderly stop."""

from contextlib import suppress
from typing import Final

import pytest

from firmware_bridge.node import OPERATOR, Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.guard import guarded
from firmware_bridge.safety.guard.guard import SILENT_CYCLES
from firmware_bridge.units import MILLISECOND, NEVER
from hil_tests.safety.guard_bench import LINK, Bench, ScriptedNode, Stopping, frame, position, wheel

CYCLE: Final = 50 * MILLISECOND
PATIENCE: Final = 3 * CYCLE
MOVES: Final = (
    wheel(1, 0x000F, 500),
    wheel(2, 0x000F, 500),
    position(3, 0x003F, 700),
    position(4, 0x0006, 9),
)
SAFE: Final = (wheel(1, 0x000F, 0), wheel(2, 0x000F, 0), position(3, 0x010F, 700))
"""The lift has no power: nothing to make safe."""


def test_a_silent_bridge_is_spoken_for_after_three_cycles_and_then_each_cycle(bench: Bench) -> None:
    began = 7 * CYCLE
    assert bench.states(*MOVES, now=began) == MOVES
    assert bench.guard.wake(began + 1) == Reaction((), began + PATIENCE)
    assert bench.guard.wake(began + PATIENCE - 1) == Reaction((), began + PATIENCE)
    due = began + PATIENCE
    assert bench.guard.wake(due) == Reaction(SAFE, due + CYCLE)
    assert bench.guard.wake(due + CYCLE - 1) == Reaction((), due + CYCLE)
    assert bench.guard.wake(due + CYCLE) == Reaction(SAFE, due + 2 * CYCLE)
    # Late is late: the next one is a cycle after it was sent.
    assert bench.guard.wake(due + 9 * CYCLE) == Reaction(SAFE, due + 10 * CYCLE)
    assert bench.guard.refused == 1
    reported = bench.guard.refusals[0]
    assert (reported.at, reported.packet, reported.sent) == (due, None, SAFE)
    assert (
        reported.reason
        == "no set-point for 150 ms: left rear wheel, right rear wheel, steering, scissor lift"
    )


def test_without_a_look_in_between_it_is_the_same(bench: Bench) -> None:
    bench.states(*MOVES, now=CYCLE)
    assert bench.guard.wake(90 * CYCLE) == Reaction(SAFE, 91 * CYCLE)


def test_a_packet_is_a_look_as_well(bench: Bench) -> None:
    bench.states(*MOVES, now=CYCLE)
    reaction = bench.guard.receive(frame(0x181, "3704"), CYCLE + PATIENCE)
    assert reaction == Reaction(SAFE, CYCLE + PATIENCE + CYCLE)


def test_one_forgotten_axis_stops_all(bench: Bench) -> None:
    bench.states(*MOVES, now=CYCLE)
    for n in range(2, 4):
        assert bench.states(MOVES[0], MOVES[2], MOVES[3], now=n * CYCLE) == (MOVES[0], MOVES[2], MOVES[3])
    sent = bench.states(MOVES[0], MOVES[2], MOVES[3], now=4 * CYCLE)
    assert sent == (MOVES[0], MOVES[2], MOVES[3], *SAFE)
    assert bench.guard.refusals[-1].reason == "no set-point for 150 ms: right rear wheel"


def test_an_axis_that_was_never_spoken_for_counts_from_when_the_motion_began(bench: Bench) -> None:
    began = 20 * CYCLE
    bench.states(wheel(1, 0x000F, 0), now=0)
    for n in range(3):
        assert bench.states(wheel(1, 0x000F, 500), now=began + n * CYCLE) == (wheel(1, 0x000F, 500),)
    sent = bench.states(wheel(1, 0x000F, 500), now=began + PATIENCE)
    assert sent == (wheel(1, 0x000F, 500), wheel(1, 0x000F, 0))
    reason = bench.guard.refusals[-1].reason
    assert reason == "no set-point for 150 ms: right rear wheel, steering, scissor lift"


def test_a_bridge_that_speaks_in_time_is_left_alone(bench: Bench) -> None:
    for n in range(50):
        now = n * (PATIENCE - 1)
        assert bench.states(*MOVES, now=now) == MOVES
        assert bench.guard.wake(now).wake_at == now + PATIENCE
    assert bench.guard.refused == 0


def test_a_bridge_that_speaks_again_is_trusted_again_and_watched_again(bench: Bench) -> None:
    bench.states(*MOVES, now=CYCLE)
    bench.guard.wake(10 * CYCLE)
    assert bench.states(*MOVES, now=11 * CYCLE) == MOVES
    assert bench.guard.wake(11 * CYCLE) == Reaction((), 11 * CYCLE + PATIENCE)
    assert bench.guard.wake(11 * CYCLE + PATIENCE).sent == SAFE
    assert bench.guard.refused == 2


@pytest.mark.parametrize("cycles", [1, 2, 3])
def test_each_silence_is_recorded_and_its_deadline_is_counted_from_the_newest_set_points(
    bench: Bench, cycles: int
) -> None:
    for number in range(1, 5):
        for cycle in range(10 * number, 10 * number + cycles):
            now = cycle * CYCLE
            bench.scripted.states = MOVES
            assert bench.guard.wake(now) == Reaction(MOVES, now + PATIENCE)
        due = now + PATIENCE
        assert bench.guard.wake(due) == Reaction(SAFE, due + CYCLE)
        assert bench.guard.refused == number
        assert (bench.guard.refusals[-1].at, bench.guard.refusals[-1].packet) == (due, None)


def test_it_stays_watchful_until_every_axis_is_spoken_for_again(bench: Bench) -> None:
    bench.states(*MOVES, now=CYCLE)
    bench.guard.wake(10 * CYCLE)
    rest = (wheel(1, 0x000F, 0), wheel(2, 0x000F, 0), position(4, 0x0006, 9))
    assert bench.states(*rest, now=11 * CYCLE) == (*rest, *SAFE)
    assert bench.states(*rest, position(3, 0x010F, 700), now=12 * CYCLE) == (*rest, position(3, 0x010F, 700))
    assert bench.guard.wake(12 * CYCLE).wake_at == NEVER


@pytest.mark.parametrize(
    "packets",
    [
        (),
        (frame(0x080, ""),),
        (wheel(1, 0x000F, 0), position(3, 0x000F, 7)),
        (wheel(1, 0x0006, 0), position(3, 0x010F, 7)),
        (*MOVES, wheel(1, 0x000F, 0), wheel(2, 0x000F, 0), position(3, 0x010F, 700)),
    ],
)
def test_a_robot_that_is_commanded_to_rest_is_not_watched(bench: Bench, packets: tuple[Packet, ...]) -> None:
    bench.states(*packets, now=CYCLE)
    assert bench.guard.wake(100 * CYCLE) == Reaction((), NEVER)
    assert bench.guard.refused == 0


def test_the_pause_between_two_motions_does_not_count(bench: Bench) -> None:
    bench.states(wheel(1, 0x000F, 500), now=CYCLE)
    bench.states(wheel(1, 0x000F, 0), now=2 * CYCLE)
    bench.states(wheel(1, 0x000F, 500), now=100 * CYCLE)
    assert bench.guard.wake(100 * CYCLE) == Reaction((), 100 * CYCLE + PATIENCE)


def test_a_refused_set_point_is_speech_too(bench: Bench) -> None:
    bench.states(*MOVES, now=CYCLE)
    sent = bench.states(wheel(1, 0x000F, 9999), *MOVES[1:], now=2 * CYCLE)
    assert sent == (wheel(1, 0x000F, 0), *MOVES[1:])
    assert bench.guard.wake(2 * CYCLE).wake_at == 2 * CYCLE + PATIENCE


def test_the_earlier_of_both_commands_wins(bench: Bench) -> None:
    bench.scripted.wake_at = 5
    assert bench.guard.wake(0).wake_at == 5
    bench.states(*MOVES, now=CYCLE)
    assert bench.guard.wake(CYCLE).wake_at == 5
    bench.scripted.wake_at = CYCLE + PATIENCE + 1
    assert bench.guard.wake(CYCLE).wake_at == CYCLE + PATIENCE


def test_a_stop_is_passed_on_and_its_frames_judged(robot: AnyRobot) -> None:
    scripted = Stopping(wake_at=9)
    bench = Bench(robot, scripted)
    scripted.states = (wheel(1, 0x000F, 9999), wheel(2, 0x000F, 3))
    assert bench.guard.stop(4) == Reaction((wheel(1, 0, 0), wheel(2, 0x000F, 3)), 9)
    assert scripted.received == [(None, 4)]


def test_while_it_ends_a_bridge_is_still_watched_and_then_let_go(robot: AnyRobot) -> None:
    scripted = Stopping(wake_at=99 * CYCLE)
    bench = Bench(robot, scripted)
    bench.states(*MOVES, now=CYCLE)
    assert bench.guard.stop(CYCLE).wake_at == CYCLE + PATIENCE
    assert bench.guard.wake(CYCLE + PATIENCE).sent == SAFE
    scripted.wake_at = NEVER
    assert bench.states(Packet(OPERATOR, 0, b"bye"), now=CYCLE + PATIENCE + 1) == (
        Packet(OPERATOR, 0, b"bye"),
    )
    assert bench.guard.wake(99 * CYCLE) == Reaction((), NEVER)


def test_each_guard_in_a_process_lets_go_of_its_own_bridge_at_the_end(robot: AnyRobot) -> None:
    for _ in range(3):
        scripted = Stopping()
        bench = Bench(robot, scripted)
        bench.states(*MOVES, now=CYCLE)
        assert bench.guard.stop(CYCLE) == Reaction((), NEVER)
        assert bench.guard.wake(99 * CYCLE) == Reaction((), NEVER)


def test_a_bridge_that_fails_while_stopping_is_made_safe(robot: AnyRobot) -> None:
    scripted = Stopping(wake_at=99 * CYCLE)
    bench = Bench(robot, scripted)
    bench.states(*MOVES, now=CYCLE)
    scripted.breaks = True
    assert bench.guard.stop(CYCLE) == Reaction(SAFE, CYCLE), "and it has not ended"
    refusal = bench.guard.refusals[-1]
    assert (refusal.at, refusal.packet, refusal.sent) == (CYCLE, None, SAFE)
    assert refusal.reason == "the bridge failed while stopping: ValueError('no more')"
    with pytest.raises(ValueError, match="no more"):
        bench.guard.wake(CYCLE)
    scripted.breaks = False
    scripted.wake_at = NEVER
    received = bench.guard.receive(Packet(OPERATOR, 0, b""), CYCLE)
    assert received.wake_at != NEVER, "it has not been taken, whatever the bridge makes of a packet"
    assert bench.guard.wake(CYCLE) == Reaction((), NEVER)
    assert scripted.requested == 2, "ended once more, it ends"
    assert bench.guard.wake(CYCLE) == Reaction((), NEVER)
    assert scripted.requested == 2


def test_a_node_that_cannot_stop_is_made_safe(bench: Bench) -> None:
    bench.states(*MOVES, now=CYCLE)
    assert bench.guard.stop(CYCLE) == Reaction(SAFE, NEVER)


def test_a_node_that_fails_is_not_hidden(robot: AnyRobot) -> None:
    class Broken(ScriptedNode):
        def wake(self, now: int) -> Reaction:
            raise ValueError(now)

    node: Node = guarded(Broken(), robot)
    assert node.wake(7) == Reaction((), 7), "what the guard sends leaves first"
    with pytest.raises(ValueError, match="7"):
        node.wake(8)


@pytest.mark.parametrize("fails", ["wake", "receive"])
def test_a_bridge_that_fails_for_good_is_spoken_for_as_one_that_is_silent(
    robot: AnyRobot, fails: str
) -> None:
    class Broken(Stopping):
        def receive(self, packet: Packet, now: int) -> Reaction:
            raise ValueError(packet, now)

        def wake(self, now: int) -> Reaction:
            if not self.breaks:
                return super().wake(now)
            raise ValueError(now)

    scripted = Broken()
    bench = Bench(robot, scripted)
    bench.states(*MOVES, now=CYCLE)
    scripted.breaks = True
    stated: list[int] = []
    for now in range(CYCLE, 12 * CYCLE, CYCLE // 2):
        with suppress(ValueError):
            reaction = (
                bench.guard.wake(now)
                if fails == "wake"
                else bench.guard.receive(Packet(OPERATOR, 0, b""), now)
            )
            stated += [now // CYCLE] if reaction.sent == SAFE else []
    assert stated[0] <= 1 + SILENT_CYCLES
    assert stated == list(range(stated[0], 12)), "in each cycle"


def test_a_guard_needs_no_listener(robot: AnyRobot) -> None:
    guard = guarded(ScriptedNode((Packet(LINK, 0x123, b""),)), robot)
    assert guard.wake(0) == Reaction((), NEVER)
    assert guard.refused == 1


@pytest.mark.parametrize("holding", [True, False])
def test_a_node_that_holds_something_after_it_was_requested_to_end_holds_it_behind_the_guard(
    robot: AnyRobot, *, holding: bool
) -> None:
    class Held(Stopping):
        @property
        def holding(self) -> bool:
            return holding

    assert guarded(Held(), robot).holding is holding
    assert guarded(ScriptedNode(), robot).holding is False
