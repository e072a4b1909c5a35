"""A path to be followed from a file of points, as `firmware_bridge.robot.path_file` reads them."""

from pathlib import Path as FilePath

from firmware_bridge.pilot.paths import Path, PathError
from firmware_bridge.robot.path_file import PathFileError, places_of


def load(file: FilePath) -> Path:
    """Read a path; one that ends where it begins is closed. PathError names file and row."""
    try:
        points = places_of(file)
    except PathFileError as error:
        raise PathError(str(error)) from error
    closed = len(points) > 2 and points[0] == points[-1]  # noqa: PLR2004 - there and back is no ring
    try:
        return Path(points[:-1] if closed else points, closed=closed)
    except PathError as error:
        raise PathError(f"{file}: {error}") from None
