"""A second opinion on what a run's state is: everything that the garbage collector reaches, as one hash.

It knows nothing of how moments are taken. Two digests are the same when the same structure of objects holds
the same values; which addresses they have does not count.
"""

import ctypes
import gc
import hashlib
from array import array
from enum import Enum
from types import FunctionType, ModuleType
from typing import Any, Final

import numpy as np

from emulators.rewind import External, Rewind
from fmu.plant import FmuPlant

_SCALARS: Final = (int, str, bytes, bytearray, array, bool, type(None), complex, np.generic)
_SAME_FOR_ALL: Final = (type, ModuleType, ctypes.CDLL, External, Rewind)
_Hash: Final = type(hashlib.sha256())


def digest(root: object) -> str:
    """Walk everything below `root`."""
    reported = hashlib.sha256()
    places: dict[int, int] = {}
    alive: list[object] = []
    stack: list[object] = [root]
    while stack:
        thing = stack.pop()
        text, parts = _reported(thing, places)
        reported.update(f"{type(thing).__name__} {text}\n".encode())
        if parts is not None:
            places[id(thing)] = len(places)
            alive.append(thing)
            stack += reversed(parts)
    return reported.hexdigest()


def _reported(thing: Any, places: dict[int, int]) -> tuple[str, list[Any] | None]:
    """Return the thing's own words, and what is below it; None where nothing is."""
    value = _value(thing)
    if value is not None:
        return value, None
    if id(thing) in places:
        return f"seen {places[id(thing)]}", None
    if isinstance(thing, FmuPlant):
        return _plant(thing), []
    if isinstance(thing, FunctionType):
        return thing.__qualname__, [*(thing.__closure__ or ()), thing.__defaults__]
    own = vars(thing) if hasattr(thing, "__dict__") else {}
    # In which order attributes came is no state.
    attributes = [each for name in sorted(own) for each in (name, own[name])]
    return _hidden(thing), attributes + [part for part in gc.get_referents(thing) if part is not own]


def _value(thing: Any) -> str | None:
    """Return what a thing without parts is; None for one with parts."""
    if isinstance(thing, float):
        return thing.hex()
    if isinstance(thing, Enum):
        return thing.name
    if isinstance(thing, _SAME_FOR_ALL):
        return getattr(thing, "__qualname__", "")
    return repr(thing) if isinstance(thing, _SCALARS) else None


def _hidden(thing: Any) -> str:
    """Return the state that no reference leads to."""
    if isinstance(thing, _Hash):
        return str(thing.hexdigest())
    if isinstance(thing, np.random.Generator):
        return repr(thing.bit_generator.state)
    if isinstance(thing, set | frozenset):
        return repr(sorted(map(repr, thing)))
    if isinstance(thing, np.ndarray):
        return thing.tobytes().hex()
    if isinstance(thing, ctypes.Structure | ctypes.Array | ctypes.c_double):
        return bytes(thing).hex()
    return ""


def _plant(plant: FmuPlant) -> str:
    """Return every variable of the plant, read one by one."""
    names = [variable.name for variable in plant._references._variables.values()]  # noqa: SLF001 - private
    return repr([plant.steps_done, *(plant.read(name).hex() for name in names)])
