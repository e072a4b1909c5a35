"""The plants' commands, which join the bridge's program: `fmu list`, `fmu build`, `fmu check`."""

from pathlib import Path
from typing import Annotated, Final

import typer
from rich.table import Table

from emulators.devices import BODY
from emulators.servo.bank import plant_inputs, plant_outputs
from firmware_bridge.cli.console import FAILED, one_message, terminal
from firmware_bridge.robot import Robot, load, shipped
from fmu.build import build
from fmu.check import Findings, examine
from fmu.errors import PlantError
from fmu.interface import units
from fmu.plants import find, names
from fmu.verify import Verdict

BITS: Final = {
    Verdict.SAME: "those that its equations give, in a run of its own",
    Verdict.OTHER: "others than its equations give",
    Verdict.NONE: "not compared: the FMU carries no fingerprint of ours",
}
LIST_EXAMPLE: Final = "Example: `firmware-bridge fmu list`"
BUILD_EXAMPLES: Final = """Examples:

`firmware-bridge fmu build rars`

`firmware-bridge fmu build rars --fmi 2 --out results/rars2.fmu`"""
CHECK_EXAMPLE: Final = "Example: `firmware-bridge fmu check my_plant.fmu`"

plants = typer.Typer(help="List, build and check plants: models of robots as FMUs.", no_args_is_help=True)


def attach(program: typer.Typer) -> None:
    """Add the commands to the program."""
    program.add_typer(plants, name="fmu", epilog="Example: `firmware-bridge fmu check my_plant.fmu`")


@plants.command("list", epilog=LIST_EXAMPLE)
def list_models() -> None:
    """List the plants that can be built, ours and those of other installed packages."""
    table = Table(title="plants")
    for heading in ("model", "what it is", "states", "inputs", "outputs", "parameters", "robots"):
        table.add_column(heading, overflow="fold")
    robots = [load(path) for path in shipped()]
    failed = False
    for name in names():
        try:
            model = find(name).model()
        except PlantError as error:
            # A stranger's mistake hides no other plant.
            table.add_row(name, str(error), *["-"] * 5)
            failed = True
        else:
            outputs = sum(not row.local for row in model.outputs)
            used = ", ".join(robot.name for robot in robots if robot.plant.fmu == name) or "none"
            counts = (len(model.states), len(model.inputs), outputs, len(model.parameters))
            table.add_row(name, model.description, *map(str, counts), used)
    terminal().print(table)
    if failed:
        raise typer.Exit(FAILED)
    typer.echo("each as FMI 2.0 or 3.0, with co-simulation and model exchange in one file")


@plants.command("build", epilog=BUILD_EXAMPLES)
def build_model(
    model: Annotated[str, typer.Argument(metavar="MODEL", help="A plant that `fmu list` shows.")],
    *,
    fmi: Annotated[int, typer.Option("--fmi", min=2, max=3, help="The version of FMI: 2 or 3.")] = 3,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="FILE", help="Where it goes.", show_default="MODEL.fmu"),
    ] = None,
) -> None:
    """Build a model's FMU, with its sources inside."""
    target = out or Path(f"{model}.fmu")
    with one_message(PlantError, OSError):
        build(model, fmi, target)
        size = target.stat().st_size
    typer.echo(f"{target}: {model}, FMI {fmi}.0, co-simulation and model exchange, {size // 1024} KiB")


@plants.command("check", epilog=CHECK_EXAMPLE)
def check(file: Annotated[Path, typer.Argument(metavar="FILE", help="An FMU, whoever made it.")]) -> None:
    """Check whether an FMU is valid, starts, computes the right bits, and fits a robot on the bench.

    Exit status 0: it does; 1: it has problems; 2: it cannot be read.
    """
    with one_message(PlantError):
        found = examine(file)
    lacking = {robot.name: _lacking(robot, found) for robot in (load(path) for path in shipped())}
    fits = [name for name, reasons in lacking.items() if not reasons]
    # A model of ours may be made for something else than the bench of a robot.
    needed = not fits and found.model not in names()
    problems = [*found.problems, *(reason for reasons in lacking.values() for reason in reasons if needed)]
    rows = {
        "model": f"{found.model}, {found.variables} variables",
        "FMI": f"{found.version}, {' and '.join(found.interfaces) or 'no interface'}",
        "description": _said(len(found.description), "valid"),
        "start": "fails" if found.start else "loads, initialises, takes a step",
        "bits": BITS[found.fingerprint],
        "fits": ", ".join(fits) or f"no robot ({', '.join(lacking)})",
    }
    for name, value in rows.items():
        typer.echo(f"{name + ':':<13}{value}")
    for problem in dict.fromkeys(problems):
        typer.echo(f"problem: {problem}", err=True)
    if problems:
        raise typer.Exit(FAILED)


def _lacking(robot: Robot, found: Findings) -> tuple[str, ...]:
    axes = [axis.name for axis in robot.axes]
    reasons = found.lacking(plant_inputs(axes), (*plant_outputs(axes), *BODY), units(axes))
    if "co-simulation" not in found.interfaces:
        return (*reasons, "it offers no co-simulation; export it with its solver")
    return reasons


def _said(count: int, good: str) -> str:
    return good if not count else "1 problem" if count == 1 else f"{count} problems"
