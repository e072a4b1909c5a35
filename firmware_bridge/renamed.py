"""Words of the release before: each goes on working for this release, with a warning that names the new word.

A robot file's keys, methods of what a robot package makes, and arguments that it gives.
"""

import functools
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from importlib import import_module
from typing import Any, Final, TypeVar

T = TypeVar("T")

ROBOT_KEYS: Final[Mapping[tuple[str, str], str]] = {
    ("axes", "belief"): "plausibility",
    ("axes", "stands_with"): "standstill_group",
    ("geometry", "limp"): "degraded",
    ("operator", "gone_ms"): "lost_ms",
}
"""Old keys of a robot file, by their table, and what they are called now."""

STEP_KEYS: Final[Mapping[str, str]] = {"guide": "path_follower"}
"""Old keys of a mission's step."""

INTERLOCKS: Final[Mapping[str, str]] = {
    "another master": "second controller",
    "axis answers late": "late answer",
    "axis does not follow": "tracking error",
    "axis left out": "axis excluded",
    "axis moves unasked": "uncommanded motion",
    "axis position repeats": "position not changing",
    "axis rewritten": "axis reconfigured",
    "axis silent": "axis timeout",
    "axis unmeasured": "no feedback",
    "axis zero lost": "reference lost",
    "bridge stood still": "bridge stalled",
    "controls deflected": "stick not neutral",
    "operator gone": "operator link lost",
    "operator silent": "operator link timeout",
    "paused": "operation paused",
    "wish unusable": "command unusable",
    "word too old": "command stale",
    "word undated": "command not timestamped",
}
"""Old names of interlocks, without the axis or the link behind them."""

STAGE: Final = " unconfirmed"
"""End of each old name that named a stop stage, which is named in the text now."""
NOT_ACKNOWLEDGED: Final = "stop not acknowledged"

FAULT_KINDS: Final[Mapping[str, str]] = {"nmt_stranger": "nmt_foreign_node"}
"""Old kinds of faults."""

FAULT_VALUES: Final[Mapping[tuple[str, str, str], str]] = {("bridge_ends", "how", "asked"): "interrupted"}
"""Old values of a fault's keys, by kind and key."""

CHOICES: Final[Mapping[str, str]] = {"tells-cured": "reports-reset"}
"""Old names of `emulate epos2 --choice`."""

KINEMATICS_METHODS: Final[Mapping[str, str]] = {
    "asked": "requested",
    "demands": "set_points",
    "rested": "at_standstill",
}
"""Old methods of a robot's kinematic model."""

SERVO: Final[Mapping[str, str]] = {"twin": "reference"}
"""Old values of the environment variable that chooses the servo's implementation."""


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


def interlock(name: str, where: str) -> str:
    """Return an interlock's name of today, with its axis or link; a warning where it is an old one."""
    title, colon, of = name.partition(": ")
    if title.endswith(STAGE):
        warn(title, NOT_ACKNOWLEDGED, where)
        return NOT_ACKNOWLEDGED + colon + of
    return current(title, INTERLOCKS, where) + colon + of


def old_interlock(name: str) -> str:
    """Return what an interlock was called before."""
    title, colon, of = name.partition(": ")
    return next((old for old, new in INTERLOCKS.items() if new == title), title) + colon + of


class Interlocks(Mapping[str, str]):
    """Interlocks by name, with their reasons; an old name finds what it is called now, with a warning."""

    def __init__(self, reasons: Mapping[str, str], where: str, shown: Callable[[str], str] = str) -> None:
        """Take the reasons by name; `shown` makes the names over which one iterates."""
        self._reasons: Final = reasons
        self._where: Final = where
        self._shown: Final = shown

    def __getitem__(self, name: str) -> str:
        # A third party's own interlock may have a name that was one of ours before.
        return self._reasons[name if name in self._reasons else interlock(name, self._where)]

    def __iter__(self) -> Iterator[str]:
        return map(self._shown, self._reasons)

    def __len__(self) -> int:
        return len(self._reasons)

    def __repr__(self) -> str:
        return repr(dict(self))


def fault_table(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return a fault's table of a mission with the kind and the values of today."""
    kind = table.get("kind")
    if not isinstance(kind, str):
        return dict(table)
    kind = current(kind, FAULT_KINDS, "fault")
    made = {**table, "kind": kind}
    for (of, key, old), new in FAULT_VALUES.items():
        if of == kind and made.get(key) == old:
            warn(old, new, f"fault {kind}, {key}")
            made[key] = new
    return made


def with_new_keys(table: Mapping[str, Any], file: str, known: Iterable[str]) -> dict[str, Any]:
    """Return a robot's table with the keys of today, but for those that its own geometry has (`known`)."""
    made = dict(table)
    for (name, old), new in ROBOT_KEYS.items():
        # A third party's geometry may have a key of its own with this name.
        if name == "geometry" and old in known:
            continue
        inner = made.get(name)
        tables = inner if isinstance(inner, list) else [inner]
        # Where both names are given the new one counts, and the old one is reported as an unknown key.
        if any(isinstance(one, Mapping) and old in one and new not in one for one in tables):
            warn(f"{name}.{old}", f"{name}.{new}", file)
            changed = [_with_key(one, old, new) for one in tables]
            made[name] = changed if isinstance(inner, list) else changed[0]
    return made


def _with_key(table: Any, old: str, new: str) -> Any:
    if not isinstance(table, Mapping) or old not in table or new in table:
        return table
    return {new if key == old else key: value for key, value in table.items()}


def step_table(table: Any) -> Any:
    """Return the table of a mission's step with the keys of today."""
    for old, new in STEP_KEYS.items():
        if isinstance(table, Mapping) and old in table and new not in table:
            warn(old, new, "step")
            table = _with_key(table, old, new)
    return table


def module(old: str, new: str, **names: str) -> Callable[[str], Any]:
    """Return the `__getattr__` of a module that is called `new` now, with what its names are called there."""

    def read(name: str) -> Any:
        target, made = names.get(name, name), vars(import_module(new))
        # Python itself looks up dunder names in modules, which must not import the new one.
        if name.startswith("__") or target not in made:
            raise AttributeError(f"module '{old}' has no attribute '{name}'")
        warn(f"{old}.{name}", f"{new}.{target}")
        return made[target]

    return read


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


def kinematics(made_by: Callable[..., T]) -> Callable[..., T]:
    """Return what makes the same kinematic model, with today's methods."""
    for old, new in KINEMATICS_METHODS.items():
        made_by = makes(made_by, old, new)
    return made_by
