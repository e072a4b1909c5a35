"""Objects with a state of every kind, and what changes all of it."""

import ctypes
import struct
from array import array
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np


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
    """Class that hides a slot of its base behind one of the same name."""

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
