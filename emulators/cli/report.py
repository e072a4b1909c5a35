"""`report`: the page and the pictures of a recorded drive, at the command line."""

import shlex
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import one_message, refusal, say, written_by
from firmware_bridge.units import to_seconds

if TYPE_CHECKING:
    from firmware_bridge.runtime.run_file import AsRun

EXAMPLES: Final = """Examples:

`firmware-bridge report recordings/2026-11-26T10-00-00Z` makes the page of a drive that `drive --record` has
recorded.

`firmware-bridge report recordings/2026-11-26T10-00-00Z --animate` makes a page with a slider, too, which
plays the path.

`firmware-bridge report run.mcap` makes the page of a recording in MCAP, in the folder run."""

SOON_S: Final = 1.0
"""Limit in s below which a difference has been there from the beginning."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportOptions:
    """Make the page, the plots and the table of a recorded run, as `bench` makes them.

    Writes `report.html`, `samples.csv` and plots to the folder: the devices' measurements and the bridge's
    state, every 10 ms, in place of a plant's values. The recording is replayed into the bridge.

    Exit status 0 where all was written; 2 for a recording that cannot be used.
    """

    folder: Annotated[
        Path,
        typer.Argument(
            metavar="FOLDER|FILE.mcap",
            help="The folder of a run, as `drive --record` and `bench` leave it, or its recording in MCAP.",
            show_default=False,
        ),
    ]
    robot: Annotated[
        str | None,
        typer.Argument(
            metavar="[ROBOT]",
            help="A name from `robots`, or a robot file (.toml).",
            show_default="the robot as it was driven, from run.json in the recording",
        ),
    ] = None
    animate: Annotated[
        bool, typer.Option("--animate", help="Make animated.html, too, which plays the path with a slider.")
    ] = False
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="DIR",
            help="Folder of the output.",
            show_default="FOLDER; of a file the folder of its name, without .mcap",
        ),
    ] = None


def run(given: ReportOptions) -> None:
    """Run the command `report`; an error ends the program with a message."""
    from emulators.replay import RecordingFileError
    from emulators.replay.unpacked import unpacked
    from firmware_bridge.extras import installed, remedy_of
    from firmware_bridge.mcap_file.channels import SUFFIX
    from firmware_bridge.robot import RobotFileError

    named = given.folder
    in_file = named.suffix.lower() == SUFFIX and named.is_file()
    out = given.out or (named.with_suffix("") if in_file else named)
    if not in_file and not named.is_dir():
        raise refusal(
            f"{named}: is no folder, and no file in MCAP; name that of a run, as `drive --record` leaves it"
        )
    if given.out is None and (out / "summary.json").exists():
        raise refusal(f"{out}: `bench` has made its page already; use --out DIR for one without its plant")
    if not installed("plots"):
        say(f"no pictures this time: {remedy_of('plots')}", err=True)
    with one_message(RobotFileError, RecordingFileError, LookupError), written_by("--out"):
        if not in_file:
            _report(given, named, out)
            return
        with unpacked(named, lambda text: say(f"{named}: {text}")) as folder:
            _report(given, folder, out)


def _report(given: ReportOptions, folder: Path, out: Path) -> None:
    """Make the page of the recording in a folder."""
    from emulators.bench.bench_setup import bench_setup_of
    from emulators.progress_bar import progress_bar
    from emulators.replay import Into, ReplayOrder
    from emulators.replay.files import named
    from emulators.replay.measured import measured
    from emulators.replay.recordings import cut_off
    from emulators.replay.report import written

    machine, confirmed, mode = _as_run(given, folder)
    bench_setup = bench_setup_of(machine)
    order = ReplayOrder(machine, folder, into=Into.BRIDGE, confirmed=confirmed, mode=mode)
    with progress_bar() as bar:
        task = bar.add_task(given.folder.name, total=None)
        numbers = measured(
            order, bench_setup.columns, lambda now, end: bar.update(task, completed=now, total=end)
        )
    out.mkdir(parents=True, exist_ok=True)
    title, again = (
        f"{machine.name}, {given.folder.resolve().name}",
        shlex.join(("firmware-bridge", *sys.argv[1:])),
    )
    made = written(out, title, machine, bench_setup, numbers, again=again, animate=given.animate)
    for text in filter(None, map(cut_off, named(order))):
        say(text)
    if numbers.difference:
        since = to_seconds(numbers.differs_at or 0)
        why = "; was it another robot, or driven otherwise?" if since < SOON_S else ""
        say(f"this bridge does otherwise than was recorded from {since:.3f} s on{why}")
    say(f"{made[0]}: {len(numbers.samples)} rows, {len(made) - 2} pictures and pages beside it")


def _as_run(given: ReportOptions, folder: Path) -> "AsRun":
    from firmware_bridge.cli.robot_argument import find_robot
    from firmware_bridge.runtime.run_file import RUN_FILE, AsRun, read_run

    if given.robot is not None:
        return AsRun(find_robot(given.robot))
    found = read_run(folder)
    if found is None:
        raise refusal(f"{given.folder}: has no {RUN_FILE}, which names the robot; name the robot behind it")
    return found


report: Final = command(EXAMPLES, work=run)(ReportOptions)
