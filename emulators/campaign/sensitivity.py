"""How a number of the summary depends on what was varied: by ranks, or by groups."""

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from emulators.campaign.results import Row

FEWEST: Final = 4
"""Runs below which no dependence is stated."""
TOGETHER: Final = 3
"""Runs for each value of a parameter from which on its values are groups, too."""
CLEARLY: Final = 0.1


class Sensitivity(NamedTuple):
    """One number and one parameter; `strength` is -1 to 1 by ranks (Spearman), 0 to 1 by groups."""

    figure: str
    parameter: str
    strength: float
    ranked: bool
    """By ranks, with a sign; else the correlation ratio (eta), which has none."""


def varied_keys(rows: Sequence[Row]) -> list[str]:
    """Return the columns of the key that are not the same in every run."""
    names = [name for name in rows[0].key if name != "run"] if rows else []
    return [name for name in names if len({repr(row.key.get(name)) for row in rows}) > 1]


def varied_figures(rows: Sequence[Row]) -> list[str]:
    """Return the numbers of the summary that are not the same in every run."""
    names = dict.fromkeys(name for row in rows for name in row.figures)
    return [
        name for name in names if len({value for row in rows if (value := row.number(name)) is not None}) > 1
    ]


def sensitivities(rows: Sequence[Row]) -> list[Sensitivity]:
    """Return how each number depends on each parameter, the strongest first."""
    found = [
        one
        for figure in varied_figures(rows)
        for parameter in varied_keys(rows)
        if (one := _sensitivity(rows, figure, parameter)) is not None
    ]
    return sorted(found, key=lambda one: (-abs(one.strength), one.figure, one.parameter))


def _sensitivity(rows: Sequence[Row], figure: str, parameter: str) -> Sensitivity | None:
    found = [
        (value, row) for row in rows if (value := row.number(figure)) is not None and parameter in row.key
    ]
    values, known = np.array([value for value, _ in found]), [row for _, row in found]
    keys = [row.key[parameter] for row in known]
    if len(known) < FEWEST or len(set(map(repr, keys))) < 2 or values.min() == values.max():  # noqa: PLR2004 - to differ
        return None
    groups = Sensitivity(figure, parameter, _ratio(keys, values), ranked=False)
    # Seeds are names, though they are written as numbers.
    if parameter == "seed" or not all(map(_is_number, keys)):
        return groups
    strength = float(np.corrcoef(_ranks(np.array(keys, dtype=float)), _ranks(values))[0, 1])
    ranked = Sensitivity(figure, parameter, strength, ranked=True)
    # What rises and falls again has no rank correlation; groups of a few runs would follow anything.
    in_groups = len(keys) >= TOGETHER * len(set(keys))
    return groups if in_groups and groups.strength > abs(strength) + CLEARLY else ranked


def _ratio(keys: Sequence[Any], values: NDArray[np.float64]) -> float:
    groups: dict[str, list[float]] = {}
    for key, value in zip(keys, values, strict=True):
        groups.setdefault(repr(key), []).append(float(value))
    mean = float(values.mean())
    between = sum(len(group) * (sum(group) / len(group) - mean) ** 2 for group in groups.values())
    return math.sqrt(between / float(((values - mean) ** 2).sum()))


def _ranks(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ranks, equal values with their mean one."""
    _, places, counts = np.unique(values, return_inverse=True, return_counts=True)
    ends = np.cumsum(counts)
    ranks: NDArray[np.float64] = (ends - (counts - 1) / 2.0)[places]
    return ranks


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
