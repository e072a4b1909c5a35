"""Instances of compiled classes: they have neither slots nor a `__dict__`, but a list of their attributes.

mypyc leaves the names in `__mypyc_attrs__`, those of the bases included. An attribute that holds a number
gives a new object each time it is read; one that is `Final` cannot be written, and need not be. A compiled
function within a function holds the variables of the outer one in an object without introspection: the
garbage collector returns its references. A number in it would be unseen: no such function changes one.
"""

import ctypes
import gc
from collections.abc import Callable, Iterable
from contextlib import suppress
from itertools import compress
from operator import attrgetter, is_not
from typing import Any, Final

from emulators.rewind.capture import UNSET, Capture, RewindError

_LISTED: Final = "__mypyc_attrs__"
_OUTER: Final = "__mypyc_env__"
_MARK: Final = "__internal_mypyc_setup"
_FIRST: Final = "_first"


def is_compiled(cls: type) -> bool:
    """Return whether all that an instance holds is listed: its bases were compiled too, or hold nothing."""
    return _LISTED in vars(cls) and all(_LISTED in vars(base) or _holds_nothing(base) for base in cls.__mro__)


def compiled_base(cls: type) -> type | None:
    """Return the compiled class that an interpreted one extends, or the class itself; None for neither."""
    return next((base for base in cls.__mro__ if is_compiled(base)), None)


def _holds_nothing(cls: type) -> bool:
    """Return whether instances are no larger than an empty object, as those of `object` and `abc.ABC`."""
    return cls.__basicsize__ == object.__basicsize__ and cls.__dictoffset__ == 0


def attributes_of(cls: type) -> tuple[str, ...]:
    """Return the names of what an instance of a compiled class holds."""
    # A class that others may extend lists the place of their attributes, too: see `namespace_of`.
    return tuple(name for name in getattr(cls, _LISTED) if name != "__dict__")


def namespace_of(thing: object) -> dict[str, object]:
    """Return the attributes of an instance with a `__dict__`, also where a compiled base hides that name."""
    offset = type(thing).__dictoffset__
    # mypyc reserves a place for the attributes of classes that extend a compiled one, and gives it no name.
    if offset <= 0 or hasattr(thing, "__dict__"):
        return vars(thing)
    place: Any = ctypes.py_object.from_address(id(thing) + offset)
    with suppress(ValueError):
        found: dict[str, object] = place.value
        return found
    # Empty so far: it is made with the first attribute.
    object.__setattr__(thing, _FIRST, None)
    object.__delattr__(thing, _FIRST)
    made: dict[str, object] = place.value
    return made


def function_parts(cls: type) -> Callable[[Any], Iterable[object]] | None:
    """Return what a compiled function leads to that was made within another one, or None if `cls` is none."""
    if _MARK not in vars(cls) or _LISTED in vars(cls):
        return None
    return _outer if hasattr(cls, _OUTER) else gc.get_referents


def compiled_capture(cls: type) -> Capture:
    """Return how instances of this compiled class are kept: as a tuple of what they hold, and their class.

    Of a class that extends it, this is its own part.
    """
    names = attributes_of(cls)
    at_once = attrgetter(*names, "__class__")  # one name alone would give no tuple

    def copy(thing: object) -> tuple[object, ...]:
        try:
            values: tuple[object, ...] = at_once(thing)
        except AttributeError:
            return (*[getattr(thing, name, UNSET) for name in names], type(thing))
        return values

    def same(thing: object, before: tuple[object, ...]) -> bool:
        values = copy(thing)
        return not any(map(is_not, values, before)) or _but_for_numbers(values, before)

    def put_back(thing: object, copy: tuple[object, ...]) -> None:
        for name, value in zip(names, copy, strict=False):
            if getattr(thing, name, UNSET) is not value:
                _put(thing, name, value)

    return Capture(copy, iter, put_back, same)


def _but_for_numbers(values: tuple[object, ...], before: tuple[object, ...]) -> bool:
    """Return whether both refer to the same objects, where equal numbers are the same."""
    others = compress(zip(values, before, strict=True), map(is_not, values, before))
    return all(type(now) is int and now == then for now, then in others)


def _outer(function: Any) -> Iterable[object]:
    return (getattr(function, _OUTER),)


def _put(thing: object, name: str, value: Any) -> None:
    if value is UNSET:
        where = f"{type(thing).__qualname__}.{name}"
        raise RewindError(
            f"{where} was not set then, and a compiled object cannot forget it: set it from the start"
        )
    try:
        setattr(thing, name, value)
    except AttributeError:
        if getattr(thing, name) != value:
            raise
