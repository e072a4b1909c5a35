"""Analysis of a class before any of its instances is looked at: its mutability, and the place of its state.

Unknown classes are refused: a generator, an open file or an object of an extension module may hold a hidden
state, and a run that is put back without it would go on differently, silently.
"""

import ctypes
import re
import struct
import types
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from decimal import Decimal
from enum import Enum
from fractions import Fraction
from functools import partial
from itertools import chain
from pathlib import PurePath
from typing import Any, Final, ForwardRef, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from emulators.rewind.capture import (
    CAPTURES,
    SAVES_STATE,
    Capture,
    NotCaptured,
    SavesState,
    slots_capture,
    slots_of,
)
from emulators.rewind.compiled import (
    attributes_of,
    compiled_base,
    compiled_capture,
    function_parts,
    is_compiled,
)
from firmware_bridge.immutable import Immutable
from firmware_bridge.packet import Packet, Reaction

PLAIN: Final[tuple[type, ...]] = (
    int, float, complex, str, bytes, bool, type(None), type, range, slice, Enum, Decimal, Fraction,
    np.generic, np.dtype, PurePath, struct.Struct, re.Pattern, re.Match,
    types.ModuleType, types.EllipsisType, types.NotImplementedType, types.MemberDescriptorType,
    # Addresses of native functions and memory; the memory itself is found as what it is.
    ctypes.CDLL, *ctypes.CFUNCTYPE(None).__bases__, *ctypes.POINTER(ctypes.c_int).__bases__,
    type(ctypes.byref(ctypes.c_int())),
    Packet, Reaction, NotCaptured,
)  # fmt: skip
"""Types whose contents neither change in a run nor are part of it, classes and modules among them."""


def _function(thing: types.FunctionType) -> Iterable[object]:
    yield from thing.__closure__ or ()
    yield from thing.__defaults__ or ()
    yield from (thing.__kwdefaults__ or {}).values()


CARRIERS: Final[Mapping[type, Callable[[Any], Iterable[object]]]] = {
    tuple: iter,
    frozenset: iter,
    types.FunctionType: _function,
    types.MethodType: lambda thing: (thing.__self__, thing.__func__),
    types.BuiltinMethodType: lambda thing: (thing.__self__,),
    types.MethodWrapperType: lambda thing: (thing.__self__,),
    types.MappingProxyType: lambda thing: chain(thing, thing.values()),
    partial: lambda thing: (thing.func, *thing.args, *thing.keywords.values()),
    # Once raised, an error is read and not changed; its traceback is for people.
    BaseException: lambda thing: (*thing.args, *vars(thing).values()),
}
"""Unchangeable objects, and the objects that they lead to."""


@dataclass(frozen=True, slots=True, eq=False)
class Treatment:
    """Treatment of the instances of one class."""

    plain: bool = False
    """True if they cannot change, and lead to nothing that can."""
    parts: Callable[[Any], Iterable[object]] | None = None
    """Function that yields the objects that an unchangeable instance leads to."""
    captures: tuple[Capture, ...] = ()
    """Captures of instances that change as a whole."""
    attributes: bool = False
    """True if they have a `__dict__` that changes."""

    @property
    def known(self) -> bool:
        """True if anything is known of them."""
        return self.plain or self.parts is not None or bool(self.captures) or self.attributes


_TREATMENTS: Final[dict[type, Treatment]] = {}


def treatment_of(cls: type) -> Treatment:
    """Return how instances of this class are treated; one that is not `known` must be refused."""
    treatment = _TREATMENTS.get(cls)
    if treatment is None:
        treatment = _TREATMENTS[cls] = _judged(cls)
    return treatment


def _judged(cls: type) -> Treatment:
    if issubclass(cls, PLAIN) or _is_plain(cls):
        return Treatment(plain=True)
    parts = next((parts for base, parts in CARRIERS.items() if issubclass(cls, base)), None)
    if parts is None and _is_frozen(cls):
        parts = _frozen_parts(cls)
    parts = parts or function_parts(cls)
    return _thing(cls) if parts is None else Treatment(parts=parts)


def _thing(cls: type) -> Treatment:
    """Return how instances are kept that can change; nothing is known of those that hide something."""
    if issubclass(cls, SavesState):
        return Treatment(captures=(SAVES_STATE,))
    captures = [capture for base, capture in CAPTURES if issubclass(cls, base)]
    if not captures and is_compiled(cls):
        return Treatment(captures=(compiled_capture(cls),)) if attributes_of(cls) else Treatment(plain=True)
    if not captures:
        # A package's class may extend a compiled one: that one's part is listed, and the rest is Python's.
        base = compiled_base(cls) or object
        if _hides_state(cls, base):
            return Treatment()
        if base is not object and attributes_of(base):
            captures.append(compiled_capture(base))
    if slots_of(cls):
        captures.append(slots_capture(cls))
    attributes = cls.__dictoffset__ != 0
    return Treatment(plain=not captures and not attributes, captures=tuple(captures), attributes=attributes)


def _hides_state(cls: type, base: type) -> bool:
    """Return whether an instance has more memory than `base`, slots and pointers account for."""
    pointer = ctypes.sizeof(ctypes.c_void_p)
    pointers = len(slots_of(cls)) + (cls.__dictoffset__ > 0) + (cls.__weakrefoffset__ > 0)
    return cls.__basicsize__ > base.__basicsize__ + pointer * pointers or cls.__itemsize__ > 0


def _is_frozen(cls: type) -> bool:
    if is_dataclass(cls):
        params = cls.__dataclass_params__  # type: ignore[attr-defined] # dataclasses say it nowhere else
        return bool(params.frozen or params.unsafe_hash)  # a hash by value, too, promises that it stays
    frozen = getattr(cls, "model_config", {}).get("frozen", False)  # pydantic's
    return bool(frozen) or issubclass(cls, Immutable)


def _frozen_parts(cls: type) -> Callable[[Any], Iterable[object]]:
    slots = [member.__name__ for member in slots_of(cls).values()]
    names = attributes_of(cls) if is_compiled(cls) else [name for name in slots if not name.startswith("__")]

    def parts(thing: Any) -> Iterable[object]:
        for name in names:
            yield getattr(thing, name, None)
        yield from getattr(thing, "__dict__", {}).values()

    return parts


def _is_plain(cls: type) -> bool:
    """Return whether the declared types of a frozen class promise that nothing below it can change.

    The promise is mypy's to keep. It saves looking through each packet and each sample of a run. A compiled
    class declares less: mypyc leaves out what is in brackets, and writes `type` for all that is no class.
    """
    if is_dataclass(cls) and _is_frozen(cls):
        names = [field.name for field in fields(cls)]
    elif issubclass(cls, tuple) and hasattr(cls, "_fields"):
        names = list(cls._fields)
    else:
        return False
    try:
        hints = get_type_hints(cls)
    except NameError:
        return False
    return all(name in hints and _promises(hints[name]) for name in names)


def _stays_plain(cls: type) -> bool:
    """Return whether whatever has this type is plain. What `object` or a protocol stands for need not be."""
    return cls is not type and (issubclass(cls, PLAIN) or _is_plain(cls))


def _promises(hint: Any) -> bool:
    if isinstance(hint, str | ForwardRef):
        return False
    origin = get_origin(hint)
    if origin is None:
        return hint is Ellipsis or (isinstance(hint, type) and _stays_plain(hint))
    if origin is Literal:
        return True
    # The mutable object behind a `Mapping` is held as a dict by its owner, and checked there.
    if origin in (Final, Union, types.UnionType, tuple, frozenset, Mapping):
        return all(_promises(part) for part in get_args(hint))
    return False
