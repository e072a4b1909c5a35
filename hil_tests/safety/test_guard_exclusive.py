"""Sides that never move together: who may move while whom, and what a position counts for."""

from collections.abc import Callable
from typing import Final, TypeAlias

import pytest

from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND
from hil_tests.safety.guard_bench import Bench, position, sample, status, status_read, wheel, write
from hil_tests.safety.guard_robots import RARS

Report: TypeAlias = Callable[[int, int], Packet]
ENABLE, HALT, GO, OFF, SHUTDOWN = 0x000F, 0x010F, 0x003F, 0x0000, 0x0006
LEFT_MOVES: Final = "wheels or lift: left rear wheel may not move while scissor lift may"
LIFT_MOVES: Final = "wheels or lift: scissor lift may not move while left rear wheel may"


@pytest.fixture
def pair() -> Bench:
    """RARS with all axes enabled at rest."""
    bench = Bench(RARS)
    bench.says(*(wheel(node, ENABLE, 0) for node in (1, 2)), *(position(node, ENABLE, 0) for node in (3, 4)))
    return bench


def test_the_lift_may_not_move_while_a_wheel_may(pair: Bench) -> None:
    pair.says(wheel(1, ENABLE, 100))
    assert pair.refuses(position(4, GO, 500)) == (LIFT_MOVES, (position(4, HALT, 0),))
    assert pair.says(wheel(1, ENABLE, 200), position(3, GO, 5)) == (wheel(1, ENABLE, 200), position(3, GO, 5))


def test_both_wheels_stand_against_the_lift(pair: Bench) -> None:
    pair.says(wheel(1, ENABLE, 100), wheel(2, ENABLE, -100))
    assert pair.refuses(position(4, GO, 500))[0] == LIFT_MOVES.replace(
        "while left rear wheel", "while left rear wheel, right rear wheel"
    )


@pytest.mark.parametrize("word", [OFF, SHUTDOWN, HALT, 0x000B])
def test_a_wheel_that_was_told_to_rest_gives_the_way_free(pair: Bench, word: int) -> None:
    pair.says(wheel(1, ENABLE, 100), wheel(1, word, 100))
    assert pair.says(position(4, GO, 500)) == (position(4, GO, 500),)


def test_in_one_cycle_the_side_that_moves_is_told_to_rest_first(pair: Bench) -> None:
    pair.says(wheel(1, ENABLE, 100))
    assert pair.says(position(4, GO, 500), wheel(1, ENABLE, 0)) == (position(4, HALT, 0), wheel(1, ENABLE, 0))
    assert pair.says(position(4, GO, 500)) == (position(4, GO, 500),)


@pytest.mark.parametrize("last", [GO, ENABLE])
def test_the_wheels_may_not_move_while_the_lift_goes_to_its_target(pair: Bench, last: int) -> None:
    """The word that ends a position's handshake leaves it on its way."""
    pair.says(position(4, GO, 500), position(4, last, 500))
    assert pair.refuses(wheel(1, ENABLE, 1)) == (LEFT_MOVES, (wheel(1, ENABLE, 0),))
    assert pair.says(wheel(1, ENABLE, 0)) == (wheel(1, ENABLE, 0),)
    assert pair.says(wheel(1, HALT, 50)) == (wheel(1, HALT, 50),)


@pytest.mark.parametrize("word", [HALT, OFF, SHUTDOWN, 0x000B])
def test_a_lift_that_was_told_to_rest_gives_the_way_free(pair: Bench, word: int) -> None:
    pair.says(position(4, GO, 500), position(4, ENABLE, 500), position(4, word, 500))
    assert pair.says(wheel(1, ENABLE, 100)) == (wheel(1, ENABLE, 100),)


def test_a_halt_that_is_taken_back_lets_the_lift_go_on(pair: Bench) -> None:
    pair.says(position(4, GO, 500), position(4, HALT, 500), wheel(1, ENABLE, 100))
    assert pair.refuses(position(4, ENABLE, 500)) == (LIFT_MOVES, (position(4, HALT, 500),))


@pytest.mark.parametrize("off", [position(4, SHUTDOWN, 500), write(4, 0x6040, 0, b"\x0b\x00")])
def test_without_power_the_lift_forgets_its_target(pair: Bench, off: Packet) -> None:
    pair.says(position(4, GO, 500), off, position(4, ENABLE, 500))
    assert pair.says(wheel(1, ENABLE, 100)) == (wheel(1, ENABLE, 100),)


@pytest.mark.parametrize("command", ["81", "82", "80"])
def test_a_lift_that_left_the_bus_forgets_its_target(pair: Bench, command: str) -> None:
    pair.says(
        position(4, GO, 500), position(4, HALT, 500), Packet("drives", 0, bytes.fromhex(command + "04"))
    )
    pair.says(position(4, ENABLE, 500))
    assert pair.says(wheel(1, ENABLE, 100)) == (wheel(1, ENABLE, 100),)


ENABLED, REACHED = 0x0737 & ~0x0400, 0x0737
CYCLE: Final = 50 * MILLISECOND


@pytest.mark.parametrize("report", [status, sample, status_read])
def test_a_lift_that_reports_that_it_is_there_gives_the_way_free(pair: Bench, report: Report) -> None:
    pair.says(position(4, GO, 500), position(4, ENABLE, 500))
    pair.hears(report(4, ENABLED), now=CYCLE)
    assert pair.refuses(wheel(1, ENABLE, 1), CYCLE)[0] == LEFT_MOVES
    pair.hears(report(4, REACHED), now=CYCLE)
    assert pair.says(wheel(1, ENABLE, 1), position(4, ENABLE, 500), now=CYCLE) == (
        wheel(1, ENABLE, 1), position(4, ENABLE, 500),
    )  # fmt: skip
    pair.hears(report(4, ENABLED), now=CYCLE)
    assert pair.says(position(4, ENABLE, 500), now=CYCLE) == (position(4, ENABLE, 500),), "it is held there"
    assert pair.refuses(position(4, GO, 500), CYCLE)[0] == LIFT_MOVES


@pytest.mark.parametrize(
    ("said", "statusword", "at"),
    [
        (position(4, ENABLE, 500), REACHED, CYCLE - 1),
        (position(4, ENABLE, 500), REACHED & ~0x0004, CYCLE),
        (position(4, ENABLE, 500), 0x0400, CYCLE),
        (position(4, GO, 900), REACHED, CYCLE + 9),
    ],
)
def test_what_may_be_older_than_the_target_or_is_not_enabled_is_no_arrival(
    pair: Bench, said: Packet, statusword: int, at: int
) -> None:
    pair.says(position(4, GO, 500))
    pair.says(said, now=10)
    pair.hears(status(4, statusword), now=at)
    assert pair.refuses(wheel(1, ENABLE, 1), at)[0] == LEFT_MOVES


@pytest.mark.parametrize("again", [GO, ENABLE])
def test_a_lift_that_goes_on_has_to_arrive_anew(pair: Bench, again: int) -> None:
    pair.says(position(4, GO, 500))
    pair.hears(status(4, REACHED), now=CYCLE)
    pair.says(position(4, HALT, 500), position(4, again, 500), now=CYCLE)
    pair.hears(status(4, REACHED), now=2 * CYCLE - 1)
    assert pair.refuses(wheel(1, ENABLE, 1), 2 * CYCLE - 1)[0] == LEFT_MOVES
    pair.hears(status(4, REACHED), now=2 * CYCLE)
    assert pair.says(wheel(1, ENABLE, 1), now=2 * CYCLE) == (wheel(1, ENABLE, 1),)


def test_the_arrival_of_another_axis_is_not_the_lift_s(pair: Bench) -> None:
    pair.says(position(4, GO, 500))
    pair.hears(status(3, REACHED), now=CYCLE)
    assert pair.refuses(wheel(1, ENABLE, 1), CYCLE)[0] == LEFT_MOVES
