"""Sums of speeds: each bound at both edges, changes in one cycle, and who goes on from mixture to mixture."""

from itertools import pairwise, permutations

import pytest

from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds
from hil_tests.safety.guard_bench import Bench
from hil_tests.safety.guard_robots import AnAxis, robot_with
from hil_tests.safety.sums_bench import (
    CYCLE,
    LINK,
    OMNI,
    PAIR,
    RPM,
    TOP,
    Motors,
    as_far_as_allowed,
    speed,
    wheels,
    within,
)


@pytest.mark.parametrize(
    ("left", "right", "reason"),
    [
        (600, 600, None),
        (599, 601, None),
        (600, 601, "speed of 600.5000 is beyond 600.0000"),
        (601, 601, "speed of 601.0000 is beyond 600.0000"),
        (-600, -600, None),
        (-600, -601, "speed of -600.5000 is beyond -600.0000"),
        (-450, 450, None),
        (-450, 451, "turn of 901.0000 is beyond 900.0000"),
        (450, -450, None),
        (451, -450, "turn of -901.0000 is beyond -900.0000"),
        (1000, 200, None),
        (1000, 201, "speed of 600.5000 is beyond 600.0000"),
        (1000, 100, None),
        (1000, 99, "turn of -901.0000 is beyond -900.0000"),
        (0, 900, None),
        (0, 901, "turn of 901.0000 is beyond 900.0000"),
    ],
)
@pytest.mark.parametrize("order", [(1, 2), (2, 1)])
def test_a_sum_is_bounded_to_both_sides(
    left: int, right: int, reason: str | None, order: tuple[int, int]
) -> None:
    bench = Bench(PAIR)
    bench.states(speed(1, 0), speed(2, 0))
    stated = {1: speed(1, left), 2: speed(2, right)}
    first, last = (stated[node] for node in order)
    assert bench.states(first, now=CYCLE) == (first,), "the other one may still correct it"
    sent = bench.states(last, now=CYCLE)
    if reason is None:
        assert sent == (last,)
        assert bench.guard.refused == 0
    else:
        at_standstill = last in {speed(1, 0), speed(2, 0)}
        others = () if first in {speed(1, 0), speed(2, 0)} else (speed(order[0], 0),)
        assert sent == ((last, *others) if at_standstill else (*others, speed(order[1], 0)))
        name = reason.split(" of ", maxsplit=1)[0]
        assert bench.refusals[-1].reason == (f"{name} stayed beyond its bound" if at_standstill else reason)
        assert bench.guard.refused == 1


@pytest.mark.parametrize("word", [0x0000, 0x0006, 0x000B, 0x010F])
def test_only_an_axis_that_is_commanded_to_move_counts(word: int) -> None:
    bench = Bench(PAIR)
    both = (speed(1, 1000, word), speed(2, 1000))
    bench.states(speed(1, 100), speed(2, 100))
    sent = bench.states(*both, now=CYCLE)
    assert bench.refusals[-1].reason == "turn of 1000.0000 is beyond 900.0000"
    assert sent[0] == both[0]
    bench = Bench(PAIR)
    still = (speed(1, 1000, word), speed(2, 900))
    assert bench.states(*still) == still


def test_a_refusal_keeps_the_power_words_and_stops_the_whole_sum() -> None:
    """Without the refused axis alone the turn would be further beyond."""
    bench = Bench(PAIR)
    bench.states(speed(1, 600), speed(2, 600))
    assert bench.states(speed(1, 650), now=CYCLE) == (speed(1, 650),)
    assert bench.refuses(speed(2, 600), CYCLE)[1] == (speed(1, 0), speed(2, 0))
    assert bench.states(speed(1, 300), speed(2, 300), now=2 * CYCLE) == (speed(1, 300), speed(2, 300))


def test_what_is_refused_for_its_own_bounds_stops_its_axis_alone() -> None:
    bench = Bench(PAIR)
    bench.states(speed(1, 600), speed(2, 600))
    assert bench.refuses(speed(1, TOP + 1), CYCLE)[1] == (speed(1, 0),)


def test_rest_is_never_refused_and_what_it_leaves_is_stopped_after_a_cycle() -> None:
    bench = Bench(PAIR)
    both = (speed(1, 200), speed(2, 1000))
    assert bench.states(*both) == both
    now = 7 * CYCLE // 5
    assert bench.states(speed(1, 0), now=now) == (speed(1, 0),)
    assert bench.guard.wake(now).wake_at == now + CYCLE
    assert bench.guard.wake(now + CYCLE - 1).sent == ()
    assert bench.guard.wake(now + CYCLE).sent == (speed(2, 0),)
    refusal = bench.refusals[-1]
    assert (refusal.at, refusal.packet) == (now + CYCLE, None)
    assert refusal.reason == "turn stayed beyond its bound"
    assert bench.guard.wake(now + CYCLE).wake_at == NEVER


def test_the_last_one_that_could_repair_a_sum_and_rests_instead_has_it_stopped_at_once() -> None:
    bench = Bench(robot_with(wheels("left", "right"), sums={"left": ({"left": 1.0, "right": 0.1}, 500.0)}))
    assert bench.states(speed(1, 560)) == (speed(1, 560),)
    assert bench.states(speed(2, 0), now=1) == (speed(2, 0), speed(1, 0))
    assert bench.refusals[-1].reason == "left stayed beyond its bound"


def test_a_sum_of_one_axis_is_a_plain_bound() -> None:
    bench = Bench(robot_with(wheels("left", "right"), sums={"left": ({"left": 2.0}, 500.0)}))
    assert bench.states(speed(1, 250), speed(2, 999)) == (speed(1, 250), speed(2, 999))
    assert bench.refuses(speed(1, 251)) == ("left of 502.0000 is beyond 500.0000", (speed(1, 0),))


def test_an_axis_that_speaks_twice_does_not_repair_for_the_others() -> None:
    sums = {"all": (dict.fromkeys(("one", "two", "three"), 1.0), 900.0)}
    bench = Bench(robot_with(wheels("one", "two", "three"), sums=sums))
    bench.states(*(speed(node, 0) for node in (1, 2, 3)))
    for now in (1, 2):
        assert bench.states(speed(1, 1000), now=now) == (speed(1, 1000),)
    assert bench.states(speed(2, 900), now=3) == (speed(2, 900),), "the third may still correct it"
    assert bench.states(speed(2, 900), now=4) == (speed(2, 900),)
    sent = bench.refuses(speed(3, 900), 5)[1]
    assert sorted(sent, key=repr) == [speed(node, 0) for node in (1, 2, 3)]


def test_a_mirrored_wheel_counts_as_it_turns() -> None:
    left, right = wheels("left", "right")
    mirrored = AnAxis(right.name, right.node, LINK, top_speed=TOP, ratio=RPM, direction=-1)
    bench = Bench(robot_with((left, mirrored), sums={"speed": ({"left": 0.5, "right": 0.5}, 600.0)}))
    assert bench.states(speed(1, 600), speed(2, -600)) == (speed(1, 600), speed(2, -600))
    assert bench.states(speed(1, 1000), speed(2, 1000), now=1) == (speed(1, 1000), speed(2, 1000))
    bench.states(speed(1, 600), now=CYCLE)
    assert "speed of" in bench.refuses(speed(2, -601), CYCLE)[0]


@pytest.mark.parametrize("between", [1, CYCLE // 3, CYCLE - 1])
def test_both_wheels_may_reverse_in_one_cycle(between: Nanoseconds) -> None:
    bench = Bench(PAIR)
    for cycle in range(8):
        way = -1 if cycle % 2 else 1
        bench.states(speed(1, way * 600), now=cycle * CYCLE)
        bench.states(speed(2, way * 600), now=cycle * CYCLE + between)
    assert bench.guard.refused == 0


@pytest.mark.parametrize("way", [1, -1])
def test_no_one_goes_on_from_one_mixture_to_the_next(way: int) -> None:
    """Each vector is within the bounds; but always the rising wheel first, and the other one late."""
    bench = Bench(PAIR)
    motors = Motors(PAIR)
    for step in range(400):
        rising, falling = (1, 2) if step % 2 else (2, 1)
        motors.lives(bench, step * CYCLE, [speed(rising, way * 1000)])
        motors.lives(bench, (step + 1) * CYCLE - 2, [speed(falling, way * 200)])
    assert "speed stayed beyond its bound" in {refusal.reason for refusal in bench.refusals}
    assert abs(motors.way) <= 600 * motors.now + 2 * CYCLE * TOP


def test_to_be_within_for_an_instant_mends_nothing() -> None:
    bench, motors = Bench(PAIR), Motors(PAIR)
    motors.lives(bench, 0, [speed(1, 500), speed(2, 500)])
    for ms in (10, 30, 50, 59):
        motors.lives(bench, ms * MILLISECOND, [speed(1, 0), speed(1, 1000)])
    assert bench.guard.refused == 0
    motors.lives(bench, 61 * MILLISECOND, [])
    assert bench.refusals[-1].at == 60 * MILLISECOND


@pytest.mark.parametrize("order", list(permutations((1, 2, 3))))
def test_an_honest_bridge_may_alternate_at_the_bounds_for_ever(order: tuple[int, ...]) -> None:
    corners = [as_far_as_allowed(OMNI, list(vector)) for vector in permutations((1000, -1000, 0))]
    bench = Bench(OMNI)
    for cycle in range(200):
        vector = corners[cycle % len(corners)]
        for place, node in enumerate(order):
            now = cycle * CYCLE + place * (CYCLE // 2 - 1)
            assert bench.states(speed(node, vector[node - 1]), now=now) == (speed(node, vector[node - 1]),)
    assert all(within(OMNI, vector) for vector in corners)
    assert any(one != other for one, other in pairwise(corners))


def test_a_mixture_may_stand_for_one_cycle_of_the_slowest_link() -> None:
    slow = AnAxis("arm", 3, "arm", top_speed=TOP, ratio=RPM)
    robot = robot_with(
        (*wheels("left"), slow), sums={"both": ({"left": 1.0, "arm": 1.0}, 600.0)}, every={"arm": 4}
    )
    bench = Bench(robot)
    assert bench.states(speed(1, 601)) == (speed(1, 601),)
    assert bench.guard.wake(0).wake_at == 3 * CYCLE, "the wheel itself would be silent before"
    for cycle in (1, 2, 3):
        assert bench.states(speed(1, 601), now=cycle * CYCLE) == (speed(1, 601),)
    assert bench.guard.wake(3 * CYCLE).wake_at == 4 * CYCLE
    assert bench.states(now=4 * CYCLE) == (speed(1, 0),)


def test_the_longest_that_a_bound_may_be_passed_is_counted_from_its_beginning() -> None:
    bench = Bench(PAIR)
    bench.states(speed(1, 600), speed(2, 600), now=SECOND - CYCLE)
    assert bench.states(speed(1, 610), now=SECOND) == (speed(1, 610),)
    assert bench.states(speed(1, 620), now=SECOND + 30 * MILLISECOND) == (speed(1, 620),)
    assert bench.guard.wake(SECOND + 30 * MILLISECOND).wake_at == SECOND + CYCLE
    assert bench.states(now=SECOND + CYCLE) == (speed(1, 0), speed(2, 0))


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_the_unit_of_a_sum_does_not_matter(scale: float) -> None:
    sums = {"speed": ({"left": 0.5 * scale, "right": 0.5 * scale}, 600.0 * scale)}
    bench, motors = Bench(robot_with(wheels("left", "right"), sums=sums)), Motors(PAIR)
    motors.lives(bench, CYCLE, [speed(1, 600), speed(2, 599)])
    motors.lives(bench, 2 * CYCLE - 1, [speed(1, 602)])
    motors.lives(bench, 4 * CYCLE, [])
    assert bench.refusals[-1].at == 3 * CYCLE - 1


def test_an_axis_that_was_sent_nothing_counts_nothing() -> None:
    bench = Bench(robot_with(wheels("left", "right"), sums={"all": ({"left": 1.0, "right": 1.0}, 600.0)}))
    assert bench.states(speed(1, 600)) == (speed(1, 600),)
    assert bench.states(now=CYCLE) == ()
    assert bench.guard.refused == 0


def test_a_wheel_that_is_stopped_by_a_request_leaves_a_turn_that_is_stopped_after_a_cycle() -> None:
    bench = Bench(PAIR)
    bench.states(speed(1, 1000), speed(2, 150))
    assert bench.states(speed(2, 200), now=1) == (speed(2, 200),)
    quick_stop = Packet(LINK, 0x602, bytes.fromhex("2b4060000b000000"))
    assert bench.states(quick_stop, now=9) == (quick_stop,)
    assert bench.states(now=9 + CYCLE - 1) == ()
    assert bench.states(now=9 + CYCLE) == (speed(1, 0),)
    assert bench.refusals[-1].reason == "turn stayed beyond its bound"
