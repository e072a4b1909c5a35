"""The tables of the installed families in a robot file: which there are, and which one a raw table is of.

The schema is made when the first robot file is read: only then are the families loaded, which import this
package themselves.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import reduce
from operator import or_
from typing import Annotated, Any, Final, Literal, TypeAlias

from pydantic import Discriminator, GetCoreSchemaHandler, Tag
from pydantic_core import CoreSchema

from firmware_bridge.family import families
from firmware_bridge.robot.table import Table

Kind: TypeAlias = Literal["link", "axis", "sensor", "output"]
WORDS: Final[Mapping[Kind, str]] = {"link": "driver", "axis": "device"}
"""The key whose words name the family; a table of the other kinds is known by its keys."""


def tables(kind: Kind) -> tuple[type[Table], ...]:
    """Return the tables of a kind, in the order of the families."""
    own = [getattr(family, kind) for family in families()]
    return tuple(table for table in own if table is not None)


def words(kind: Kind) -> dict[str, type[Table]]:
    """Return the words that name a family's table of this kind, with the table."""
    key = WORDS.get(kind, "")
    return {word: table for table in tables(kind) for word in words_of(table, key)}


def words_of(table: type[Table], key: str) -> tuple[str, ...]:
    """Return the words that a table may have under a key; none where it takes no particular ones."""
    field = table.model_fields.get(key)
    named = None if field is None else field.annotation
    return tuple(map(str, named)) if isinstance(named, type) and issubclass(named, StrEnum) else ()


def mark(table: type[Table]) -> str:
    """Return the mark of one table of a union; as part of a mistake's place it is no one's key."""
    return f"<{table.__name__}>"


def table_of(kind: Kind, raw: object) -> type[Table] | None:
    """Return the table that a raw one is of: by its word, else by most of its keys; None for none."""
    known = tables(kind)
    # Before the check the table is a dict, after it an object: a model is checked again as it is.
    if not isinstance(raw, Mapping):
        return type(raw) if isinstance(raw, Table) and type(raw) in known else next(iter(known), None)
    named = words(kind).get(str(raw.get(WORDS.get(kind, ""))))
    return named or max(known, key=lambda table: len(raw.keys() & table.model_fields.keys()), default=None)


@dataclass(frozen=True, slots=True)
class FamilyTable:
    """The mark of a field whose table is a family's; for pydantic the union of all that are installed."""

    kind: Kind

    def tables(self) -> tuple[type[Table], ...]:
        """Return the tables that may stand there."""
        return tables(self.kind)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return the schema of the union."""
        known = self.tables()
        if len(known) < 2:  # noqa: PLR2004 - a union has two or more
            return handler.generate_schema(next(iter(known), source))
        members = [Annotated[table, Tag(mark(table))] for table in known]
        return handler.generate_schema(Annotated[reduce(or_, members), Discriminator(self._chosen)])

    def _chosen(self, raw: Any) -> str | None:
        table = table_of(self.kind, raw)
        return None if table is None else mark(table)
