"""Boards whose line is lost, or that fall silent: what was under way fails, nothing has power after it."""

from collections.abc import Sequence
from typing import Final

import pytest

from firmware_bridge.drivers.driver import Power
from firmware_bridge.drivers.life_cycle import AT_REST, DriverState, Task, Transition
from firmware_bridge.drivers.line_driver import LOST
from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.unit.drivers.test_life_cycle import ArmLine, ShieldLine

LONG: Final = 6 * SECOND
"""Longer than any board starts, or is looked for."""


Board = ShieldLine | ArmLine


@pytest.fixture(params=[ShieldLine, ArmLine])
def board(request: pytest.FixtureRequest) -> Board:
    made: Board = request.param()
    return made


def begins(board: Board, transition: Transition, task: Task | None = None) -> None:
    """Begin it for each axis, as the bridge does."""
    for driver in board.drivers.drivers:
        board.sends(driver.begin(transition, board.now, task))


def up(board: Board) -> Board:
    begins(board, Transition.RECOVER)
    board.runs(LONG)
    assert states(board) == {DriverState.ACTIVE}
    return board


def states(board: Board) -> set[DriverState]:
    return {driver.state for driver in board.drivers.drivers}


def failures(board: Board) -> Sequence[str]:
    return [str(driver.failure) for driver in board.drivers.drivers if driver.failure is not None]


def powers(board: Board) -> set[Power]:
    return {driver.feedback.power for driver in board.drivers.drivers}


def loses(board: Board) -> None:
    board.sends(board.link.receive(Packet(board.link.name, LINE_LOST, b""), board.now))


def finds(board: Board) -> None:
    board.sends(board.link.receive(Packet(board.link.name, LINE_BACK, b""), board.now))


def test_what_is_under_way_fails_with_the_line_each_time(board: Board) -> None:
    for _ in range(2):
        begins(board, Transition.RECOVER)
        board.runs(3 * MILLISECOND)
        assert not states(board) & set(AT_REST)
        loses(board)
        assert all(LOST in failure for failure in failures(board))
        assert len(failures(board)) == len(board.drivers.drivers)
        assert board.link.lost == LOST
        finds(board)
        assert board.link.lost is None
    up(board)


def test_a_line_that_is_lost_at_rest_is_no_failure_and_nothing_is_sent_on_it(board: Board) -> None:
    up(board)
    for _ in range(2):
        loses(board)
        assert (failures(board), powers(board), states(board)) == (
            [],
            {Power.UNKNOWN},
            {DriverState.UNCONFIGURED},
        )
        before = board.sent
        board.runs(SECOND)
        assert board.sent == before
        finds(board)
        board.runs(LONG)
        # It is set up again by itself, and has no power until that is requested.
        assert states(board) == {DriverState.INACTIVE}
        assert not any(driver.feedback.power is Power.ON for driver in board.drivers.drivers)
        begins(board, Transition.ACTIVATE)
        board.runs(SECOND)
        assert states(board) == {DriverState.ACTIVE}


def test_bytes_at_the_address_of_a_loss_are_no_loss(board: Board) -> None:
    up(board)
    board.sends(board.link.receive(Packet(board.link.name, LINE_LOST, b"x"), board.now))
    assert board.link.lost is None
    assert states(board) == {DriverState.ACTIVE}


def silent_for(board: Board, time: Nanoseconds) -> None:
    board.silent = True
    board.runs(time)


def test_a_board_that_is_silent_has_no_known_power_and_is_set_up_again_without_it(board: Board) -> None:
    up(board)
    for _ in range(2):
        silent_for(board, 2 * SECOND)
        assert powers(board) == {Power.UNKNOWN}
        assert not states(board) & {DriverState.ACTIVE, DriverState.INACTIVE}
        board.silent = False
        board.runs(LONG)
        assert states(board) == {DriverState.INACTIVE}
        begins(board, Transition.ACTIVATE)
        board.runs(SECOND)
        assert states(board) == {DriverState.ACTIVE}


def test_a_board_that_never_answers_fails_and_gets_no_power(board: Board) -> None:
    board.silent = True
    for _ in range(2):
        begins(board, Transition.RECOVER)
        board.runs(20 * SECOND)
        assert len(failures(board)) == len(board.drivers.drivers)
        assert powers(board) == {Power.UNKNOWN}


def test_a_board_without_set_up_is_not_enabled(board: Board) -> None:
    for _ in range(2):
        begins(board, Transition.RECOVER, Task.ENABLE)
        assert all("first" in failure for failure in failures(board))
        assert len(failures(board)) == len(board.drivers.drivers)
        board.runs(100 * MILLISECOND)
        assert powers(board) == {Power.UNKNOWN}


def test_reports_that_do_not_begin_are_a_failure(board: Board) -> None:
    begins(board, Transition.CONFIGURE)
    board.runs(LONG)
    assert states(board) == {DriverState.INACTIVE}
    for _ in range(2):
        begins(board, Transition.CONFIGURE, Task.START)
        # No cycle requests a sample; only the time goes on.
        end = board.now + 20 * SECOND
        while board.now < end and not failures(board):
            board.now += MILLISECOND
            board.sends(board.link.wake(board.now) if board.link.wake_at <= board.now else ())
            board.sends(board.passes())
        assert len(failures(board)) == len(board.drivers.drivers)
        assert states(board) <= {DriverState.INACTIVE, DriverState.UNCONFIGURED}
        board.runs(LONG)
