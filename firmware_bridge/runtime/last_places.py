"""Last positions of the axes, in a small file for the next run of the bridge: an offer, no certainty.

Motion in between is not in it. A file that is missing or damaged offers nothing.
"""

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from firmware_bridge.runtime.whole_file import WholeFile
from firmware_bridge.units import SECOND, Nanoseconds

EVERY: Final[Nanoseconds] = 2 * SECOND
"""It is written no more often, and only where something has changed."""
RECORDED: Final = "places.json"
"""In a run's folder: what was known when the bridge was started."""


def usual_path(robot: str) -> Path:
    """Return the path of a robot's file, unless the user gives another."""
    root = os.environ.get("XDG_STATE_HOME") or str(Path.home() / ".local" / "state")
    return Path(root) / "firmware-bridge" / f"{robot}.json"


def known_places(places: Mapping[str, float]) -> dict[str, str]:
    """Return what a recording keeps of them, by its file; `LastPlaces` reads it."""
    return {RECORDED: json.dumps(dict(places))} if places else {}


class LastPlaces:
    """One robot's file."""

    def __init__(self, path: Path) -> None:
        self.path: Final = path
        self.file: Final = WholeFile(path)
        self._written: Mapping[str, float] = {}
        self._due: Nanoseconds = 0

    def read(self) -> dict[str, float]:
        """Return what was kept, by axis; what is no finite number is left out."""
        try:
            table = json.loads(self.path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        found = table if isinstance(table, dict) else {}
        places = {str(axis): value for axis, value in found.items() if isinstance(value, float)}
        return {axis: value for axis, value in places.items() if math.isfinite(value)}

    def keep(self, places: Mapping[str, float], now: Nanoseconds) -> None:
        """Keep where the axes stand, where that is due."""
        if places and now >= self._due and places != self._written:
            self._due = now + EVERY
            self._written = dict(places)
            self.file.replace(json.dumps(self._written), now)
