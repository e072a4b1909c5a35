"""Sides that never move together: who may move while whom, and what a position counts for."""

from collections.abc import Callable
from typing import Final, TypeAlias

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND
from hil_tests.safety.guard_bench import Bench, position, sample, status, status_read, wheel, write
from hil_tests.safety.guard_robots import RARS
from hil_tests.safety.serial_bench import SerialBench, done, reading, speed, target, value, word

Report: TypeAlias = Callable[[int, int], Packet]
ENABLE, HALT, GO, OFF, SHUTDOWN = 0x000F, 0x010F, 0x003F, 0x0000, 0x0006
LEFT_MOVES: Final = "wheels or lift: left rear wheel may not move while scissor lift may"
LIFT_MOVES: Final = "wheels or lift: scissor lift may not move while left rear wheel may"


@pytest.fixture
def pair() -> Bench:
    """RARS with all axes enabled at rest."""
    bench = Bench(RARS)
    bench.states(
        *(wheel(node, ENABLE, 0) for node in (1, 2)), *(position(node, ENABLE, 0) for node in (3, 4))
    )
    return bench


def test_the_lift_may_not_move_while_a_wheel_may(pair: Bench) -> None:
    pair.states(wheel(1, ENABLE, 100))
    assert pair.refuses(position(4, GO, 500)) == (LIFT_MOVES, (position(4, HALT, 0),))
    assert pair.states(wheel(1, ENABLE, 200), position(3, GO, 5)) == (
        wheel(1, ENABLE, 200),
        position(3, GO, 5),
    )


def test_both_wheels_stand_against_the_lift(pair: Bench) -> None:
    pair.states(wheel(1, ENABLE, 100), wheel(2, ENABLE, -100))
    assert pair.refuses(position(4, GO, 500))[0] == LIFT_MOVES.replace(
        "while left rear wheel", "while left rear wheel, right rear wheel"
    )


@pytest.mark.parametrize("rest", [OFF, SHUTDOWN, HALT, 0x000B])
def test_a_wheel_that_was_commanded_to_rest_gives_the_way_free(pair: Bench, rest: int) -> None:
    pair.states(wheel(1, ENABLE, 100), wheel(1, rest, 100))
    assert pair.states(position(4, GO, 500)) == (position(4, GO, 500),)


def test_in_one_cycle_the_side_that_moves_is_commanded_to_rest_first(pair: Bench) -> None:
    pair.states(wheel(1, ENABLE, 100))
    assert pair.states(position(4, GO, 500), wheel(1, ENABLE, 0)) == (
        position(4, HALT, 0),
        wheel(1, ENABLE, 0),
    )
    assert pair.states(position(4, GO, 500)) == (position(4, GO, 500),)


@pytest.mark.parametrize("last", [GO, ENABLE])
def test_the_wheels_may_not_move_while_the_lift_goes_to_its_target(pair: Bench, last: int) -> None:
    """The word that ends a position's handshake leaves it on its way."""
    pair.states(position(4, GO, 500), position(4, last, 500))
    assert pair.refuses(wheel(1, ENABLE, 1)) == (LEFT_MOVES, (wheel(1, ENABLE, 0),))
    assert pair.states(wheel(1, ENABLE, 0)) == (wheel(1, ENABLE, 0),)
    assert pair.states(wheel(1, HALT, 50)) == (wheel(1, HALT, 50),)


@pytest.mark.parametrize("rest", [HALT, OFF, SHUTDOWN, 0x000B])
def test_a_lift_that_was_commanded_to_rest_gives_the_way_free(pair: Bench, rest: int) -> None:
    pair.states(position(4, GO, 500), position(4, ENABLE, 500), position(4, rest, 500))
    assert pair.states(wheel(1, ENABLE, 100)) == (wheel(1, ENABLE, 100),)


def test_a_halt_that_is_taken_back_lets_the_lift_go_on(pair: Bench) -> None:
    pair.states(position(4, GO, 500), position(4, HALT, 500), wheel(1, ENABLE, 100))
    assert pair.refuses(position(4, ENABLE, 500)) == (LIFT_MOVES, (position(4, HALT, 500),))


@pytest.mark.parametrize("off", [position(4, SHUTDOWN, 500), write(4, 0x6040, 0, b"\x0b\x00")])
def test_without_power_the_lift_forgets_its_target(pair: Bench, off: Packet) -> None:
    pair.states(position(4, GO, 500), off, position(4, ENABLE, 500))
    assert pair.states(wheel(1, ENABLE, 100)) == (wheel(1, ENABLE, 100),)


@pytest.mark.parametrize("command", ["82", "80"])
def test_a_lift_that_left_the_bus_forgets_its_target(pair: Bench, command: str) -> None:
    pair.states(
        position(4, GO, 500), position(4, HALT, 500), Packet("drives", 0, bytes.fromhex(command + "04"))
    )
    pair.states(position(4, ENABLE, 500))
    assert pair.states(wheel(1, ENABLE, 100)) == (wheel(1, ENABLE, 100),)


ENABLED, REACHED = 0x0737 & ~0x0400, 0x0737
CYCLE: Final = 50 * MILLISECOND


@pytest.mark.parametrize("report", [status, sample, status_read])
def test_a_lift_that_reports_that_it_is_there_gives_the_way_free(pair: Bench, report: Report) -> None:
    pair.states(position(4, GO, 500), position(4, ENABLE, 500))
    pair.receives(report(4, ENABLED), now=CYCLE)
    assert pair.refuses(wheel(1, ENABLE, 1), CYCLE)[0] == LEFT_MOVES
    pair.receives(report(4, REACHED), now=CYCLE)
    assert pair.states(wheel(1, ENABLE, 1), position(4, ENABLE, 500), now=CYCLE) == (
        wheel(1, ENABLE, 1), position(4, ENABLE, 500),
    )  # fmt: skip
    pair.receives(report(4, ENABLED), now=CYCLE)
    assert pair.states(position(4, ENABLE, 500), now=CYCLE) == (position(4, ENABLE, 500),), "it is held there"
    assert pair.refuses(position(4, GO, 500), CYCLE)[0] == LIFT_MOVES


@pytest.mark.parametrize(
    ("stated", "statusword", "when"),
    [
        (position(4, ENABLE, 500), REACHED, CYCLE - 1),
        (position(4, ENABLE, 500), REACHED & ~0x0004, CYCLE),
        (position(4, ENABLE, 500), 0x0400, CYCLE),
        (position(4, GO, 900), REACHED, CYCLE + 9),
    ],
)
def test_what_may_be_older_than_the_target_or_is_not_enabled_is_no_arrival(
    pair: Bench, stated: Packet, statusword: int, when: int
) -> None:
    pair.states(position(4, GO, 500))
    pair.states(stated, now=10)
    pair.receives(status(4, statusword), now=when)
    assert pair.refuses(wheel(1, ENABLE, 1), when)[0] == LEFT_MOVES


@pytest.mark.parametrize("again", [GO, ENABLE])
def test_a_lift_that_goes_on_after_a_halt_has_to_arrive_again(pair: Bench, again: int) -> None:
    """While it is halted the same bit means that it stands."""
    pair.states(position(4, GO, 500), position(4, HALT, 500))
    pair.receives(status(4, REACHED), now=CYCLE)
    pair.states(position(4, again, 500), now=CYCLE)
    pair.receives(status(4, REACHED), now=2 * CYCLE - 1)
    assert pair.refuses(wheel(1, ENABLE, 1), 2 * CYCLE - 1)[0] == LEFT_MOVES
    pair.receives(status(4, REACHED), now=2 * CYCLE)
    assert pair.states(wheel(1, ENABLE, 1), now=2 * CYCLE) == (wheel(1, ENABLE, 1),)


def test_the_arrival_of_another_axis_is_not_the_lift_s(pair: Bench) -> None:
    pair.states(position(4, GO, 500))
    pair.receives(status(3, REACHED), now=CYCLE)
    assert pair.refuses(wheel(1, ENABLE, 1), CYCLE)[0] == LEFT_MOVES


FOLLOWING: Final = 4_000
"""The lift's largest following error: what is so near to where it rests is no motion."""


def resting(bench: Bench, position_qc: int) -> None:
    """Let the lift go somewhere, arrive, and rest there."""
    bench.states(position(4, GO, position_qc), position(4, ENABLE, position_qc))
    bench.receives(sample(4, REACHED, position_qc), now=CYCLE)
    bench.states(position(4, HALT, position_qc), now=CYCLE)


@pytest.mark.parametrize("away", [0, FOLLOWING, -FOLLOWING])
def test_a_lift_that_is_sent_where_it_rests_does_not_move(pair: Bench, away: int) -> None:
    resting(pair, 50_000)
    held = (wheel(1, ENABLE, 100), position(4, GO, 50_000 + away), position(4, ENABLE, 50_000 + away))
    assert pair.states(*held, now=2 * CYCLE) == held
    assert pair.states(wheel(1, ENABLE, 200), now=2 * CYCLE) == (wheel(1, ENABLE, 200),)
    assert pair.refuses(position(4, GO, 50_001 + FOLLOWING), 2 * CYCLE)[0] == LIFT_MOVES
    assert pair.refuses(position(4, GO, 49_999 - FOLLOWING), 2 * CYCLE)[0] == LIFT_MOVES


def test_no_one_creeps_away_in_small_steps(pair: Bench) -> None:
    resting(pair, 50_000)
    pair.states(wheel(1, ENABLE, 100), now=2 * CYCLE)
    now = 2 * CYCLE
    for last in (ENABLE, HALT):
        step = (position(4, GO, 53_000), position(4, last, 53_000))
        assert pair.states(*step, now=now) == step
        now += CYCLE
        pair.receives(sample(4, REACHED, 53_000), now=now)
        assert pair.refuses(position(4, GO, 56_000), now)[0] == LIFT_MOVES


def test_where_a_lift_rests_is_known_once_it_is_halted_or_there(pair: Bench) -> None:
    pair.states(position(4, GO, 90_000), position(4, ENABLE, 90_000))
    pair.receives(sample(4, ENABLED, 40_000), now=CYCLE)
    pair.states(position(4, HALT, 90_000), now=CYCLE)
    pair.receives(sample(4, ENABLED, 41_000), now=2 * CYCLE - 1)
    pair.receives(sample(4, ENABLED, 50_000), now=2 * CYCLE)
    pair.receives(sample(4, ENABLED, 55_000), now=2 * CYCLE)
    held = (wheel(1, ENABLE, 100), position(4, GO, 50_000 - FOLLOWING))
    assert pair.states(*held, now=2 * CYCLE) == held
    assert pair.refuses(position(4, GO, 55_000), 2 * CYCLE)[0] == LIFT_MOVES


def test_a_lift_that_is_on_its_way_or_unknown_moves_wherever_it_is_sent(pair: Bench) -> None:
    pair.states(wheel(1, ENABLE, 100))
    assert pair.refuses(position(4, GO, 0))[0] == LIFT_MOVES
    pair.states(wheel(1, ENABLE, 0), position(4, GO, 90_000))
    pair.receives(sample(4, ENABLED, 90_000), now=CYCLE)
    assert pair.refuses(wheel(1, ENABLE, 1), CYCLE)[0] == LEFT_MOVES


def test_a_halted_lift_that_is_sent_where_it_rests_forgets_where_it_was_going(pair: Bench) -> None:
    pair.states(position(4, GO, 90_000), position(4, HALT, 90_000))
    pair.receives(sample(4, REACHED, 50_000), now=CYCLE)
    pair.states(wheel(1, ENABLE, 100), now=CYCLE)
    assert pair.refuses(position(4, ENABLE, 90_000), CYCLE)[0] == LIFT_MOVES
    held = (position(4, GO, 50_000), position(4, ENABLE, 50_000))
    assert pair.states(*held, now=CYCLE) == held


def test_a_lift_without_power_rests_wherever_it_is_moved_by_hand(pair: Bench) -> None:
    resting(pair, 50_000)
    pair.states(position(4, SHUTDOWN, 50_000), now=CYCLE)
    pair.receives(sample(4, REACHED, 90_000), now=CYCLE)
    pair.receives(sample(4, 0x0121, 90_000), now=CYCLE)
    pair.states(position(4, ENABLE, 90_000), wheel(1, ENABLE, 1), now=CYCLE)
    held = position(4, GO, 90_000)
    assert pair.states(held, now=CYCLE) == (held,)
    assert pair.refuses(position(4, GO, 50_000), CYCLE)[0] == LIFT_MOVES


def test_a_drive_that_reports_power_though_it_was_sent_none_does_not_count_as_moved_by_hand(
    pair: Bench,
) -> None:
    resting(pair, 50_000)
    pair.states(position(4, SHUTDOWN, 50_000), now=CYCLE)
    pair.receives(sample(4, REACHED, 90_000), now=2 * CYCLE)
    pair.states(position(4, ENABLE, 50_000), wheel(1, ENABLE, 1), now=2 * CYCLE)
    assert pair.refuses(position(4, GO, 90_000), 2 * CYCLE)[0] == LIFT_MOVES


@pytest.mark.parametrize("command", ["81", "82"])
def test_a_lift_that_was_reset_rests_nowhere_known(pair: Bench, command: str) -> None:
    resting(pair, 50_000)
    pair.states(position(4, OFF, 50_000), now=CYCLE)
    leaves = Packet("drives", 0, bytes.fromhex(command + "04"))
    assert pair.states(leaves, wheel(1, ENABLE, 1), now=5 * CYCLE) == (leaves, wheel(1, ENABLE, 1))
    assert pair.refuses(position(4, GO, 50_000), 5 * CYCLE)[0] == LIFT_MOVES


def test_on_a_serial_line_a_position_that_was_read_reports_where_the_lift_rests() -> None:
    desk = SerialBench()
    where, what = reading(4, od.POSITION_ACTUAL), reading(4, od.STATUSWORD)
    going = (target(4, 90_000), word(4, ENABLE), word(4, GO), word(4, ENABLE), word(1, ENABLE))
    desk.states(*going, what, where)
    for packet in going:
        desk.receives(done(packet), CYCLE)
    desk.receives(value(what, b"\x37\x07"), CYCLE)
    desk.receives(value(where, (90_000).to_bytes(4, "little")), CYCLE)
    driving, held = speed(100), (target(4, 86_000), word(4, GO))
    assert desk.states(driving, now=CYCLE) == (driving,)
    assert desk.states(*held, now=CYCLE) == held
    assert desk.states(word(4, ENABLE), target(4, 85_999), now=CYCLE) == (word(4, ENABLE), target(4, 85_999))
    assert desk.states(word(4, GO), now=CYCLE) == (word(4, HALT),)


def test_a_drive_that_an_earlier_run_has_left_with_power_rests_where_it_states() -> None:
    bench = Bench(RARS)
    bench.receives(sample(4, REACHED, 50_000))
    stated = (wheel(1, ENABLE, 1), position(4, GO, 50_000))
    assert bench.states(*stated) == stated
    assert bench.refuses(position(4, GO, 0))[0] == LIFT_MOVES


def test_a_lift_on_its_way_rests_no_longer_where_it_did(pair: Bench) -> None:
    resting(pair, 50_000)
    pair.states(position(4, GO, 90_000), position(4, HALT, 90_000), wheel(1, ENABLE, 1), now=2 * CYCLE)
    assert pair.refuses(position(4, GO, 50_000), 2 * CYCLE)[0] == LIFT_MOVES


def test_the_end_of_the_handshake_and_what_follows_do_not_put_the_arrival_off(pair: Bench) -> None:
    pair.states(position(4, GO, 50_000))
    for now in (CYCLE // 2, CYCLE - 1):
        pair.states(position(4, ENABLE, 50_000), now=now)
    pair.receives(Packet("drives", 0x284, sample(4, REACHED, 50_000).payload[:6]), now=CYCLE)
    held = (wheel(1, ENABLE, 1), position(4, GO, 50_000))
    assert pair.states(*held, now=CYCLE) == held


def test_a_halt_that_is_repeated_is_the_same_halt(pair: Bench) -> None:
    pair.states(position(4, GO, 90_000), position(4, HALT, 90_000))
    pair.states(position(4, HALT, 90_000), now=CYCLE - 1)
    pair.receives(sample(4, ENABLED, 50_000), now=CYCLE)
    held = (wheel(1, ENABLE, 1), position(4, GO, 50_000))
    assert pair.states(*held, now=CYCLE) == held


def test_a_lift_that_goes_on_is_there_a_cycle_later_at_the_earliest(pair: Bench) -> None:
    pair.states(position(4, GO, 500), position(4, HALT, 500))
    pair.states(position(4, ENABLE, 500), now=CYCLE)
    pair.receives(status(4, REACHED), now=2 * CYCLE - 1)
    assert pair.refuses(wheel(1, ENABLE, 1), 2 * CYCLE - 1)[0] == LEFT_MOVES


@pytest.mark.parametrize("other", [od.TARGET_POSITION, od.POSITION_DEMAND, od.VELOCITY_ACTUAL])
def test_what_else_is_read_on_a_serial_line_reports_no_position(other: Address) -> None:
    desk = SerialBench()
    requested = reading(4, other)
    desk.states(requested)
    desk.receives(value(requested, (90_000).to_bytes(4, "little")))
    desk.states(word(4, ENABLE), word(1, ENABLE), speed(100), target(4, 90_000))
    assert desk.states(word(4, GO)) == (word(4, HALT),)
