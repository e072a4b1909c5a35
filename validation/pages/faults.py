"""The faults that a mission can name, as a page: one section for each row of the table."""

from collections.abc import Iterator
from types import MappingProxyType
from typing import Any, Final, Literal, get_args, get_origin

from pydantic.fields import FieldInfo

from emulators.bench.faults import FaultKind, kinds
from emulators.cli.faults import COMMON

HEADINGS: Final = ("key", "meaning", "values", "default")
_SIGNS: Final = MappingProxyType({"ge": ">=", "gt": ">", "le": "<=", "lt": "<"})
"""Pydantic's names of a bound."""


def target(kind: FaultKind) -> str:
    """Return whom a fault of this kind meets, in words."""
    fields = kind.fault.model_fields
    if "node" not in fields:
        return "see `between`" if "between" in fields else "the whole link or bus"
    return kind.fault.among.value + ("" if fields["node"].is_required() else "; without `node` all")


def parameters(kind: FaultKind) -> Iterator[tuple[str, str, str, str]]:
    """Give a row for each key of its own."""
    for name, field in kind.fault.model_fields.items():
        if name not in COMMON:
            without = (
                "required" if field.is_required() else "-" if field.default is None else repr(field.default)
            )
            yield f"`{name}`", field.description or "", values(field), without


def values(field: FieldInfo) -> str:
    """Return the values that a key takes, as far as its type gives them."""
    choices = _choices(field.annotation)
    if choices:
        return ", ".join(f"`{choice}`" for choice in choices)
    bounds = (
        f"{sign} {getattr(each, bound):g}"
        for each in field.metadata
        for bound, sign in _SIGNS.items()
        if hasattr(each, bound)
    )
    return " and ".join(bounds)


def _choices(annotation: Any) -> tuple[str, ...]:
    if get_origin(annotation) is Literal:
        return tuple(str(choice) for choice in get_args(annotation))
    return tuple(choice for part in get_args(annotation) for choice in _choices(part))


def sections() -> Iterator[tuple[FaultKind, list[tuple[str, str, str, str]]]]:
    """Give every kind with the rows of its keys."""
    for kind in kinds().values():
        yield kind, list(parameters(kind))
