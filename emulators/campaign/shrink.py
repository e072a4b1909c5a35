"""A failing run made smaller: fewer faults and steps, a plain link, a shorter time, and it still fails."""

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from emulators.bench.toml_text import as_toml
from emulators.campaign.campaign_file import Require
from emulators.campaign.plan import Run, texts_of
from emulators.campaign.results import ERROR
from emulators.campaign.worker import drive

MOST: Final = 40
"""Runs that one shrinking may take."""
PLAIN: Final = ("link", "noise", "max_delay_s", "plant")
Table = dict[str, Any]


def shrunk(run: Run, require: Sequence[Require], broken: Mapping[int, str]) -> Run:
    """Return a run with a smaller mission that breaks the first of the same requirements."""
    wanted = min(broken)
    left = MOST

    def still(table: Table) -> bool:
        nonlocal left
        left -= 1
        now = drive(_with(run, table), require).broken.get(wanted)
        # A smaller mission must end in the same error, not in one of its own.
        return now is not None and (wanted != ERROR or _kind(now) == _kind(broken[ERROR]))

    robot, mission = texts_of(run)
    run = replace(run, case=replace(run.case, robot_text=robot, faults=()), values={})
    table = tomllib.loads(mission)
    for smaller in (_without_faults, _plain, _without_steps, _shorter):
        changed = True
        while changed and left > 0:
            changed = False
            for candidate in smaller(table):
                if left <= 0:
                    break
                if still(candidate):
                    table, changed = candidate, True
                    break
    return _with(run, table)


def _kind(error: str) -> str:
    return error.partition(":")[0]


def _with(run: Run, table: Table) -> Run:
    return replace(run, case=replace(run.case, mission_text=as_toml(table)))


def _without_faults(table: Table) -> Iterator[Table]:
    faults = table.get("fault", [])
    for place in reversed(range(len(faults))):
        yield {**table, "fault": faults[:place] + faults[place + 1 :]}


def _plain(table: Table) -> Iterator[Table]:
    for key in PLAIN:
        if key in table:
            yield {name: value for name, value in table.items() if name != key}


def _without_steps(table: Table) -> Iterator[Table]:
    steps = table["step"]
    for place in reversed(range(1, len(steps))):
        yield {**table, "step": steps[:place] + steps[place + 1 :]}


def _shorter(table: Table) -> Iterator[Table]:
    last = max([row["at_s"] for row in (*table["step"], *table.get("fault", ()))])
    for share in (0.25, 0.5, 0.75):
        duration = round(last + share * (table["duration_s"] - last), 3)
        if last < duration < table["duration_s"] - 0.5:
            yield {**table, "duration_s": duration}
