"""A path of one's own from a table of points: `t, x, y`, `t, x, y, psi`, or `x, y` with a speed.

s, m, m, rad; between two points the robot goes straight. A first line may name the columns. Mistakes are
reported with file and row.
"""

import csv
import math
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Final, TypeAlias

from pydantic import BaseModel, ValidationError

from firmware_bridge.robot.model import AnyRobot
from firmware_bridge.robot.problems import FileError, Problem

COLUMNS: Final = (("x", "y"), ("t", "x", "y"), ("t", "x", "y", "psi"))
LEAST: Final = 2
"""Points of a path."""
Point: TypeAlias = tuple[float, float, float, float]
"""s, m, m, rad."""


class PathFileError(FileError):
    """A file of points that cannot be used."""


def path_of(file: Path, speed: float | None = None) -> tuple[Point, ...]:
    """Return a file's points; `speed` in m/s is for points without a time. PathFileError."""
    return points_of(_read(file), str(file), speed)


def places_of(file: Path) -> tuple[tuple[float, float], ...]:
    """Return the positions of a file's points, without its other columns; m. PathFileError."""
    columns, rows = _rows(_read(file), str(file))
    x, y = columns.index("x"), columns.index("y")
    return tuple((row[x], row[y]) for _, row in rows)


def points_of(text: str, file: str, speed: float | None = None) -> tuple[Point, ...]:
    """Return the points of a text; `file` names it in a PathFileError."""
    columns, numbers = _rows(text, file)
    if "t" not in columns:
        return _timed(numbers, speed, file)
    if speed is not None:
        raise PathFileError(file, Problem("", "its points have times: a speed is for points without"))
    for (_, before), (where, after) in pairwise(numbers):
        if after[0] <= before[0]:
            raise PathFileError(file, Problem(where, f"t = {after[0]:g} is not later than {before[0]:g}"))
    return tuple((row[0], row[1], row[2], row[3] if "psi" in columns else 0.0) for _, row in numbers)


def sampled(place: Callable[[float], Sequence[float]], seconds: float, every: float) -> tuple[Point, ...]:
    """Return the points of a function of time, which gives x, y and psi, from 0 on."""
    # The last point is the end itself, whatever is left of the last step.
    times = [min(count * every, seconds) for count in range(math.ceil(seconds / every) + 1)]
    return tuple((time, *(float(it) for it in place(time))) for time in times)  # type: ignore[misc] # three


def with_path(robot: AnyRobot, points: Iterable[Point], file: str) -> AnyRobot:
    """Return the robot whose path follower `points` takes these; PathFileError without one, or too slow."""
    geometry = robot.geometry
    paths = getattr(geometry, "paths", None)
    if not isinstance(paths, BaseModel) or "points" not in type(paths).model_fields:
        raise PathFileError(
            file, Problem("", f"{robot.name} has no path follower that takes a path by points")
        )
    table = {**paths.model_dump(), "points": tuple(points)}
    try:
        changed = type(geometry).model_validate({**geometry.model_dump(), "paths": table})
    except ValidationError as error:
        problems = (one["msg"].removeprefix("Value error, ") for one in error.errors())
        raise PathFileError(file, *(Problem("", problem) for problem in problems)) from error
    return robot.model_copy(update={"geometry": changed})


def along_path(robot: AnyRobot, file: Path | None, speed: float | None) -> tuple[AnyRobot, tuple[Point, ...]]:
    """Return the robot with a file's path, and its points; as it is, and none, without a file."""
    if file is None:
        if speed is not None:
            raise PathFileError("--path-speed", Problem("", "no --path is given"))
        return robot, ()
    points = path_of(file, speed)
    return with_path(robot, points, str(file)), points


def _read(file: Path) -> str:
    try:
        # Spreadsheets put a byte order mark before the first cell.
        return file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise PathFileError(str(file), Problem("", f"cannot be read: {error}")) from error


def _rows(text: str, file: str) -> tuple[tuple[str, ...], list[tuple[str, tuple[float, ...]]]]:
    """Return the columns, and each row's name and numbers."""
    lines = enumerate(csv.reader(text.splitlines(), skipinitialspace=True), start=1)
    rows = [(f"row {place}", [cell.strip() for cell in cells]) for place, cells in lines if _counts(cells)]
    columns, rows = _columns(rows, file)
    numbers = [(where, _numbers(cells, columns, where, file)) for where, cells in rows]
    if len(numbers) < LEAST:
        raise PathFileError(file, Problem("", f"{len(numbers)} points make no path; at least {LEAST} do"))
    return columns, numbers


def _counts(cells: list[str]) -> bool:
    """Return whether a line is neither empty nor a comment."""
    return any(cell.strip() for cell in cells) and not cells[0].lstrip().startswith("#")


def _columns(
    rows: list[tuple[str, list[str]]], file: str
) -> tuple[tuple[str, ...], list[tuple[str, list[str]]]]:
    """Return the columns, and the rows behind the one that names them."""
    if not rows:
        raise PathFileError(file, Problem("", "there is no point in it"))
    where, first = rows[0]
    known = "; ".join(", ".join(columns) for columns in COLUMNS)
    # 'nan' and 'inf' count as names here, and are refused as such.
    if any(cell.isalpha() for cell in first):
        if tuple(first) not in COLUMNS:
            raise PathFileError(file, Problem(where, f"the columns are '{', '.join(first)}'; give {known}"))
        return tuple(first), rows[1:]
    columns = next((it for it in COLUMNS if len(it) == len(first)), None)
    if columns is None:
        raise PathFileError(file, Problem(where, f"{len(first)} columns; give {known}"))
    return columns, rows


def _numbers(cells: list[str], columns: tuple[str, ...], where: str, file: str) -> tuple[float, ...]:
    if len(cells) != len(columns):
        raise PathFileError(file, Problem(where, f"{len(cells)} columns, expected {', '.join(columns)}"))
    found = []
    for name, cell in zip(columns, cells, strict=True):
        try:
            number = float(cell)
        except ValueError:
            number = math.nan
        # float() reads 'nan' and 'inf', and neither is a place.
        if not math.isfinite(number):
            raise PathFileError(file, Problem(where, f"{name} = '{cell}' is no finite number"))
        found.append(number)
    return tuple(found)


def _timed(rows: list[tuple[str, tuple[float, ...]]], speed: float | None, file: str) -> tuple[Point, ...]:
    """Give points their times at a steady speed."""
    if speed is None:
        problem = "its points have no times: use --path-speed M/S, or add a column t"
        raise PathFileError(file, Problem("", problem))
    time, (_, (x, y)) = 0.0, rows[0]
    points: list[Point] = [(time, x, y, 0.0)]
    for where, (new_x, new_y) in rows[1:]:
        if (new_x, new_y) == (x, y):
            raise PathFileError(file, Problem(where, "the same point again: without a time it takes none"))
        time, x, y = time + math.hypot(new_x - x, new_y - y) / speed, new_x, new_y
        points.append((time, x, y, 0.0))
    return tuple(points)
