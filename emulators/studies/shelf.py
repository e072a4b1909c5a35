"""Which studies there are: those of every installed robot, found by its rehearsal."""

import importlib
from collections.abc import Mapping

from emulators.bench.rehearsal import rehearsals
from emulators.studies.study import Study


def studies_by_robot() -> Mapping[str, tuple[Study, ...]]:
    """Return each robot's studies by its kind; LookupError where two have one name."""
    found = {
        kind: tuple(importlib.import_module(rehearsal.studies).STUDIES)
        for kind, rehearsal in rehearsals().items()
        if rehearsal.studies
    }
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
