"""The output guard's rules over several axes: `[guard]` in a robot file."""

from typing import Annotated

from pydantic import Field

from firmware_bridge.robot.table import Finite, Name, Positive, Table


class GuardSum(Table):
    """A sum of axis speeds, each with its factor, that the guard bounds to both sides."""

    name: str
    of: Annotated[dict[Name, Finite], Field(min_length=1)]
    """A factor for each axis's speed in its unit a second."""
    bound: Positive


class GuardExclusive(Table):
    """Axes of which only one side may be commanded to move at a time."""

    name: str
    one: Annotated[tuple[Name, ...], Field(min_length=1, strict=False)]
    other: Annotated[tuple[Name, ...], Field(min_length=1, strict=False)]


class GuardTable(Table):
    """The output guard's rules over several axes; the bounds of each one are its travel and top_speed."""

    sums: Annotated[tuple[GuardSum, ...], Field(strict=False)] = ()
    exclusive: Annotated[tuple[GuardExclusive, ...], Field(strict=False)] = ()
