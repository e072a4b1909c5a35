"""The common part of all tables of a robot file."""

from collections.abc import Collection, Mapping
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Unsigned16 = Annotated[int, Field(ge=0, le=0xFFFF)]
Signed16 = Annotated[int, Field(ge=-0x8000, le=0x7FFF)]
Unsigned32 = Annotated[int, Field(ge=0, le=0xFFFF_FFFF)]


class Table(BaseModel):
    """A table of a robot file: no unknown key, no value of another kind, nothing changed later."""

    # Strict: "0.1" is no number, so that a value with quotes is reported and not guessed.
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, str_strip_whitespace=True)


def tag(table: type[Table]) -> Tag:
    """Return the mark of one table of a union; as part of a mistake's place it is no one's key."""
    return Tag(f"<{table.__name__}>")


def discriminated_by(
    key: str, tables: Mapping[type[Table], Collection[str]], other: type[Table]
) -> Discriminator:
    """Return what chooses a table of a union: the one that has the value under a key among its own."""

    def chosen(raw: Any) -> str:
        # Before the check the table is a dict, after it an object: a model is checked again as it is.
        given = str(raw.get(key) if isinstance(raw, dict) else getattr(raw, key, None))
        return tag(next((table for table, values in tables.items() if given in values), other)).tag

    return Discriminator(chosen)


def has_key(key: str, table: type[Table], other: type[Table]) -> Discriminator:
    """Return what chooses between two tables of which only the first has a key, and needs it."""

    def chosen(raw: Any) -> str:
        return tag(table if (key in raw if isinstance(raw, dict) else hasattr(raw, key)) else other).tag

    return Discriminator(chosen)


class LinkTable(Table):
    """A link to devices, whatever they are: `[links.NAME]`."""

    every: Annotated[int, Field(ge=1, le=100)] = 1
    """The link's devices are sampled and commanded in each so many-th cycle of the robot."""
    silent_ms: Annotated[int, Field(ge=10, le=10_000)]
    """The bridge stops the robot after this silence of a device on the link."""
    stops: Annotated[tuple[str, ...] | None, Field(strict=False)] = None
    """The groups that stop when the link is lost, or an axis on it fails; the others go on. None for all."""

    @property
    def unwatched(self) -> bool:
        """True where its devices keep their last command when the bridge falls silent."""
        return False
