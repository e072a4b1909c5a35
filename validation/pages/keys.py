"""Keys of robot files and missions, from the tables that check them: name, kind, default, bounds, meaning."""

import ast
import inspect
import textwrap
import types
from collections.abc import Callable, Iterator, Mapping, Sequence
from enum import Enum
from functools import cache
from itertools import pairwise
from typing import (
    Annotated,
    Any,
    Final,
    Literal,
    NamedTuple,
    TypeAlias,
    Union,
    get_args,
    get_origin,
)

import annotated_types
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import Mission
from emulators.bench.step import Step
from firmware_bridge.robot import Robot
from firmware_bridge.robot.family_tables import FamilyTable
from firmware_bridge.robot.table import Table
from validation.pages.safety import shipped

Cells: TypeAlias = tuple[str, ...]
HEADINGS: Final = ("key", "kind", "default", "meaning")
PLAIN: Final[Mapping[type, str]] = {
    int: "whole number",
    float: "number",
    str: "text",
    bool: "true or false",
}
BOUNDS: Final = (
    (annotated_types.Ge, "at least", "ge"),
    (annotated_types.Gt, "above", "gt"),
    (annotated_types.Le, "at most", "le"),
    (annotated_types.Lt, "below", "lt"),
)
ROBOT_TEXT: Final = """A robot file is TOML; `firmware-bridge bench FILE --mission MISSION --check` checks
it with one of its missions, and drives nothing. An unknown key, a missing one and a value of another kind are
refused, all at once, each with the file and the key. "Required" stands where there is no default. `axes`,
`sensors`, `outputs`, `guard.sums` and `guard.exclusive` are lists of tables, `[[axes]]` in TOML. `[geometry]`
is each robot type's own; those of the shipped types are at the end."""
MISSION_TEXT: Final = """A mission is TOML; `firmware-bridge bench ROBOT --mission FILE` drives it, and with
`--check` reads it and drives nothing. `step` is a list of tables, `[[step]]` in TOML, and so are
[faults](faults.md), which have a page of their own. Keys of a step that a robot adds are at the end, by
robot."""


class Section(NamedTuple):
    """One table: the path of its keys, and its class."""

    path: str
    table: type[Table]


@cache
def _texts(table: type[Table]) -> Mapping[str, str]:
    """Return the text behind each field of a class and of those that it is made of."""
    found: dict[str, str] = {}
    for cls in reversed(table.__mro__):
        if not (issubclass(cls, Table) and cls is not Table and "[" not in cls.__name__):
            continue
        (body,) = ast.parse(textwrap.dedent(inspect.getsource(cls))).body
        statements = body.body if isinstance(body, ast.ClassDef) else []
        for field, text in pairwise(statements):
            if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
                found.pop(field.target.id, None)
                if isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant):
                    found[field.target.id] = " ".join(str(text.value.value).split())
    return found


def _first(table: type[Table]) -> str:
    """Return the first sentence of a class's text, without what is written for readers of the code."""
    return (inspect.getdoc(table) or "").split("\n\n")[0].replace("\n", " ")


def rows(table: type[Table], path: str, skipped: Sequence[str] = ()) -> Iterator[Cells]:
    """Yield a line for each key of a table."""
    texts = _texts(table)
    for name, field in table.model_fields.items():
        if name not in skipped:
            yield (
                f"`{name}`",
                _kind(field, f"{path}.{name}".lstrip(".")),
                _default(field),
                texts.get(name, "-"),
            )


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    value = field.get_default(call_default_factory=True)
    if value is None or value is PydanticUndefined or value in ((), {}):
        return "none"
    if isinstance(value, Table):
        return "its defaults"
    if value == "":
        return "empty"
    if isinstance(value, Enum):
        value = value.value
    if isinstance(value, tuple):
        return f"`[{', '.join(format(one, 'g') for one in value)}]`"
    if isinstance(value, bool):
        value = str(value).lower()
    return f"`{value:g}`" if isinstance(value, float) else f"`{value}`"


def _kind(field: FieldInfo, path: str) -> str:
    return ", ".join((_shown(field.annotation, path), *_bounds(field.metadata)))


def _bounds(metadata: Sequence[Any]) -> Iterator[str]:
    for one in metadata:
        for kind, words, attribute in BOUNDS:
            if isinstance(one, kind):
                bound = getattr(one, attribute)
                yield f"{words} {bound if isinstance(bound, int) else format(bound, 'g')}"


def _shown(annotation: Any, path: str) -> str:
    """Return a kind in words; a table by the heading of its section."""
    origin, args = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        nested = [bound for one in args[1:] if isinstance(one, FieldInfo) for bound in _bounds(one.metadata)]
        return ", ".join((_shown(args[0], path), *nested))
    if origin in {Union, types.UnionType}:
        shown = [_shown(one, path) for one in args if one is not type(None)]
        return " or ".join(dict.fromkeys(shown))
    if origin is Literal:
        return " or ".join(f"`{str(one).lower() if one is True else one}`" for one in args)
    if origin in {tuple, dict}:
        inner = _shown(args[origin is dict], path)
        count = "" if args[-1] is Ellipsis else f"{len(args)} "
        many = f"table of {inner} by name" if origin is dict else f"list of {count}{inner}"
        return inner if inner.startswith("table") else many
    return _single(annotation, path)


def _single(annotation: Any, path: str) -> str:
    if isinstance(annotation, type) and issubclass(annotation, Enum):
        return " or ".join(f"`{one.value}`" for one in annotation)
    if isinstance(annotation, type) and issubclass(annotation, Table):
        return f"table `{path}`"
    return PLAIN.get(annotation, "value")


def sections(table: type[Table], path: str = "", skipped: Sequence[str] = ()) -> Iterator[Section]:
    """Yield a table and those that its keys lead to, each once."""
    yield from _sections(table, path, skipped, set())


def _sections(
    table: type[Table], path: str, skipped: Sequence[str], seen: set[type[Table]]
) -> Iterator[Section]:
    if table in seen:
        return
    seen.add(table)
    yield Section(path, table)
    for name, field in table.model_fields.items():
        if name not in skipped:
            for inner, form in _tables(Annotated[(field.annotation, *field.metadata, None)], "[{}]"):
                below = f"{path}.{name}".lstrip(".")
                yield from _sections(inner, below if form == "[{}]" else form.format(below), (), seen)


def _tables(annotation: Any, form: str) -> Iterator[tuple[type[Table], str]]:
    origin, args = get_origin(annotation), get_args(annotation)
    marks = [one for one in args if isinstance(one, FamilyTable)]
    if marks:
        yield from ((inner, form) for inner in marks[0].tables())
    elif isinstance(annotation, type) and issubclass(annotation, Table):
        yield annotation, form
    elif origin is dict:
        yield from _tables(args[1], "{}.NAME")
    elif origin is not Literal:
        for one in args:
            yield from _tables(one, form)


def robot_file(table: Callable[..., str]) -> Iterator[str]:
    """Yield the parts of the page on robot files."""
    yield ROBOT_TEXT
    yield from _parts(Robot, table, ("geometry",))
    for robot_type, _ in shipped():
        yield f"## Geometry of {robot_type.name}"
        yield from _parts(robot_type.geometry, table, (), "geometry", level="###")


def mission_file(table: Callable[..., str]) -> Iterator[str]:
    """Yield the parts of the page on missions."""
    yield MISSION_TEXT
    yield from _parts(Mission, table, ("fault",))
    for robot_type, robot in shipped():
        step = bench_setup_of(robot).step
        yield f"## Step of {robot_type.name}"
        yield table(HEADINGS, rows(step, "step", tuple(Step.model_fields)))


def _chosen(table: type[Table]) -> str:
    """Return what chooses a table among those of one path: its driver, its device."""
    for name in ("driver", "device"):
        field = table.model_fields.get(name)
        if field is not None and isinstance(field.annotation, type) and issubclass(field.annotation, Enum):
            return f", {name} {_shown(field.annotation, '')}"
    return ""


def _parts(
    whole: type[Table], table: Callable[..., str], skipped: Sequence[str], path: str = "", level: str = "##"
) -> Iterator[str]:
    for section in sections(whole, path, skipped):
        yield f"{level} {f'`{section.path}`{_chosen(section.table)}' if section.path else 'Top of the file'}"
        if section.path:
            yield _first(section.table)
        yield table(HEADINGS, rows(section.table, section.path, skipped))
