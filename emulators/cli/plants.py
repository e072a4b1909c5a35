"""The plants' commands: `fmu list`, `fmu show`, `fmu build`, `fmu check`."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, TypeAlias

import typer

from firmware_bridge import robot_types
from firmware_bridge.cli.commands import command, completing
from firmware_bridge.cli.console import FAILED, one_message, say
from firmware_bridge.cli.robot_argument import find_robot
from firmware_bridge.robot import RobotFileError

if TYPE_CHECKING:
    from firmware_bridge.robot import AnyRobot
    from fmu.check import Findings


Shown: TypeAlias = tuple[str, list[Sequence[str]], dict[str, list[str]]]
"""A title, a row for each parameter, and other names by their kind."""
LIST_EXAMPLE: Final = "Example: `firmware-bridge fmu list`"
SHOW_EXAMPLES: Final = """Examples:

`firmware-bridge fmu show single_axis` lists what `--set NAME=VALUE` may name.

`firmware-bridge fmu show rome` has the values of the robot's file.

`firmware-bridge fmu show my.fmu` lists what any FMU has."""
BUILD_EXAMPLES: Final = """Examples:

`firmware-bridge fmu build rars`

`firmware-bridge fmu build rars --fmi 2 --out results/rars2.fmu`

`firmware-bridge fmu build rome` builds the plant of the robot ROME, which begins with its file's values."""
CHECK_EXAMPLE: Final = "Example: `firmware-bridge fmu check my_plant.fmu`"


@command(LIST_EXAMPLE)
def list_models() -> None:
    """List the models that can be built."""
    from rich.table import Table

    from firmware_bridge.cli.tables import terminal
    from fmu.errors import PlantError
    from fmu.plants import names
    from fmu.summary import summary

    table = Table(title="plants")
    for heading in ("model", "what it is", "states", "inputs", "outputs", "parameters", "robots"):
        table.add_column(heading, overflow="fold")
    robots = robot_types.readable()
    failed = False
    for name in names():
        try:
            found = summary(name)
        except PlantError as error:
            # A third party's mistake hides no other plant.
            table.add_row(name, str(error), *["-"] * 5)
            failed = True
        else:
            used = ", ".join(robot.name for robot in robots if robot.plant.fmu == name) or "none"
            counts = (found.states, found.inputs, found.outputs, found.parameters)
            table.add_row(name, found.description, *map(str, counts), used)
    terminal().print(table)
    if failed:
        raise typer.Exit(FAILED)
    say("each as FMI 2.0 or 3.0, with co-simulation and model exchange in one file")


@command(SHOW_EXAMPLES)
def show(
    model: Annotated[
        str,
        typer.Argument(
            metavar="MODEL|ROBOT|FMU",
            help="A model that `fmu list` shows, a robot, or an FMU of any tool.",
            autocompletion=completing("fmu.plants:names"),
        ),
    ],
) -> None:
    """List a plant's parameters: name, unit, default, meaning; and its inputs and outputs."""
    from rich.table import Table

    from firmware_bridge.cli.tables import terminal
    from fmu.errors import PlantError

    with one_message(PlantError, RobotFileError):
        title, rows, variables = _file_shown(Path(model)) if model.endswith(".fmu") else _model_shown(model)
    table = Table(title=title)
    for heading in ("parameter", "unit", "default", "meaning"):
        table.add_column(heading, overflow="fold")
    for row in rows:
        table.add_row(*row)
    terminal().print(table)
    for kind, names in variables.items():
        say(f"{kind}: {', '.join(names) or 'none'}")


def _model_shown(name: str) -> Shown:
    """Return what a model, or a robot's, has; PlantError, RobotFileError."""
    from emulators.robot_plant import plant_of
    from fmu.plants import find

    robot = robot_types.find(name) if name.partition(robot_types.SIGN)[0] in robot_types.names() else None
    plant = find(name) if robot is None else plant_of(robot)
    model = plant.model()
    rows: list[Sequence[str]] = [
        (it.name, it.unit, f"{it.start:g}", f"{it.description} ({it.source})") for it in plant.parameters
    ]
    inputs, outputs = [it.name for it in model.inputs], [it.name for it in model.outputs]
    sets = [key for key, values in plant.sets.items() if values]
    title = plant.name if robot is None else f"{plant.name} as {robot.name} has it"
    return title, rows, {"inputs": inputs, "outputs": outputs, "parameter sets": sets}


def _file_shown(path: Path) -> Shown:
    """Return the same of an FMU; PlantError."""
    from fmu.plant import variables_of

    found = variables_of(path)
    rows: list[Sequence[str]] = [
        (it.name, it.unit or "", it.start, it.description) for it in found if it.causality == "parameter"
    ]
    others = {f"{kind}s": [it.name for it in found if it.causality == kind] for kind in ("input", "output")}
    return path.name, rows, others


@command(BUILD_EXAMPLES)
def build_model(
    model: Annotated[
        str,
        typer.Argument(
            metavar="MODEL|ROBOT",
            help="A robot: its plant, with the values of its file. Or a model that `fmu list` shows.",
            autocompletion=completing("fmu.plants:names"),
        ),
    ],
    *,
    fmi: Annotated[int, typer.Option("--fmi", min=2, max=3, help="FMI version: 2 or 3.")] = 3,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="FILE", help="Output file.", show_default="MODEL.fmu"),
    ] = None,
) -> None:
    """Build a robot's plant, or a model, as an FMU, with its sources inside.

    It holds a binary for this machine, and for Linux and Windows on x86-64 and Linux on ARM where their
    compilers are.
    """
    from emulators.robot_plant import plant_of
    from fmu.build import place
    from fmu.errors import PlantError
    from fmu.plants import find
    from fmu.platforms import here, reachable

    target = out or Path(f"{model}.fmu")
    # Cross compilers are optional: an FMU without their binaries still has its sources.
    others, missing = reachable()
    with one_message(PlantError, OSError, RobotFileError):
        robot = (
            robot_types.find(model) if model.partition(robot_types.SIGN)[0] in robot_types.names() else None
        )
        plant = find(model) if robot is None else plant_of(robot)
        place(plant, fmi, target, others)
        size = target.stat().st_size
    shown = plant.name if robot is None else f"{plant.name} as {robot.name} has it"
    say(f"{target}: {shown}, FMI {fmi}.0, co-simulation and model exchange, {size // 1024} KiB")
    say(f"binaries: {', '.join(one.name for one in (here(), *others))}")
    for one in missing:
        lacks = f"no {one.compiler} here (Debian's {one.package})"
        say(f"no binary for {one.name}: {lacks}; its sources build there")


@command(CHECK_EXAMPLE)
def check(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="An FMU of any tool.")],
    robot: Annotated[
        str | None,
        typer.Option("--robot", help="Robot whose bench it has to fit.", show_default=False),
    ] = None,
) -> None:
    """Check an FMU: validity, start, bit-exact results, and the robots that it fits.

    Exit status 0: it is, and fits the robot that was named; 1: it has problems; 2: it cannot be read.
    """
    from fmu.check import examine
    from fmu.errors import PlantError
    from fmu.verify import ComparisonResult

    bits = {
        ComparisonResult.SAME: "those that its equations give, in a run of its own",
        ComparisonResult.OTHER: "others than its equations give",
        ComparisonResult.NONE: "not compared: the FMU carries no fingerprint of ours that fits its variables",
    }
    named = [] if robot is None else [find_robot(robot)]
    with one_message(PlantError):
        found = examine(file)
    lacking = {one.name: _lacking(one, found) for one in named or robot_types.readable()}
    fits = [name for name, reasons in lacking.items() if not reasons]
    problems = [*found.problems, *(reason for one in named for reason in lacking[one.name])]
    rows = {
        "verdict": _verdict(problems, fits),
        "model": f"{found.model}, {found.variables} variables, FMI {found.version}, "
        f"{' and '.join(found.interfaces) or 'no interface'}",
        "checked": f"description: {_count_of(len(found.description), 'valid')}; start: "
        f"{'fails' if found.start else 'loads, initializes, takes a step'}",
        "bits": bits[found.fingerprint],
    }
    if not named and len(fits) < len(lacking):
        rows["other robots"] = _lacks(lacking)
    for name, value in rows.items():
        say(f"{name + ':':<14}{value}")
    # Each once: a robot may lack what the description already reports.
    for problem in dict.fromkeys(problems):
        say(f"problem: {problem}", err=True)
    if problems:
        raise typer.Exit(FAILED)


def _lacking(robot: "AnyRobot", found: "Findings") -> tuple[str, ...]:
    from emulators.bench.bench_setup import bench_setup_of
    from emulators.devices import needs_of

    needs = needs_of(robot)
    drawn = [column.plant for column in bench_setup_of(robot).columns if column.plant]
    outputs = dict.fromkeys((*(name for one in needs for name in one.outputs), *drawn))
    inputs = tuple(name for one in needs for name in one.inputs)
    units = {name: unit for one in needs for name, unit in one.units.items()}
    reasons = found.lacking(inputs, tuple(outputs), units)
    if "co-simulation" not in found.interfaces:
        return (*reasons, "it offers no co-simulation; export it with its solver")
    return reasons


def _verdict(problems: list[str], fits: list[str]) -> str:
    """Return the whole in one line: what is wrong, or which robots it fits."""
    if problems:
        return _count_of(len(problems), "")
    return f"good; it fits {', '.join(fits)}" if fits else "good; it fits the bench of no installed robot"


def _lacks(lacking: Mapping[str, tuple[str, ...]]) -> str:
    """Return how much each robot lacks that it does not fit, in one line."""
    counted = ", ".join(f"{name} lacks {len(reasons)}" for name, reasons in lacking.items() if reasons)
    return f"{counted}; --robot NAME lists it"


def _count_of(count: int, good: str) -> str:
    return good if not count else "1 problem" if count == 1 else f"{count} problems"
