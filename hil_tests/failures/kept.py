"""Rows that were measured, a line each, in a file that tests and pages read: `tools/measure_stops.py`."""

import csv
from collections.abc import Iterable
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar, get_type_hints

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

R = TypeVar("R", bound="DataclassInstance")


class Kept(Generic[R]):
    """The rows of one file; its columns are the fields of their class, whole numbers or texts."""

    def __init__(self, row: type[R], name: str, folder: Path = Path(__file__).parent) -> None:
        """Name the class, and the file without its ending in its folder."""
        self._row = row
        self._file = folder / f"{name}.csv"
        self._reads = {
            name: str if hint is str else int
            for name, hint in get_type_hints(row).items()
            if name in {each.name for each in fields(row)}
        }

    def read(self) -> tuple[R, ...]:
        """Return them; none where nothing was measured yet."""
        if not self._file.exists():
            return ()
        with self._file.open(encoding="utf-8", newline="") as file:
            return tuple(self._row(**self._values(row)) for row in csv.DictReader(file))

    def write(self, rows: Iterable[R]) -> None:
        """Write them in this order."""
        with self._file.open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, list(self._reads), lineterminator="\n")
            writer.writeheader()
            writer.writerows(asdict(row) for row in rows)

    def _values(self, row: dict[str, str]) -> dict[str, Any]:
        empty = {str: "", int: None}
        return {name: reads(row[name]) if row[name] else empty[reads] for name, reads in self._reads.items()}
