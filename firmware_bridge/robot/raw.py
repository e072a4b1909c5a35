"""Looks into a robot file's raw tables, whose keys may be missing or of another type."""

import math
from collections.abc import Mapping
from typing import Any, TypeAlias

Raw: TypeAlias = Mapping[str, Any]


def number(value: object) -> float:
    """Return a number; NaN, which is above nothing, for no number or one that is reported elsewhere."""
    try:
        return float(value) if isinstance(value, int | float) else math.nan
    except OverflowError:
        return math.nan


def rows(table: Raw, key: str) -> list[Raw]:
    """Return an array of tables; an empty one for what is none."""
    found = table.get(key)
    return [row if isinstance(row, dict) else {} for row in found] if isinstance(found, list) else []


def named(table: Raw, key: str) -> dict[str, Raw]:
    """Return the tables within a table, by their names; what is no table is left out."""
    return {name: row for name, row in within(table, key).items() if isinstance(row, dict)}


def within(table: Raw, key: str) -> Raw:
    """Return a table within a table; an empty one for what is none."""
    inner = table.get(key)
    return inner if isinstance(inner, dict) else {}


def links_of(table: Raw, drivers: type) -> dict[str, Raw]:
    """Return the raw links whose `driver` is a word of an enumeration, by their names."""
    words = [str(word) for word in drivers]  # type: ignore[attr-defined] # an enumeration's class
    return {name: link for name, link in named(table, "links").items() if link.get("driver") in words}
