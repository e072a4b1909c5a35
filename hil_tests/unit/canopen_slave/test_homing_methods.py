"""Where each homing method of CiA 402 ends, on a way of whole steps with switches and index pulses.

Source: CiA 402-2, homing methods, the standard's drawings as rows.
"""

import pytest

from emulators.canopen.homing_methods import CIA_402, Goal, HomingMove, Switch

END = 100
"""The limit switches are active from here on, on both sides."""
LAST = END + 5
EVERY, FIRST = 20, 7
"""Distance of index pulses, and place of one."""
MIDDLE = (-13, 14)
"""First and last step on which a home switch in the middle is active."""
POSITIVE_HALF, NEGATIVE_HALF = (1, LAST), (-LAST, -1)
"""Home switches that are active up to an end."""


class Way:
    """A shaft on whole steps."""

    def __init__(self, start: int, home: tuple[int, int]) -> None:
        self.place = start
        self._home = home

    def active(self, switch: Switch) -> bool:
        if switch is Switch.HOME:
            return self._home[0] <= self.place <= self._home[1]
        return self.place >= END if switch is Switch.POSITIVE_LIMIT else self.place <= -END

    def ended(self, move: HomingMove) -> bool:
        if move.goal is Goal.INDEX:
            return self.place % EVERY == FIRST
        assert move.switch is not None
        return self.active(move.switch) is (move.goal is Goal.CLOSED)

    def go(self, move: HomingMove) -> None:
        direction = move.direction
        # An index is passed, so that one under the shaft at the start is not it.
        if move.goal is Goal.INDEX:
            self.place += direction
        while not self.ended(move):
            if move.turns_at is not None and self.active(move.turns_at):
                direction = -move.direction
            self.place += direction
            assert abs(self.place) <= LAST, f"{move} runs against the end"


def _below(place: int) -> int:
    return max(it for it in range(-LAST, place) if it % EVERY == FIRST)


def _above(place: int) -> int:
    return min(it for it in range(place + 1, LAST) if it % EVERY == FIRST)


LEFT, RIGHT = MIDDLE
# By method: where the home switch is active, and the step at which the method without index ends, on the
# side of the edge to which the index is sought.
ENDS = {
    1: (MIDDLE, 1 - END, _above),
    2: (MIDDLE, END - 1, _below),
    3: (POSITIVE_HALF, 0, _below),
    4: (POSITIVE_HALF, 1, _above),
    5: (NEGATIVE_HALF, 0, _above),
    6: (NEGATIVE_HALF, -1, _below),
    **dict.fromkeys((7, 14), (MIDDLE, LEFT - 1, _below)),
    **dict.fromkeys((8, 13), (MIDDLE, LEFT, _above)),
    **dict.fromkeys((9, 12), (MIDDLE, RIGHT, _below)),
    **dict.fromkeys((10, 11), (MIDDLE, RIGHT + 1, _above)),
}


@pytest.mark.parametrize("start", range(-99, 100, 9))
@pytest.mark.parametrize("method", range(1, 15))
def test_a_method_ends_at_its_edge_from_every_start(method: int, start: int) -> None:
    home, edge, index = ENDS[method]
    way = Way(start, home)
    for move in CIA_402[method + 16]:
        way.go(move)
    assert way.place == edge
    way = Way(start, home)
    for move in CIA_402[method]:
        way.go(move)
    assert way.place == index(edge)


def test_the_table_has_the_methods_of_the_standard_and_no_reserved_one() -> None:
    assert set(CIA_402) == {0, *range(1, 15), *range(17, 31), 33, 34, 35, 37}


@pytest.mark.parametrize(("method", "end"), [(33, -13), (34, 7), (35, 3), (37, 3), (0, 3)])
def test_methods_without_a_switch(method: int, end: int) -> None:
    way = Way(3, MIDDLE)
    for move in CIA_402[method]:
        way.go(move)
    assert way.place == end


@pytest.mark.parametrize(("method", "direction"), [(number, 1) for number in (2, 3, 4, 7, 8, 9, 10)])
def test_the_first_move_away_from_every_switch_has_the_direction_of_the_standard(
    method: int, direction: int
) -> None:
    mirrored = {2: 1, 3: 5, 4: 6, 7: 11, 8: 12, 9: 13, 10: 14}[method]
    assert CIA_402[method][0].direction == direction
    assert [move.direction for move in CIA_402[mirrored]] == [-it.direction for it in CIA_402[method]]
