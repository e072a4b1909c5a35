"""Each kind of thing that can change is kept, and put back in place."""

from collections.abc import Callable
from typing import Any, Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.rewind import Rewind
from hil_tests.unit.rewind.boxes import Box, Mutable, Narrow, Slotted, changes, everything
from hil_tests.unit.rewind.digest import digest


def test_everything_is_put_back_in_place() -> None:
    box = everything()
    identities = {name: id(value) for name, value in vars(box).items()}
    rewind = Rewind(box)
    before, moment = digest(box), rewind.snapshot()
    for _ in range(3):
        changes(box)
        assert digest(box) != before
        rewind.restore(moment)
        assert digest(box) == before
        assert {name: id(value) for name, value in vars(box).items() if name != "number"} == {
            name: identity for name, identity in identities.items() if name != "number"
        }
    assert list(box.table) == ["a", "b"]
    assert not hasattr(box, "late")
    assert not hasattr(box.slotted, "left")


@pytest.mark.parametrize(
    "name", [name for name in vars(everything()) if name not in ("number", "text", "plain")]
)
def test_a_digest_sees_each_of_these_changes(name: str) -> None:
    """The second opinion is one only if it notices: everything else alike, this one changed."""
    one, other = everything(), everything()
    assert digest(getattr(one, name)) == digest(getattr(other, name))
    changes(one)
    assert digest(getattr(one, name)) != digest(getattr(other, name))


def test_moments_come_in_any_order() -> None:
    box = everything()
    rewind = Rewind(box)
    moments = []
    for _ in range(4):
        moments.append((digest(box), rewind.snapshot()))
        changes(box)
        box.text = "again"
    for place in (2, 0, 3, 3, 1, 0, 2):
        before, moment = moments[place]
        rewind.restore(moment)
        assert digest(box) == before
        changes(box)


def test_the_same_thing_seen_from_two_sides_stays_the_same_thing() -> None:
    shared: list[int] = [1]
    box = Box(one=shared, other=Box(list=shared))
    rewind = Rewind(box)
    moment = rewind.snapshot()
    box.one = [2]
    shared.append(5)
    rewind.restore(moment)
    assert box.one is box.other.list
    assert box.one == [1]


def test_an_equal_thing_in_the_place_of_another_is_noticed() -> None:
    """Two empty lists are equal; only one of them is the one that changes afterwards."""
    box = Box(items=[])
    rewind = Rewind(box)
    rewind.snapshot()
    box.items = []
    moment = rewind.snapshot()
    box.items.append(1)
    rewind.restore(moment)
    assert box.items == []


@pytest.mark.parametrize(("one", "equal"), [(0.0, -0.0), (1, True), (1, 1.0), ((1,), (True,))])
def test_equal_values_are_not_mixed_up(one: object, equal: object) -> None:
    box = Box(value=one)
    rewind = Rewind(box)
    first = rewind.snapshot()
    box.value = equal
    second = rewind.snapshot()
    rewind.restore(first)
    assert repr(box.value) == repr(one)
    rewind.restore(second)
    assert repr(box.value) == repr(equal)


def test_what_came_later_is_kept_from_then_on() -> None:
    box = Box(things=[])
    rewind = Rewind(box)
    empty = rewind.snapshot()
    for number in range(2000):  # so many that what was known is found again on the way
        box.things.append(Box(number=[number]))
        if number % 7 == 0:
            del box.things[0]
            rewind.snapshot()
    moment, before = rewind.snapshot(), digest(box)
    for thing in box.things:
        thing.number.append(0)
    rewind.restore(moment)
    assert digest(box) == before
    rewind.restore(empty)
    assert box.things == []
    rewind.snapshot()
    rewind.restore(moment)
    assert digest(box) == before


def grow_all(root: Box, _: int, number: int) -> None:
    for item in root.extra:
        item.items.append(number)


def nest(root: Box, place: int, number: int) -> None:
    root.items[place] = Box(value=number, table={0: root.items[place]})


DEEDS: Final[tuple[Callable[[Box, int, int], None], ...]] = (
    lambda root, place, number: setattr(root.items[place], "value", number),
    lambda root, place, number: root.items[place].table.update({number % 3: [number]}),
    lambda root, _, number: setattr(root, "extra", (*root.extra, Mutable([number]))),
    lambda root, _, __: setattr(root, "items", list(root.items)),
    grow_all,
    nest,
)


@given(st.lists(st.tuples(st.sampled_from(DEEDS), st.integers(0, 3), st.integers()), max_size=40))
def test_whatever_is_done_between_two_moments_is_undone(deeds: list[tuple[Any, int, int]]) -> None:
    """Boxes in boxes, lists that are replaced, tuples with new things in them; a moment after each deed."""
    root = Box(items=[Box(value=0, table={}) for _ in range(4)], extra=())
    rewind = Rewind(root)
    moments = [(digest(root), rewind.snapshot())]
    for deed, place, number in deeds:
        deed(root, place, number)
        moments.append((digest(root), rewind.snapshot()))
    for before, moment in (*reversed(moments), *moments):
        rewind.restore(moment)
        assert digest(root) == before


def test_a_slot_behind_another_of_its_name_is_kept() -> None:
    hidden: Any = vars(Slotted)["left"]
    thing = Narrow()
    hidden.__set__(thing, 1)
    thing.left, thing.only = 2, 3
    rewind = Rewind(thing)
    moment = rewind.snapshot()
    hidden.__set__(thing, 7)
    thing.left = 8
    del thing.only
    rewind.restore(moment)
    assert (hidden.__get__(thing), thing.left, thing.only) == (1, 2, 3)
