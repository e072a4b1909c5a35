"""A short mission and campaigns of it: a run takes a fifth of a second."""

from pathlib import Path
from typing import Any, Final

from emulators.bench.toml_text import as_toml

MISSION: Final[dict[str, Any]] = {
    "title": "three seconds ahead",
    "duration_s": 6.0,
    "step": [
        {"at_s": 0.0, "title": "confirm", "zero": {"steering": 0.0, "lift": 0.0}},
        {"at_s": 1.5, "title": "arm", "arm": True},
        {"at_s": 2.0, "title": "ahead", "speed_mps": 0.2, "ramp_mps2": 0.2},
        {"at_s": 4.0, "title": "stop", "speed_mps": 0.0},
    ],
    "noise": {"stick": 0.02},
}

CAMPAIGN: Final[dict[str, Any]] = {
    "title": "floors and loads",
    "robots": ["rars"],
    "missions": ["short.toml"],
    "seeds": 2,
    "parameter": [
        {"path": "plant.floor_friction", "values": [0.2, 0.6]},
        {"path": "link.delay", "least": 0.0, "most": 0.4, "steps": 3},
    ],
    "require": [{"key": "path_length_m", "least": 0.1}],
}
"""Twelve runs."""


def written(folder: Path, **changed: Any) -> Path:
    """Write the mission and the campaign, with some keys changed; return the campaign's file."""
    (folder / "short.toml").write_text(as_toml(MISSION), encoding="utf-8")
    table = {key: value for key, value in (CAMPAIGN | changed).items() if value is not None}
    (folder / "floors.toml").write_text(as_toml(table), encoding="utf-8")
    return folder / "floors.toml"
