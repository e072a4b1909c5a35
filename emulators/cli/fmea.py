"""`fmea`: every failure in every state of a robot, at the command line."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from emulators.cli.options import CORES, JobsOption
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import FAILED, one_message, refusal, say, written_by
from firmware_bridge.cli.options import EncodersOption, FirmwareOption, RobotArgument

if TYPE_CHECKING:
    from emulators.fmea.matrix import Cell
    from firmware_bridge.robot import AnyRobot


EXAMPLES: Final = """Examples:

`firmware-bridge fmea rars --out out/fmea`

`firmware-bridge fmea rome --protocol mw --encoders 3 --fault encoder_cable_off --fault board_reset`

`firmware-bridge fmea climber --state stopping`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FmeaOptions:
    """Inject every fault in every state of a robot; report its detection, the time and the distance.

    In virtual time, on all processors: minutes. Ends with status 1 where the robot moves uncommanded, this is
    not noticed within half a second, and no reason is known. With `--out` it writes `fmea.csv` and
    `fmea.html`, the matrix on one page. The severity of each fault is in the page's titles.
    """

    robot: RobotArgument
    faults: Annotated[
        list[str] | None,
        typer.Option("--fault", metavar="KIND", help="Only this kind; may be repeated.", show_default="all"),
    ] = None
    states: Annotated[
        list[str] | None,
        typer.Option(
            "--state", metavar="STATE", help="Only this state; may be repeated.", show_default="all"
        ),
    ] = None
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="DIR", help="Folder of the matrix.", show_default="nowhere"),
    ] = None
    jobs: JobsOption = CORES
    serial: Annotated[
        str | None,
        typer.Option(
            "--serial",
            metavar="v1|v2",
            help="Over the first drive's serial port.",
            show_default="by the file",
        ),
    ] = None
    protocol: FirmwareOption = None
    encoders: EncodersOption = None


LINES: Final = 20
"""Number of cells printed at the terminal; the page has them all."""


def run(given: FmeaOptions) -> None:
    """Run the command `fmea`; an error ends the program with a message."""
    from emulators.bench.faults import kinds
    from emulators.campaign.spread import SpreadError
    from emulators.cli.beginning import report_beginning
    from emulators.fmea.matrix import all_failures, matrix, state_names
    from emulators.fmea.report import as_csv, as_page, wrongs
    from emulators.progress_bar import progress_bar
    from emulators.servo.bank import ServoError
    from emulators.testing.errors import RigError
    from firmware_bridge.drivers.link_drivers import PlanError
    from firmware_bridge.robot import RobotFileError
    from fmu.errors import PlantError

    # A function of plain values: it is sent to processes, where each makes its own robot.
    made = partial(_machine, given.robot, given.serial, given.protocol, given.encoders)
    with (
        one_message(RobotFileError, PlanError, PlantError, ServoError, LookupError, RigError, SpreadError),
        written_by("--out"),
    ):
        machine = made()
        report_beginning(machine, None)
        failures = all_failures(machine, _known("fault", given.faults or [], list(kinds())))
        states = state_names(machine)
        chosen = _known("state", given.states or [], states) or states
        if not failures:
            raise refusal(f"{machine.name} cannot have these faults")
        with progress_bar() as bar:
            task = bar.add_task(f"{machine.name}, {len(failures)} failures", total=len(chosen))
            cells = matrix(made, chosen, failures, given.jobs, lambda _: bar.advance(task))
        if given.out is not None:
            given.out.mkdir(parents=True, exist_ok=True)
            (given.out / "fmea.csv").write_text(as_csv(cells), encoding="utf-8")
            (given.out / "fmea.html").write_text(as_page(machine.name, cells), encoding="utf-8")
    _show(cells, len(failures))
    if given.out is not None:
        say(f"results: {given.out}/")
    wrong = list(wrongs(cells))
    if wrong:
        more = f"\nand {len(wrong) - LINES} more" if len(wrong) > LINES else ""
        raise refusal("\n".join(wrong[:LINES]) + more, FAILED)


def _machine(robot: str, serial: str | None, protocol: str | None, encoders: int | None) -> "AnyRobot":
    from emulators.cli.fitted import linked
    from firmware_bridge.cli.robot_argument import find_robot

    return linked(find_robot(robot), serial, protocol, encoders)


def _known(what: str, typed: Sequence[str], known: Sequence[str]) -> tuple[str, ...]:
    from firmware_bridge.robot.problems import near

    for one in typed:
        if one not in known:
            raise refusal(f"no such {what} as '{one}'; {near(one, list(known), most=len(known))}")
    return tuple(typed)


def _show(cells: "Sequence[Cell]", failures: int) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from emulators.fmea.effect import Assessment
    from emulators.fmea.report import WORST, worst
    from firmware_bridge.cli.tables import print_lines, terminal

    verdicts = [it for it in Assessment if any(cell.effect.verdict is it for cell in cells)]
    table = Table(box=SIMPLE_HEAD, title=f"{failures} failures")
    table.add_column("state")
    for verdict in verdicts:
        table.add_column(verdict, justify="right")
    counted: dict[str, Counter[Assessment]] = {}
    for cell in cells:
        counted.setdefault(cell.state, Counter())[cell.effect.verdict] += 1
    for state, of in counted.items():
        table.add_row(state, *(str(of[it]) for it in verdicts))
    terminal().print(table)
    say("the worst, by their deviation from the run without the failure:")
    print_lines((WORST, *worst(cells)))
    say("")
    excused = Counter(
        cell.why
        for cell in cells
        if cell.why and cell.effect.verdict in {Assessment.NOT_NOTICED, Assessment.LATE}
    )
    for why, count in excused.items():
        say(f"  {count}: {why}")


fmea: Final = command(EXAMPLES, work=run)(FmeaOptions)
