"""Registry of studies: those of every package that is installed and brings some."""

from collections.abc import Mapping
from importlib.metadata import entry_points
from typing import Final

from validation.studies.study import Study

GROUP: Final = "firmware_bridge.studies"
"""Entry points of this group are tuples of studies, by the robot's kind."""


def studies_by_robot() -> Mapping[str, tuple[Study, ...]]:
    """Return each robot's studies by its kind; LookupError where two have one name."""
    entries = sorted(entry_points(group=GROUP), key=lambda entry: entry.name)
    found: dict[str, tuple[Study, ...]] = {entry.name: entry.load() for entry in entries}
    names = [study.name for rows in found.values() for study in rows]
    twice = sorted({name for name in names if names.count(name) > 1 or name == "all"})
    if twice:
        raise LookupError(
            f"more than one study is called {', '.join(twice)}; rename it in the robot's studies"
        )
    return found


def studies() -> tuple[Study, ...]:
    """Return every study."""
    return tuple(study for rows in studies_by_robot().values() for study in rows)


def study_names() -> list[str]:
    """Return what `study` may be called with."""
    return [*(study.name for study in studies()), "all"]
