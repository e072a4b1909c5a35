"""The common part of all tables of a robot file."""

import math
from collections.abc import Collection, Mapping
from enum import StrEnum
from typing import Annotated, Any, Protocol, Self

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


class HasSettings(Protocol):
    """A row of a robot file with the table of its device."""

    @property
    def name(self) -> str:
        """The row's name."""

    @property
    def settings(self) -> Any:
        """The table of its device's family."""


class HasLinks(Protocol):
    """A robot, as far as its links go."""

    @property
    def links(self) -> Mapping[str, "LinkTable"]:
        """The links by their names."""


class SettingsTable(Table):
    """The part of an axis, a sensor or an output that its device's family defines: `settings`."""

    @classmethod
    def of(cls, row: HasSettings) -> Self:
        """Return a row's own table; TypeError where a device of another family has it."""
        if not isinstance(row.settings, cls):
            raise TypeError(f"'{row.name}' has no {cls.__name__}, but a {type(row.settings).__name__}")
        return row.settings


class AxisTable(SettingsTable):
    """One motor at its device, whatever that is."""

    continuous_current_ma: int
    peak_current_ma: int

    @property
    def number(self) -> int:
        """The number by which the motor is called on its link."""
        raise NotImplementedError

    @property
    def address(self) -> str:
        """The motor as text."""
        raise NotImplementedError

    def slowest_ramp(self, ratio: float) -> float:
        """Return the gentlest of its accelerations in the axis's unit, behind a gear of `ratio`."""
        raise NotImplementedError

    def cruise(self, ratio: float) -> float:
        """Return the speed at which it goes to a position, behind a gear of `ratio`."""
        raise NotImplementedError

    def furthest(self, ratio: float) -> float:
        """Return how far from 0 a travel may go, with `ratio` rad for each unit."""
        del ratio
        return math.inf


class LinkTable(Table):
    """A link to devices, whatever they are: `[links.NAME]`."""

    driver: StrEnum
    """The bridge's connection to the devices; it names their family."""
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

    @classmethod
    def all_of(cls, robot: HasLinks) -> dict[str, Self]:
        """Return a robot's links of this family, by their names."""
        return {name: link for name, link in robot.links.items() if isinstance(link, cls)}

    @classmethod
    def of_link(cls, robot: HasLinks, name: str) -> Self:
        """Return one link of a robot; KeyError, or TypeError where devices of another family are on it."""
        link = robot.links[name]
        if not isinstance(link, cls):
            raise TypeError(f"the link '{name}' has no {cls.__name__}, but a {type(link).__name__}")
        return link
