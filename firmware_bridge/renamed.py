"""Words of the release before: each goes on working for this release, with a warning that names the new word.

A robot file's keys, methods of what a robot package makes, and arguments that it gives.
"""

import functools
import warnings
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final, TypeVar

T = TypeVar("T")

ROBOT_KEYS: Final[Mapping[tuple[str, str], str]] = {("geometry", "limp"): "degraded"}
"""Old keys of a robot file, by their table, and what they are called now."""

CHOICES: Final[Mapping[str, str]] = {"tells-cured": "reports-reset"}
"""Old names of `emulate epos2 --choice`."""


class RenamedWarning(FutureWarning):
    """A word of the release before was used; the text names the new one."""


def warn(old: str, new: str, where: str = "") -> None:
    """Warn that `old` is called `new`; `where` names a file or a class."""
    text = f"'{old}' is called '{new}' now; the old name works in this release only"
    warnings.warn(f"{where}: {text}" if where else text, RenamedWarning, stacklevel=3)


def current(name: str, renamed: Mapping[str, str], where: str) -> str:
    """Return what a name is called now; a warning where it is an old one."""
    new = renamed.get(name)
    if new is None:
        return name
    warn(name, new, where)
    return new


def with_new_keys(table: Mapping[str, Any], file: str, known: Iterable[str]) -> dict[str, Any]:
    """Return a robot's table with the keys of today, but for those that its own geometry has (`known`)."""
    made = dict(table)
    for (name, old), new in ROBOT_KEYS.items():
        inner = made.get(name)
        if isinstance(inner, Mapping) and old in inner and new not in inner and old not in known:
            warn(f"{name}.{old}", f"{name}.{new}", file)
            made[name] = {new if key == old else key: value for key, value in inner.items()}
    return made


def arguments(**new_by_old: str) -> Callable[[type[T]], type[T]]:
    """Return a decorator of a class that takes arguments under their old names, too."""

    def decorated(made: type[T]) -> type[T]:
        begin: Callable[..., None] = getattr(made, "__init__")  # noqa: B009 - as below

        @functools.wraps(begin)
        def with_old(self: T, *given: Any, **named: Any) -> None:
            for old in new_by_old.keys() & named.keys():
                warn(old, new_by_old[old], made.__name__)
                named[new_by_old[old]] = named.pop(old)
            begin(self, *given, **named)

        setattr(made, "__init__", with_old)  # noqa: B010 - mypy lets no method be assigned
        return made

    return decorated


class _Adapted:
    """Something with a method under its old name, which is called by the new one."""

    def __init__(self, made: object, old: str, new: str) -> None:
        self._made = made
        setattr(self, new, getattr(made, old))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._made, name)


def makes(made_by: Callable[..., T], old: str, new: str) -> Callable[..., T]:
    """Return what makes the same, with the method `new` where a robot package still calls it `old`."""

    @functools.wraps(made_by)
    def make(*given: Any, **named: Any) -> T:
        made = made_by(*given, **named)
        if hasattr(made, new) or not hasattr(made, old):
            return made
        warn(old, new, type(made).__name__)
        adapted: Any = _Adapted(made, old, new)
        return adapted  # type: ignore[no-any-return] # it has all that the other has

    return make
