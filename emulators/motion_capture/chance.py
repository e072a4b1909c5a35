"""Chance that is drawn in advance: what a generator gives one by one, at a fraction of the cost."""

from typing import Final

from numpy.random import Generator

AT_ONCE: Final = 1_024


class Chance:
    """Normally distributed numbers, in the order in which the generator gives them; it is no one else's."""

    def __init__(self, generator: Generator) -> None:
        self._generator: Final = generator
        self._drawn: list[float] = []
        self._used = 0

    def normals(self, count: int) -> list[float]:
        """Return the next numbers, of mean 0 and standard deviation 1."""
        begin, end = self._used, self._used + count
        if end > len(self._drawn):
            # The rest comes first: the sequence is that of single draws.
            left = self._drawn[begin:]
            self._drawn = left + self._generator.standard_normal(max(AT_ONCE, count)).tolist()
            begin, end = 0, count
        self._used = end
        return self._drawn[begin:end]
