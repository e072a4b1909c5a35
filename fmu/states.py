"""An FMU's state, kept aside and brought back: what a plant needs so that time can be rewound.

The FMU copies itself (fmi2GetFMUstate, fmi3GetFMUState); what is in a copy is its own affair. A copy dies
with its Python object, or with the instance that it belongs to, whichever is first.
"""

import ctypes
import weakref
from typing import Any, Final

from fmu.calls import OK_OR_WARNING, STATUS

_NAMES: Final = {
    2: ("fmi2GetFMUstate", "fmi2SetFMUstate", "fmi2FreeFMUstate"),
    3: ("fmi3GetFMUState", "fmi3SetFMUState", "fmi3FreeFMUState"),
}


class StateError(Exception):
    """The FMU refused to copy itself, or to become a copy; the message names the call, and its status."""


class Copy:
    """One state of one FMU instance."""

    __slots__ = ("__weakref__", "_vault", "pointer")

    def __init__(self, vault: "Vault", pointer: ctypes.c_void_p) -> None:
        self._vault = vault
        self.pointer = pointer

    def __del__(self) -> None:
        # The FMU's memory, which Python's collector does not know.
        self._vault.free(self.pointer)


class Vault:
    """Store of copies of one FMU instance, which frees the remaining ones when the instance goes."""

    def __init__(self, library: ctypes.CDLL, instance: int, major: int) -> None:
        """Take the loaded library; AttributeError where it lacks a function that the FMI demands."""
        self._instance: Final = ctypes.c_void_p(instance)
        self._names: Final = _NAMES[major]
        self._get, self._set, self._free = (_function(library, name) for name in self._names)
        # Weak: a copy that nothing refers to is to be freed at once.
        self._copies: weakref.WeakSet[Copy] = weakref.WeakSet()
        self._open = True

    def copy(self) -> Copy:
        """Copy the state of the instance now."""
        pointer = ctypes.c_void_p()
        self._check(0, self._get(self._instance, ctypes.byref(pointer)))
        copy = Copy(self, pointer)
        self._copies.add(copy)
        return copy

    def bring_back(self, copy: Copy) -> None:
        """Give the instance the state of a copy, which stays as it is."""
        self._check(1, self._set(self._instance, copy.pointer))

    def knows(self, copy: Copy) -> bool:
        """Return True if a copy was taken from this instance."""
        return copy in self._copies

    def free(self, pointer: ctypes.c_void_p) -> None:
        """Give a copy's memory back."""
        if self._open:
            self._free(self._instance, ctypes.byref(pointer))

    def close(self) -> None:
        """Free all copies: the instance is about to go, and they belong to it."""
        for copy in self._copies:
            self.free(copy.pointer)
        self._open = False

    def _check(self, call: int, status: int) -> None:
        if status > OK_OR_WARNING:
            word = STATUS[status] if status < len(STATUS) else f"status {status}"
            raise StateError(f"{self._names[call]} failed ({word})")


def _function(library: ctypes.CDLL, name: str) -> Any:
    function = library[name]
    function.restype = ctypes.c_int
    return function
