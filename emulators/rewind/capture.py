"""Capture and restoration of each kind of object: one row for each built-in type that can change.

Objects keep their identity: a list is filled again, it is not replaced, so its holders see its old contents.
"""

import ctypes
from array import array
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import chain
from operator import attrgetter, is_not
from types import CellType, MemberDescriptorType
from typing import Any, Final, Protocol, TypeVar, runtime_checkable

import numpy as np

Item = TypeVar("Item")


class RewindError(Exception):
    """An object has a state that cannot be kept or put back; the message names it, and its place."""


class NotCaptured:
    """Marker for a class whose instances are no part of the run: they are neither kept nor looked into."""

    __slots__ = ()


class External(NotCaptured, list[Item]):
    """A list whose content belongs to someone outside of the run."""


@runtime_checkable
class SavesState(Protocol):
    """A thing whose state Python cannot see, and which keeps it itself."""

    def save_state(self) -> object:
        """Return the state now; nothing that happens later may change what is returned."""

    def restore_state(self, state: Any) -> None:
        """Take a state that was saved before, as often as one likes."""


def _same_items(thing: Any, copy: Any) -> bool:
    return len(thing) == len(copy) and not any(map(is_not, thing, copy))


def _same_members(thing: dict[Any, Any], copy: dict[Any, Any]) -> bool:
    # With their order: an iteration must go on as it did then.
    keys = list(thing) == list(copy)
    return keys and not any(map(is_not, thing.values(), copy.values()))


def _same_attributes(thing: dict[str, Any], copy: dict[str, Any]) -> bool:
    # An attribute that comes again is the last one, so the names need not all be compared.
    if len(thing) != len(copy) or any(map(is_not, thing.values(), copy.values())):
        return False
    return not thing or next(reversed(thing)) == next(reversed(copy))


@dataclass(frozen=True, slots=True, eq=False)
class Capture:
    """Functions that capture one kind of object."""

    copy: Callable[[Any], Any]
    parts: Callable[[Any], Iterable[object]] | None
    """Function that yields everything that a copy refers to; None where it refers to nothing."""
    put_back: Callable[[Any, Any], None]
    """Restore an object from its copy."""
    same: Callable[[Any, Any], bool] = _same_items
    """Return True if an object still refers to the same objects in the same places as its copy.

    Equal ones do not count. It is called for every object at every moment, and true of most: so it comes
    before the copying.
    """


class _Unset:
    """Contents of a slot that was not assigned."""


UNSET: Final = _Unset()


def _put_items(thing: Any, copy: Any) -> None:
    thing[:] = copy


def _put_elements(thing: Any, copy: Any) -> None:
    thing.clear()
    thing.extend(copy)


def _put_members(thing: Any, copy: Any) -> None:
    thing.clear()
    thing.update(copy)


def _put_attributes(thing: dict[str, Any], copy: dict[str, Any]) -> None:
    thing.update(copy)
    if len(thing) != len(copy):
        for name in [name for name in thing if name not in copy]:
            del thing[name]


def _put_bytes(thing: Any, copy: bytes) -> None:
    # In place: the kernel in C holds the address.
    ctypes.memmove(ctypes.addressof(thing), copy, len(copy))


def _cell_content(thing: CellType) -> tuple[object, ...]:
    try:
        return (thing.cell_contents,)
    except ValueError:
        return ()


def _same_content(thing: CellType, copy: tuple[object, ...]) -> bool:
    try:
        return bool(copy) and thing.cell_contents is copy[0]
    except ValueError:
        return not copy


def _put_content(thing: CellType, copy: tuple[object, ...]) -> None:
    if copy:
        thing.cell_contents = copy[0]
    else:
        del thing.cell_contents


def _put_generator(thing: np.random.Generator, copy: dict[str, Any]) -> None:
    thing.bit_generator.state = copy


def _put_array(thing: Any, copy: Any) -> None:
    thing[...] = copy


_SIMPLE: Final = ctypes.c_double.__bases__[0]
"""The base of ctypes' numbers."""

ATTRIBUTES: Final = Capture(dict.copy, dict.values, _put_attributes, _same_attributes)
"""An instance's `__dict__`. Its order means nothing, its shared keys mean speed: so it is not emptied."""
SAVES_STATE: Final = Capture(
    lambda thing: thing.save_state(), None, lambda thing, copy: thing.restore_state(copy)
)

CAPTURES: Final[tuple[tuple[type, Capture], ...]] = (
    (dict, Capture(dict.copy, lambda copy: chain(copy, copy.values()), _put_members, _same_members)),
    (list, Capture(list.copy, iter, _put_items)),
    (deque, Capture(list, iter, _put_elements)),
    (set, Capture(set.copy, iter, _put_members)),
    (bytearray, Capture(bytes, None, _put_items)),
    (array, Capture(lambda thing: thing[:], None, _put_items)),
    (CellType, Capture(_cell_content, iter, _put_content, _same_content)),
    (ctypes.Structure, Capture(bytes, None, _put_bytes)),
    (ctypes.Array, Capture(bytes, None, _put_bytes)),
    (_SIMPLE, Capture(bytes, None, _put_bytes)),
    (np.random.Generator, Capture(lambda thing: thing.bit_generator.state, None, _put_generator)),
    (np.ndarray, Capture(np.ndarray.copy, None, _put_array)),
)


def slots_of(cls: type) -> dict[str, MemberDescriptorType]:
    """Return the slots that an instance has, those of its bases included."""
    return {
        f"{base.__qualname__}.{name}": member
        for base in cls.__mro__
        if "__slots__" in vars(base)
        for name, member in vars(base).items()
        if isinstance(member, MemberDescriptorType)
    }


def slots_capture(cls: type) -> Capture:
    """Return how the slots of this class are kept: as a tuple, in one call where all of them are assigned."""
    members = tuple(slots_of(cls).values())
    names = [member.__name__ for member in members]
    at_once = attrgetter(*names)
    plural = 1 < len(names) == len(set(names))  # a slot of a base may have the same name

    def copy(thing: object) -> tuple[object, ...]:
        try:
            values: tuple[object, ...] = at_once(thing) if plural else _one_by_one(members, thing)
        except AttributeError:
            return _one_by_one(members, thing)
        return values

    def put_back(thing: object, copy: tuple[object, ...]) -> None:
        for member, value in zip(members, copy, strict=True):
            # A slot that was not assigned then must not be assigned now.
            if value is UNSET:
                if _slot(member, thing) is not UNSET:
                    member.__delete__(thing)
            else:
                member.__set__(thing, value)

    def same(thing: object, before: tuple[object, ...]) -> bool:
        return not any(map(is_not, copy(thing), before))

    return Capture(copy, iter, put_back, same)


def _one_by_one(members: tuple[MemberDescriptorType, ...], thing: object) -> tuple[object, ...]:
    return tuple([_slot(member, thing) for member in members])


def _slot(member: MemberDescriptorType, thing: object) -> object:
    try:
        value: object = member.__get__(thing)
    except AttributeError:
        return UNSET
    return value
