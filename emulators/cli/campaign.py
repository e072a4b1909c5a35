"""`campaign`: many runs of missions, at the command line."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from emulators.cli.options import CORES, JobsOption
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import FAILED, one_message, refusal, say, written_by

if TYPE_CHECKING:
    from collections.abc import Sequence

    from emulators.campaign.engine import Settings
    from emulators.campaign.plan import Plan
    from emulators.campaign.results import Row

EXAMPLES: Final = """Examples:

`firmware-bridge campaign floors.toml --out out/floors`

`firmware-bridge campaign floors.toml --only 17 --out out/floors` drives one run again, with all its results.

`firmware-bridge campaign floors.toml --scheduler tcp://192.168.1.5:8786` drives on a Dask cluster.

`firmware-bridge campaign floors.toml --search max_cross_track_m --runs 100` looks for the worst case."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignOptions:
    """Drive missions x robots x protocols x faults x seeds x parameters, on all cores.

    Leaves `results.csv` (a line for each run), `report.html`, and for failing runs the recording and a
    smaller mission that fails as well. A campaign that was interrupted goes on where it was. The results are
    the same for any number of processes.

    Exit status 1 where a run fails a requirement or ends in an error; 2 for a wrong file or option.
    """

    file: Annotated[Path, typer.Argument(metavar="FILE", help="The campaign's file (.toml).")]
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="DIR", help="Folder of the results.", show_default="out/FILE"),
    ] = None
    jobs: JobsOption = CORES
    scheduler: Annotated[
        str, typer.Option(metavar="tcp://HOST:PORT", help="Drive on the workers of this Dask scheduler.")
    ] = ""
    only: Annotated[
        int | None,
        typer.Option(min=0, metavar="RUN", help="Drive this run alone again, with all of its results."),
    ] = None
    keep: Annotated[
        int, typer.Option(min=0, help="Number of failing runs whose recording and smaller mission are kept.")
    ] = 5
    parquet: Annotated[bool, typer.Option("--parquet", help="Leave results.parquet, too.")] = False
    fresh: Annotated[bool, typer.Option("--fresh", help="Drive every run again.")] = False
    search: Annotated[
        str | None,
        typer.Option(metavar="KEY", help="Look for the largest value of this number of the summary."),
    ] = None
    smallest: Annotated[bool, typer.Option("--smallest", help="Look for the smallest instead.")] = False
    runs: Annotated[int, typer.Option(min=1, help="Number of runs of a search.")] = 60
    search_seed: Annotated[int, typer.Option(min=0, help="Seed of a search.")] = 0


LINES: Final = 20
"""Failing runs that are printed; the page and results.csv have them all."""


def run(given: CampaignOptions) -> None:
    """Run the command `campaign`; an error ends the program with a message."""
    from emulators.campaign.campaign_file import CampaignError, load
    from emulators.campaign.cluster import ClusterError
    from emulators.campaign.engine import Settings, drive_alone
    from emulators.campaign.journal import JournalError
    from emulators.campaign.plan import plan
    from emulators.campaign.search import SearchError
    from emulators.campaign.spread import SpreadError
    from fmu.errors import PlantError

    out = given.out or Path("out") / given.file.stem
    with (
        one_message(
            CampaignError, JournalError, ClusterError, SpreadError, SearchError, PlantError, LookupError
        ),
        written_by("--out"),
    ):
        made = plan(load(given.file), str(given.file), given.file.parent)
        settings = Settings(
            out=out,
            jobs=given.jobs,
            scheduler=given.scheduler,
            keep=given.keep,
            parquet=given.parquet,
            fresh=given.fresh,
        )
        if given.only is not None:
            rows = [drive_alone(made, given.only, out)]
            out /= f"run-{given.only:06d}"
        elif given.search is not None:
            rows = _searched(made, settings, given)
        else:
            rows = _driven(made, settings)
    say(f"results: {out}/")
    _show(rows)


def _driven(plan: "Plan", settings: "Settings") -> "list[Row]":
    from emulators.campaign.engine import campaign
    from emulators.progress_bar import counting_bar

    try:
        with counting_bar() as bar:
            task = bar.add_task(f"{len(plan.runs)} runs", total=len(plan.runs))
            return campaign(plan, settings, lambda _: bar.advance(task))
    except KeyboardInterrupt:
        say(f"interrupted; what was driven is in {settings.out}/, and the same line goes on there", err=True)
        raise


def _searched(plan: "Plan", settings: "Settings", given: CampaignOptions) -> "list[Row]":
    from emulators.campaign.engine import WORST, searched
    from emulators.campaign.search import Search, best
    from emulators.progress_bar import counting_bar

    wanted = Search(
        key=given.search or "", largest=not given.smallest, runs=given.runs, seed=given.search_seed
    )
    with counting_bar() as bar:
        task = bar.add_task(f"search of {wanted.key}", total=wanted.runs)
        rows = searched(plan, settings, wanted, lambda _: bar.advance(task))
    worst = best(rows, wanted)
    if worst is None:
        raise refusal(
            f"--search {wanted.key}: no run has such a number; results.csv has those that there are", FAILED
        )
    values = ", ".join(
        f"{name} = {value}" for name, value in worst.key.items() if name != "run" and value != ""
    )
    most = "largest" if wanted.largest else "smallest"
    say(f"{most} {wanted.key}: {worst.figures[wanted.key]}, run {worst.run}")
    say(f"  {values}")
    folder, seed = settings.out / WORST, worst.key["seed"]
    over = f", over the protocol {worst.key['protocol']}" if worst.key["protocol"] else ""
    line = f"firmware-bridge bench {folder}/robot.toml --mission {folder}/mission.toml --seed {seed}"
    say(f"  again{over}: {line}")
    return rows


def _show(rows: "Sequence[Row]") -> None:
    failed = [row for row in rows if row.broken]
    say(f"{len(rows)} runs, {len(failed)} failed")
    if not failed:
        return
    lines = [f"run {row.run}: {'; '.join(row.broken.values())}" for row in failed[:LINES]]
    more = f"\nand {len(failed) - LINES} more" if len(failed) > LINES else ""
    raise refusal("\n".join(lines) + more, FAILED)


campaign: Final = command(EXAMPLES, work=run)(CampaignOptions)
