"""A study: rows from which terminal output, CSV files, pictures and the report are made.

A robot's studies are a tuple of rows, which an entry point names. A study's imports happen when it is made.
"""

import importlib
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

from firmware_bridge.extras import from_extras

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Numbers: TypeAlias = "Sequence[float] | NDArray[np.float64]"
Cell: TypeAlias = float | str
Style: TypeAlias = Literal["line", "dashed", "dots", "points"]


@dataclass(frozen=True, slots=True)
class Compared:
    """One quantity three times; `printed` is None where the source gives no number."""

    quantity: str
    unit: str
    printed: float | None
    independent: float
    """Independent value: a closed form, or an integration that is written apart from the judged code."""
    ours: float
    """The project's own: its plant, its motion code, its whole chain."""
    within: float
    """Allowed difference of `ours` from `independent`, in the unit; a test checks it."""
    why: str = ""
    """Reason why they differ, or why the print does."""

    @property
    def holds(self) -> bool:
        """True if ours agrees with the independent way."""
        return math.isfinite(self.ours) and abs(self.ours - self.independent) <= self.within


@dataclass(frozen=True, slots=True)
class Curve:
    """One curve of a plot."""

    label: str
    """Text in the legend; empty for a curve that needs none."""
    x: Numbers
    y: Numbers
    style: Style = "line"


@dataclass(frozen=True, slots=True)
class Plot:
    """One pair of axes; plots of one study stand below each other."""

    title: str
    x: str
    """Quantity of the axis, with its unit: "time [s]"."""
    y: str
    curves: tuple[Curve, ...]
    caption: str
    """Content of the plot, with its place in the source."""
    equal: bool = False
    """True for both axes on one scale, as for a path."""


@dataclass(frozen=True, slots=True)
class Sheet:
    """A table of its own, beside the comparison."""

    title: str
    columns: tuple[str, ...]
    """Headings, with their units."""
    rows: tuple[tuple[Cell, ...], ...]


@dataclass(frozen=True, slots=True)
class Findings:
    """Results of a study."""

    compared: tuple[Compared, ...]
    plots: tuple[Plot, ...] = ()
    sheets: tuple[Sheet, ...] = ()
    remarks: tuple[str, ...] = ()
    """Remarks in whole sentences: the assumptions, and the limits of the study."""

    @property
    def out_of_bounds(self) -> tuple[Compared, ...]:
        """The rows that are not where the independent way is."""
        return tuple(row for row in self.compared if not row.holds)


@dataclass(frozen=True, slots=True)
class Study:
    """One study, as a row."""

    name: str
    title: str
    source: str
    """Publication, with section, equation or figure."""
    place: str
    """"module:function" of what makes it: takes whether it shall be quick, returns its `Findings`."""

    def made(self, *, quick: bool = False) -> Findings:
        """Make it; a quick one takes fewer points or a shorter run, and holds the same bounds.

        ExtraMissingError, a LookupError, where it takes a library that is not installed.
        """
        module, _, name = self.place.partition(":")
        with from_extras():
            make: Callable[[bool], Findings] = getattr(importlib.import_module(module), name)
        return make(quick)


def chosen(studies: Iterable[Study], name: str) -> tuple[Study, ...]:
    """Return the study of this name, or every one for "all"; LookupError where there is none."""
    known = {study.name: study for study in studies}
    if name == "all":
        return tuple(known.values())
    if name not in known:
        raise LookupError(f"there is no study '{name}'; there are {', '.join(known)}, and 'all'")
    return (known[name],)


def cell(value: Cell | None) -> str:
    """Return a number as people read it, five digits of it; "-" for none."""
    if value is None:
        return "-"
    return value if isinstance(value, str) else f"{value:.5g}"
