"""A path from a CSV file: a row of x and y in metres for each point, a heading above them or none."""

import csv
from collections.abc import Iterable
from pathlib import Path as FilePath

from firmware_bridge.pilot.paths import Path, PathError, Point

COLUMNS = ("x_m", "y_m")


def load(file: FilePath) -> Path:
    """Read a path; PathError names file and row, one that ends where it begins is closed."""
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise PathError(f"{file}: cannot be read: {error}") from error
    points = list(_points(csv.reader(text.splitlines()), file))
    closed = len(points) > 2 and points[0] == points[-1]  # noqa: PLR2004 - there and back is no ring
    try:
        return Path(points[:-1] if closed else points, closed=closed)
    except PathError as error:
        raise PathError(f"{file}: {error}") from None


def _points(rows: Iterable[list[str]], file: FilePath) -> Iterable[Point]:
    for number, row in enumerate(rows, 1):
        words = [word.strip() for word in row]
        if not any(words) or words[0].startswith("#") or (number == 1 and tuple(words[:2]) == COLUMNS):
            continue
        try:
            x, y = (float(word) for word in words[:2])
        except ValueError:
            said = f"row {number}: two numbers {' and '.join(COLUMNS)} are wanted, not '{','.join(row)}'"
            raise PathError(f"{file}: {said}") from None
        yield x, y
