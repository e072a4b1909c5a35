"""The mark of a class of the compiled core from which a package's own class may inherit.

`@extensible(allow_interpreted_subclasses=True)`: without it a wheel with a compiled core refuses such a class
where it is defined (mypyc, native classes). Uncompiled the mark does nothing.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    # The compiler knows the mark by this name; it is not needed at run time.
    from mypy_extensions import mypyc_attr as extensible
else:
    _T = TypeVar("_T")

    def extensible(**_attributes: bool) -> Callable[[_T], _T]:
        """Return a decorator that returns its class."""

        def same(made: _T) -> _T:
            return made

        return same


__all__ = ["extensible"]
