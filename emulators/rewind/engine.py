"""Checkpoints of the state of everything that can be reached from one object, and their restoration.

No class declares its state: the objects are walked, so nothing can be forgotten. The walk takes some
milliseconds and is done once; afterwards each known thing is copied, and only what is new is looked into.
Things keep their identity, so every reference finds its object as it was.
"""

from collections.abc import Callable, Iterable
from itertools import chain, compress, repeat
from operator import is_not
from typing import Any, Final, TypeAlias

from emulators.rewind.capture import ATTRIBUTES, SAVES_STATE, Capture, NotCaptured, RewindError
from emulators.rewind.classes import treatment_of
from emulators.rewind.compiled import namespace_of

_LEAST_GROWTH: Final = 256
"""Least growth, with half of the known number, that makes a fresh walk worth while: many are gone again."""
_NO_ONE: Final = repeat(object())
"""Placeholder in the places that a shorter copy does not have."""

_Trail: TypeAlias = tuple[object, Any] | None
"""A thing, and the trail of the one through which it was found."""


class _Group:
    """All known things that are captured in one way, in the order of finding, and what they last held."""

    __slots__ = ("capture", "states", "things")

    def __init__(self, capture: Capture) -> None:
        self.capture = capture
        self.things: list[Any] = []
        self.states: list[Any] = []


class Checkpoint(NotCaptured):
    """One instant of a run; it can be restored as often as one likes, and in any order with others."""

    __slots__ = ("_kept", "_owner")

    def __init__(self, owner: "Rewind", kept: tuple[tuple[Capture, list[Any], list[Any]], ...]) -> None:
        self._owner = owner
        self._kept = kept

    def put_back(self, owner: "Rewind") -> None:
        """Give all things their state of this instant."""
        if owner is not self._owner:
            raise RewindError("this checkpoint was taken elsewhere: restore it where it was taken")
        for capture, things, states in self._kept:
            put_back = capture.put_back
            for thing, state in zip(things, states, strict=False):  # what was found later stands behind
                put_back(thing, state)


class Rewind(NotCaptured):
    """Checkpoints of everything that `root` leads to."""

    def __init__(self, root: object) -> None:
        self._root = root
        self._found = 0
        """Number of objects found since the walk."""
        self._forget()

    def snapshot(self) -> Checkpoint:
        """Keep this instant; RewindError where something has a state that cannot be kept."""
        if self._found > max(_LEAST_GROWTH, len(self._ids) // 3):
            self._forget()
        try:
            if self._ids:
                for group in tuple(self._groups.values()):
                    self._look(group)
            else:
                self._find(self._root, None)
                self._found = 0
        except BaseException:
            self._forget()  # half a walk must not pass for a whole one
            raise
        kept = tuple((group.capture, group.things, list(group.states)) for group in self._groups.values())
        return Checkpoint(self, kept)

    def restore(self, checkpoint: Checkpoint) -> None:
        """Go back, or forward, to a checkpoint that was taken here."""
        checkpoint.put_back(self)

    def _forget(self) -> None:
        """Forget all known objects: the next checkpoint walks again. Checkpoints keep theirs."""
        # What saves its own state comes first: that alone can refuse, and then nothing has been put back yet.
        self._groups: dict[Capture, _Group] = {SAVES_STATE: _Group(SAVES_STATE)}
        self._ids: set[int] = set()
        self._alive: list[object] = []
        """Objects whose id is in `_ids`: while they live no other object can have it."""
        self._plain: set[type] = set()

    def _look(self, group: _Group) -> None:
        """Copy the things of a group that have changed, and find what has come into reach through them."""
        capture, things, states = group.capture, group.things, group.states
        if capture.parts is None:
            group.states = list(map(capture.copy, things))
            return
        copy, parts, same, plain = capture.copy, capture.parts, capture.same, self._plain
        # Those that are found meanwhile stand behind, with their states of now.
        for at in [at for at, still in enumerate(map(same, things, states)) if not still]:
            thing, before = things[at], states[at]
            now = states[at] = copy(thing)
            moved = [value for value in _others(parts, now, before) if type(value) not in plain]
            if moved:
                # What has only moved within the thing is known already.
                seen = set(map(id, _others(parts, before, now)))
                for value in moved:
                    if id(value) not in seen:
                        self._find(value, (thing, None))

    def _find(self, value: object, trail: _Trail) -> None:
        """Take note of every thing that can change and that this value leads to."""
        ids, alive = self._ids, self._alive
        carriers: dict[int, object] = {}
        # A stack of its own: object graphs are deeper than Python's recursion limit.
        stack = [(value, trail)]
        while stack:
            thing, trail = stack.pop()
            cls = type(thing)
            if cls in self._plain or id(thing) in ids or id(thing) in carriers:
                continue
            treatment = treatment_of(cls)
            if treatment.plain:
                self._plain.add(cls)
                continue
            if not treatment.known:
                raise RewindError(_refusal(thing, trail))
            here = (thing, trail)
            if treatment.parts is not None:
                # Alive for the time of the walk, so that no other object gets its id.
                carriers[id(thing)] = thing
                stack += [(part, here) for part in treatment.parts(thing)]
                continue
            ids.add(id(thing))
            alive.append(thing)
            for capture in treatment.captures:
                stack += [(part, here) for part in self._note(capture, thing)]
            if treatment.attributes:
                stack += [(part, here) for part in self._note(ATTRIBUTES, namespace_of(thing))]

    def _note(self, capture: Capture, thing: object) -> Iterable[object]:
        """Add a thing to those that are captured alike, and return what it leads to."""
        group = self._groups.get(capture)
        if group is None:
            group = self._groups[capture] = _Group(capture)
        copy = capture.copy(thing)
        group.things.append(thing)
        group.states.append(copy)
        self._found += 1
        return () if capture.parts is None else capture.parts(copy)


def _others(parts: Callable[[Any], Iterable[object]], one: Any, other: Any) -> Iterable[object]:
    """Return the parts of one copy in whose places the other has others: of a list that grew, what came."""
    return compress(parts(one), map(is_not, parts(one), chain(parts(other), _NO_ONE)))


def _refusal(thing: object, trail: _Trail) -> str:
    cls = type(thing)
    path: list[str] = []
    inner = thing
    while trail is not None:
        outer, trail = trail
        path.append(f"{type(outer).__qualname__}{_place(outer, inner)}")
        inner = outer
    return (
        f"a {cls.__module__}.{cls.__qualname__} has a state that cannot be kept, so time cannot be rewound;"
        f" it hangs on {' > '.join(reversed(path)) or 'nothing'}: let that hold data only, or give it"
        " save_state and restore_state"
    )


def _place(outer: object, inner: object) -> str:
    """Return the name under which one object holds another, as far as it can be found."""
    names = [
        *getattr(outer, "__dict__", {}),
        *(name for base in type(outer).__mro__ for name in vars(base).get("__slots__", ())),
    ]
    for name in names:
        if getattr(outer, name, None) is inner:
            return f".{name}"
    if isinstance(outer, dict):
        return next((f"[{key!r}]" for key, value in outer.items() if value is inner), "")
    return ""
