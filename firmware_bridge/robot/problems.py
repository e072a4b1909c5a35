"""The mistakes of a file of tables: all of them at once, each with its key, and a near name."""

from collections.abc import Collection, Iterator
from difflib import get_close_matches
from enum import EnumType
from typing import Final, NamedTuple, Protocol, get_args, runtime_checkable

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

MOST_NAMES = 12
"""So many known names are listed where none is near."""
KINDS_OF_VALUES: Final = {
    "model_type": "a table",
    "dict_type": "a table",
    "tuple_type": "an array",
    "string_type": "a string",
    "int_type": "an integer",
    "float_type": "a number",
    "bool_type": "true or false",
}
"""The required value in TOML's words, by the name of pydantic's error."""


@runtime_checkable
class HasTables(Protocol):
    """The mark of a field in whose place one of several tables stands."""

    def tables(self) -> tuple[type[BaseModel], ...]:
        """Return the tables."""


class Problem(NamedTuple):
    """One mistake: the key's path, what is wrong, and what to do."""

    key: str
    problem: str


class FileError(Exception):
    """A file that cannot be used: which one, which keys, what is wrong with each."""

    def __init__(self, file: str, *problems: Problem) -> None:
        super().__init__(file, *problems)
        self.file = file
        self.problems = problems

    def __str__(self) -> str:
        """Say it in a line for each mistake."""
        return "\n".join(
            f"{self.file}: {key}: {problem}" if key else f"{self.file}: {problem}"
            for key, problem in self.problems
        )


class RobotFileError(FileError):
    """A robot file that cannot be used."""


def nearest(name: object, known: Collection[str]) -> list[str]:
    """Return the known name that this one may be meant for, if any is near."""
    return get_close_matches(str(name), known, n=1)


def near(name: object, known: Collection[str], most: int = MOST_NAMES) -> str:
    """Return the ending of a message about a name that is not known; it lists no more than `most` others."""
    close = nearest(name, known)
    if close:
        return f"perhaps '{close[0]}'?"
    if len(known) > most:
        return f"there are {len(known)}"
    return f"there are: {', '.join(known)}" if known else "there are none"


def problems_of(error: ValidationError, model: type[BaseModel]) -> Iterator[Problem]:
    """Yield every mistake that a model has found; a list is not short for what is wrong within it."""
    found = [(path(one["loc"]), one) for one in error.errors()]
    for key, one in found:
        # A list whose entries are wrong is empty for the checker: its being too short is a consequence.
        if one["type"] != "too_short" or not any(other.startswith(f"{key}[") for other, _ in found):
            yield Problem(key, _text_of(one, model))


def path(location: tuple[int | str, ...]) -> str:
    """Return a key's path as a person writes it."""
    parts = (part for part in location if not _is_tag(part))
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in parts).lstrip(".")


def _is_tag(part: int | str) -> bool:
    """Return whether a part of a place is the mark of one table of a union."""
    return isinstance(part, str) and part.startswith("<")


def _text_of(error: ErrorDetails, model: type[BaseModel]) -> str:
    location, given = error["loc"], error["input"]
    if error["type"] == "extra_forbidden":
        return f"no such key; {near(location[-1], _keys_at(model, location[:-1]))}"
    if error["type"] == "missing":
        return "is missing"
    if error["type"] in KINDS_OF_VALUES:
        return f"must be {KINDS_OF_VALUES[error['type']]}, but it is {given!r}"
    if error["type"] in {"enum", "literal_error"}:
        known = [str(getattr(one, "value", one)) for one in _choices_at(model, location)]
        return f"'{given}' is not known; {near(given, known)}"
    if error["type"] in {"too_short", "too_long"}:
        few, context = error["type"] == "too_short", error.get("ctx", {})
        bound = f"at least {context.get('min_length')}" if few else f"at most {context.get('max_length')}"
        return f"must have {bound} of them, but it has {context.get('actual_length')}"
    text = error["msg"].removeprefix("Value error, ")
    return text if given is None or isinstance(given, dict | list) else f"{text}, but it is {given!r}"


def _keys_at(model: type[BaseModel], location: tuple[int | str, ...]) -> list[str]:
    table = model
    for place, part in enumerate(location):
        if isinstance(part, str) and part in table.model_fields:
            inner = _table(table.model_fields[part], location[place + 1 :])
            if inner is None:
                return []
            table = inner
    return list(table.model_fields)


def _choices_at(model: type[BaseModel], location: tuple[int | str, ...]) -> list[object]:
    table, others = model, [model]
    choices: list[object] = []
    for place, part in enumerate(location):
        if isinstance(part, str) and part in table.model_fields:
            field = table.model_fields[part]
            inner = _table(field, location[place + 1 :])
            if inner is None:
                # A word that chooses between tables may be any of theirs.
                fields = [other.model_fields[part] for other in others if part in other.model_fields]
                choices = [one for each in fields for one in _choices(each.annotation)]
            else:
                table, others = inner, list(_tables_of(field))
    return choices


def _choices(annotation: object) -> list[object]:
    kinds = [annotation, *get_args(annotation)]
    return [one for kind in kinds for one in _members(kind)] or kinds[1:]


def _members(kind: object) -> list[object]:
    return list(kind.__members__.values()) if isinstance(kind, EnumType) else []


def _table(field: FieldInfo, rest: tuple[int | str, ...]) -> type[BaseModel] | None:
    """Return the table of a field; of several the one whose mark is the next in the place."""
    marks = [part for part in rest if _is_tag(part)]
    found = list(_tables_of(field))
    marked = [table for table in found if marks and marks[0] == f"<{table.__name__}>"]
    return next(iter(marked or found), None)


def _tables_of(field: FieldInfo) -> Iterator[type[BaseModel]]:
    marks = [it for it in field.metadata if isinstance(it, HasTables)]
    return iter(marks[0].tables()) if marks else _tables(field.annotation)


def _tables(annotation: object) -> Iterator[type[BaseModel]]:
    """Yield the tables that an annotation names, however it wraps them."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
        return
    inner = get_args(annotation)
    marks = [it for it in inner if isinstance(it, HasTables)]
    if marks:
        yield from marks[0].tables()
        return
    for one in inner:
        yield from _tables(one)
