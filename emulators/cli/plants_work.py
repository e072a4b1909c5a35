"""Lists and checks plants."""

from pathlib import Path
from typing import Final

import typer
from rich.table import Table

from emulators.bench.rehearsal import rehearsal_of
from emulators.devices import SUPPLY
from emulators.servo.bank import plant_inputs, plant_outputs
from firmware_bridge import kinds
from firmware_bridge.cli.console import FAILED, one_message, say
from firmware_bridge.cli.tables import terminal
from firmware_bridge.robot import AnyRobot
from fmu.check import Findings, examine
from fmu.errors import PlantError
from fmu.interface import units
from fmu.plants import find, names
from fmu.verify import Verdict

BITS: Final = {
    Verdict.SAME: "those that its equations give, in a run of its own",
    Verdict.OTHER: "others than its equations give",
    Verdict.NONE: "not compared: the FMU carries no fingerprint of ours that fits its variables",
}


def list_models() -> None:
    """Do what `fmu list` says."""
    table = Table(title="plants")
    for heading in ("model", "what it is", "states", "inputs", "outputs", "parameters", "robots"):
        table.add_column(heading, overflow="fold")
    robots = [kinds.find(name) for name in kinds.names()]
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
    say("each as FMI 2.0 or 3.0, with co-simulation and model exchange in one file")


def check(file: Path) -> None:
    """Do what `fmu check` says."""
    with one_message(PlantError):
        found = examine(file)
    lacking = {robot.name: _lacking(robot, found) for robot in map(kinds.find, kinds.names())}
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
        say(f"{name + ':':<13}{value}")
    for problem in dict.fromkeys(problems):
        say(f"problem: {problem}", err=True)
    if problems:
        raise typer.Exit(FAILED)


def _lacking(robot: AnyRobot, found: Findings) -> tuple[str, ...]:
    axes = [axis.name for axis in robot.axes]
    wanted = [column.plant for column in rehearsal_of(robot).columns if column.plant]
    outputs = dict.fromkeys((*plant_outputs(axes), SUPPLY, *wanted))
    reasons = found.lacking(plant_inputs(axes), tuple(outputs), units(axes))
    if "co-simulation" not in found.interfaces:
        return (*reasons, "it offers no co-simulation; export it with its solver")
    return reasons


def _said(count: int, good: str) -> str:
    return good if not count else "1 problem" if count == 1 else f"{count} problems"
