"""Each kind of thing that can change is kept and put back in place; what cannot be kept is refused."""

import ctypes
import struct
from array import array
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.rewind import Apart, Outside, Rewind, RewindError
from hil_tests.unit.rewind.digest import digest


class Box:
    """Anything with attributes."""

    def __init__(self, **content: Any) -> None:
        vars(self).update(content)

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...
        def __setattr__(self, name: str, value: Any) -> None: ...


class Slotted:
    __slots__ = ("left", "right")
    left: int
    right: int


class Narrow(Slotted):
    """Hides a slot of its base behind one of the same name."""

    __slots__ = ("left", "only")
    only: int


@dataclass(slots=True)
class Mutable:
    items: list[int] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Frozen:
    inner: Box
    call: Callable[[], int]


class Pair(NamedTuple):
    first: list[int]
    second: int


class Record(ctypes.Structure):
    _fields_ = (("count", ctypes.c_int64), ("share", ctypes.c_double))


def counter() -> Callable[[], int]:
    count = 0

    def up() -> int:
        nonlocal count
        count += 1
        return count

    return up


def changes(box: Box) -> None:
    """Change everything in place that `everything` holds."""
    box.number += 1
    box.late = "a new attribute"
    del box.text
    box.items.append(4)
    box.items[0] = [9]
    box.table["new"] = 1
    box.table["a"] = box.table.pop("a")  # now the last one
    box.queue.popleft()
    box.queue.append("z")
    box.names.add("y")
    box.raw += b"more"
    box.slotted.left = 5
    if hasattr(box.slotted, "right"):
        del box.slotted.right
    box.mutable.items.extend((1, 2))
    box.frozen.inner.value = 2
    box.frozen.call()
    box.pair.first.clear()
    box.record.count = 77
    box.samples[1] = 7.5
    box.doubles[1] = 7.5
    box.double.value = -0.0
    box.array[2] = 3.0
    box.chance.random()
    box.method()
    box.partial()
    box.proxied["k"].append(1)


def everything() -> Box:
    slotted = Slotted()
    slotted.right = 3  # `left` was never assigned
    inside: dict[str, list[int]] = {"k": []}
    tally: list[int] = []
    return Box(
        number=1000,
        text="old",
        items=[[1], 2, 3],
        table={"a": 0.0, "b": -0.0},
        queue=deque(["x", "y"], maxlen=5),
        names={"x"},
        raw=bytearray(b"abc"),
        samples=array("d", [1.0, 2.0]),
        slotted=slotted,
        mutable=Mutable(),
        frozen=Frozen(Box(value=1), counter()),
        pair=Pair([1], 2),
        record=Record(5, 0.5),
        doubles=(ctypes.c_double * 3)(1.0, 2.0, 3.0),
        double=ctypes.c_double(1.0),
        array=np.zeros(4),
        chance=np.random.default_rng(3),
        method=deque([1] * 30).pop,
        partial=partial(tally.append, 1),
        proxied=MappingProxyType(inside),
        plain=(struct.Struct("<H"), 1.5, "text", Box),
    )


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
    for number in range(2000):  # so many that what was known is found anew on the way
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


def test_what_is_outside_is_left_alone(tmp_path: Path) -> None:
    with (tmp_path / "log").open("w") as file:
        box = Box(number=1, observers=Outside([file.write]))
        rewind = Rewind(box)
        moment = rewind.snapshot()
        box.observers.append(print)
        box.number = 2
        rewind.restore(moment)
        assert box.number == 1
        assert len(box.observers) == 2


class Hidden(Apart):
    """Stands for a class whose state is forgotten."""

    def __init__(self) -> None:
        self.count = 0


def test_a_state_that_is_forgotten_shows_in_the_digest() -> None:
    box = Box(hidden=Hidden())
    rewind = Rewind(box)
    before, moment = digest(box), rewind.snapshot()
    box.hidden.count = 1
    rewind.restore(moment)
    assert digest(box) != before


class Stubborn:
    """A keeper that gives nothing away."""

    def save_state(self) -> object:
        raise RuntimeError("not now")

    def restore_state(self, _: Any) -> None:
        raise RuntimeError("never")


def test_a_keeper_that_refuses_leaves_everything_as_it_is() -> None:
    class Once(Stubborn):
        def save_state(self) -> object:
            return None

    box = Box(number=1, keeper=Once())
    rewind = Rewind(box)
    moment = rewind.snapshot()
    box.number = 2
    with pytest.raises(RuntimeError, match="never"):
        rewind.restore(moment)
    assert box.number == 2
    with pytest.raises(RuntimeError, match="not now"):
        Rewind(Box(keeper=Stubborn())).snapshot()


def endless() -> Any:
    while True:
        yield 1


@pytest.mark.parametrize(
    ("made", "name"),
    [
        (endless, "generator"),
        (lambda: iter([1, 2]), "list_iterator"),
        (lambda: map(abs, [1]), "map"),
        (lambda: Path(__file__).open(), "TextIOWrapper"),  # noqa: SIM115 - it is never read
        (lambda: memoryview(bytearray(3)), "memoryview"),
    ],
)
def test_a_state_that_nobody_sees_is_refused_with_its_place(made: Callable[[], Any], name: str) -> None:
    hidden = made()
    box = Box(inner=Box(table={"key": [Frozen(Box(task=hidden), abs)]}))  # type: ignore[arg-type] # any callable
    rewind = Rewind(box)
    for _ in range(2):
        with pytest.raises(RewindError, match=rf"{name} has a state.*Box\.inner > Box\.table.*Box\.task"):
            rewind.snapshot()
    box.inner.table["key"].clear()
    rewind.snapshot()
    box.inner.table["key"].append(hidden)
    with pytest.raises(RewindError, match=name):
        rewind.snapshot()
    if hasattr(hidden, "close"):
        hidden.close()


def test_after_a_refusal_nothing_is_taken_for_known() -> None:
    """What was found on the way to the refusal, and what hangs on it, is looked for again."""
    box = Box(things=[])
    rewind = Rewind(box)
    rewind.snapshot()
    box.things.append(Box(first=[1], hidden=endless(), last=[2]))
    with pytest.raises(RewindError):
        rewind.snapshot()
    box.things[0].hidden = None
    before, moment = digest(box), rewind.snapshot()
    box.things[0].first.append(0)
    box.things[0].last.append(0)
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
