"""Drive a campaign: what is left of it, on processes or on a cluster, and its results in one folder."""

import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

from emulators.bench.summary import Summary
from emulators.campaign.campaign_file import Require
from emulators.campaign.cluster import Cluster
from emulators.campaign.journal import NAME, Journal
from emulators.campaign.page import page, rerun
from emulators.campaign.plan import Plan, Run, order_of, texts_of
from emulators.campaign.results import ERROR, Row, as_csv, write_parquet
from emulators.campaign.search import Search, best, search
from emulators.campaign.shrink import shrunk
from emulators.campaign.spread import Processes, in_order
from emulators.campaign.worker import drive
from emulators.run import RunOrder
from emulators.run import drive as drive_recorded

KEPT: Final = 5
FAILURES: Final = "failures"
WORST: Final = "worst"
Progress = Callable[[Row], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Where a campaign runs, and what it leaves."""

    out: Path
    jobs: int = 1
    scheduler: str = ""
    """Of a Dask cluster, tcp://HOST:PORT; empty: processes of this machine."""
    keep: int = KEPT
    """Failing runs whose recording and smaller mission are kept."""
    parquet: bool = False
    fresh: bool = False
    """Drive all runs again."""


def campaign(plan: Plan, settings: Settings, progress: Progress = lambda _: None) -> list[Row]:
    """Drive what is left of a campaign; return all rows in the order of their runs.

    JournalError where the folder has another campaign's runs; SpreadError, ClusterError, ExtraMissingError;
    OSError where the folder cannot be written.
    """
    if settings.fresh:
        (settings.out / NAME).unlink(missing_ok=True)
        shutil.rmtree(settings.out / FAILURES, ignore_errors=True)
    with Journal(settings.out, plan) as journal, _workers(settings) as workers:
        left = [run for run in plan.runs if run.number not in journal.rows]
        work = partial(drive, require=plan.campaign.require)
        for row in journal.rows.values():
            progress(row)
        for _, row in workers.results(work, left):
            journal.add(row)
            progress(row)
        rows = [journal.rows[number] for number in sorted(journal.rows)]
    _leave(plan, rows, settings)
    return rows


def searched(
    plan: Plan, settings: Settings, wanted: Search, progress: Progress = lambda _: None
) -> list[Row]:
    """Look for the worst case of a campaign; return the rows that were driven, and leave their results.

    The robot file and the mission file of the worst are in `out`/worst. Raises as `campaign` does, and
    SearchError.
    """
    settings.out.mkdir(parents=True, exist_ok=True)
    work = partial(drive, require=plan.campaign.require)
    rows, runs = [], list[Run]()
    with _workers(settings) as workers:

        def driven(batch: Sequence[Run]) -> list[Row]:
            runs.extend(batch)
            return _by_place(workers.results(work, batch))

        for row in search(plan, wanted, driven):
            rows.append(row)
            progress(row)
    (settings.out / "results.csv").write_text(as_csv(rows), encoding="utf-8")
    if (worst := best(rows, wanted)) is not None:
        (settings.out / WORST).mkdir(exist_ok=True)
        _write_texts(runs[worst.run], settings.out / WORST)
    return rows


def drive_alone(plan: Plan, number: int, out: Path) -> Row:
    """Drive one run again with all of its results, in `out`/run-NUMBER; LookupError where there is none."""
    runs = {run.number: run for run in plan.runs}
    if number not in runs:
        raise LookupError(f"--only {number}: the campaign has the runs 0 to {len(runs) - 1}")
    run = runs[number]
    folder = out / f"run-{number:06d}"
    folder.mkdir(parents=True, exist_ok=True)
    _write_texts(run, folder)
    order = partial(order_of, folder=folder, again=rerun(plan, number, str(out)))
    return drive(run, plan.campaign.require, order, _recorded)


def _recorded(order: RunOrder) -> Summary:
    return drive_recorded(order, lambda _: None)


def _workers(settings: Settings) -> Processes | Cluster:
    return Cluster(settings.scheduler) if settings.scheduler else Processes(settings.jobs)


def _by_place(results: Iterator[tuple[int, Row]]) -> list[Row]:
    return [row for _, row in sorted(results, key=lambda result: result[0])]


def _leave(plan: Plan, rows: Sequence[Row], settings: Settings) -> None:
    (settings.out / "results.csv").write_text(as_csv(rows), encoding="utf-8")
    if settings.parquet:
        write_parquet(rows, settings.out / "results.parquet")
    failed = [row for row in rows if row.broken][: settings.keep]
    runs = {run.number: run for run in plan.runs}
    work = partial(_keep, plan.campaign.require, settings.out)
    list(in_order(work, [(runs[row.run], row) for row in failed], settings.jobs))
    text = page(plan, rows, str(settings.out), [row.run for row in failed])
    (settings.out / "report.html").write_text(text, encoding="utf-8")


def _keep(require: Sequence[Require], out: Path, failing: tuple[Run, Row]) -> None:
    """Leave a failing run's recording, its files, and a smaller mission that fails as it does."""
    run, row = failing
    folder = out / FAILURES / f"{run.number:06d}"
    if (folder / "smaller.toml").exists():
        return
    folder.mkdir(parents=True, exist_ok=True)
    _write_texts(run, folder)
    # A run that ended in an error may end before it leaves anything: its files are enough.
    if ERROR not in row.broken:
        _recorded(order_of(run, folder))
    smaller = shrunk(run, require, row.broken)
    over = f" on the protocol '{run.case.protocol}'" if run.case.protocol else ""
    line = f"firmware-bridge bench robot.toml --mission smaller.toml --seed {run.seed}"
    head = f"# {row.broken[min(row.broken)]}{over}\n# {line}\n"
    (folder / "smaller.toml").write_text(head + smaller.case.mission_text, encoding="utf-8")


def _write_texts(run: Run, folder: Path) -> None:
    robot, mission = texts_of(run)
    (folder / "robot.toml").write_text(robot, encoding="utf-8")
    (folder / "mission.toml").write_text(mission, encoding="utf-8")
