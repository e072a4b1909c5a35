"""Instances of compiled classes are kept and put back; classes that look like them stand in for them."""

from abc import ABC
from collections.abc import Collection
from dataclasses import make_dataclass

import numpy as np
import pytest

from emulators.rewind import Rewind, RewindError
from emulators.wires import Disturbance


class Counter:
    """As mypyc leaves a class: a list of names, and attributes behind descriptors."""

    __slots__ = ("_count", "_title", "log")
    __mypyc_attrs__ = ("count", "log", "title")

    def __init__(self, count: int) -> None:
        self._count = str(count)
        self._title = str(count)
        self.log: list[int] = []

    @property
    def count(self) -> int:
        """A number is a new object each time it is read."""
        return int(self._count)

    @count.setter
    def count(self, value: int) -> None:
        self._count = str(value)

    @property
    def title(self) -> int:
        """A `Final` attribute cannot be written."""
        return int(self._title)


class Extended(Counter):
    """A package's class on top of a compiled one: its own attributes are Python's."""

    def __init__(self, count: int) -> None:
        super().__init__(count)
        self.own = [count]


class LateSetter(ABC):
    __slots__ = ("early", "late")
    __mypyc_attrs__ = ("early", "late")

    late: int

    def __init__(self) -> None:
        self.early = 1


class Nothing:
    """A compiled class whose instances hold nothing."""

    __slots__ = ()
    __mypyc_attrs__ = ()


class Scope:
    """The variables of a compiled function, as those within it hold them."""

    __slots__ = ("counter",)
    vars()["__internal_mypyc_setup"] = None

    def __init__(self, counter: Counter) -> None:
        self.counter = counter


class Inner:
    """A compiled function within another one."""

    __slots__ = ("__mypyc_env__",)
    vars()["__internal_mypyc_setup"] = None

    def __init__(self, scope: Scope) -> None:
        self.__mypyc_env__ = scope

    def __call__(self) -> None:
        self.__mypyc_env__.counter.count += 1


LARGE = 10**6


def test_numbers_and_lists_come_back_and_what_is_final_stays() -> None:
    counter = Counter(LARGE)
    rewind = Rewind(counter)
    before = rewind.snapshot()
    counter.count = LARGE + 5
    counter.log.append(1)
    after = rewind.snapshot()
    rewind.restore(before)
    assert (counter.count, counter.log, counter.title) == (LARGE, [], LARGE)
    rewind.restore(after)
    assert (counter.count, counter.log, counter.title) == (LARGE + 5, [1], LARGE)


def test_a_class_that_extends_a_compiled_one_is_kept_with_both_parts() -> None:
    thing = Extended(LARGE)
    rewind = Rewind(thing)
    before = rewind.snapshot()
    thing.count = 1
    thing.own.append(2)
    rewind.restore(before)
    assert (thing.count, thing.own) == (LARGE, [LARGE])


def test_a_thing_that_comes_into_reach_later_is_found() -> None:
    counter = Counter(LARGE)
    holder = [counter]
    rewind = Rewind(holder)
    rewind.snapshot()
    other = Counter(1)
    counter.log.append(other)  # type: ignore[arg-type] # anything
    now = rewind.snapshot()
    other.count = 7
    rewind.restore(now)
    assert other.count == 1


def test_an_attribute_that_was_not_set_yet_is_refused_by_name() -> None:
    thing = LateSetter()
    rewind = Rewind(thing)
    before = rewind.snapshot()
    thing.late = 2
    with pytest.raises(RewindError, match=r"LateSetter\.late was not set then"):
        rewind.restore(before)


def test_what_holds_nothing_needs_no_keeping() -> None:
    counter = Counter(LARGE)
    rewind = Rewind([Nothing(), counter])
    before = rewind.snapshot()
    counter.count = 1
    rewind.restore(before)
    assert counter.count == LARGE


def test_what_a_function_within_a_function_changes_is_found() -> None:
    counter = Counter(LARGE)
    call = Inner(Scope(counter))
    rewind = Rewind([call])
    before = rewind.snapshot()
    call()
    assert counter.count == LARGE + 1
    rewind.restore(before)
    assert counter.count == LARGE


@pytest.mark.parametrize("left", [type, Collection, object])
def test_what_mypyc_leaves_of_a_declared_type_promises_nothing(left: type) -> None:
    """Of `list[int] | None` it leaves `type`, of `Collection[int]` an abstract class."""
    frozen = make_dataclass("Frozen", [("log", left)], frozen=True)
    thing = frozen([1])
    rewind = Rewind(thing)
    before = rewind.snapshot()
    thing.log.append(2)
    rewind.restore(before)
    assert thing.log == [1]


def test_chance_comes_back_that_hangs_on_a_frozen_thing() -> None:
    chance = np.random.default_rng(3)
    rewind = Rewind([Disturbance(share=0.5, generator=chance)])
    before = rewind.snapshot()
    drawn = chance.random()
    rewind.restore(before)
    assert chance.random() == drawn
