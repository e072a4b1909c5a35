"""`faults`: which faults a mission, a test and the failure report can put on a robot, and where."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.robot_argument import find_robot, names

if TYPE_CHECKING:
    from emulators.bench.faults import Kind
    from firmware_bridge.robot import AnyRobot

EXAMPLES: Final = """Examples:

`firmware-bridge faults` lists all of them, `firmware-bridge faults rome` those that ROME can have, and where.

In a mission: `[[fault]]` with `kind`, `at_s`, `for_s` and the keys; in a test:
`rig.fault("encoder_cable_off", node="one", for_s=2.0)`; keys in brackets may be left out."""
COMMON: Final = frozenset({"at_s", "title", "until_s", "for_s"})
"""Keys of every fault."""
HEADINGS: Final = ("fault", "where", "keys", "what happens")


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultsOptions:
    """List the faults that a mission or a test can name; of a robot those that it can have, and where.

    docs/faults.md has what the emulated device makes of each, and the values of the keys.
    """

    robot: Annotated[
        str | None,
        typer.Argument(
            metavar="ROBOT",
            help="An installed robot, or the path of a robot file.",
            show_default=False,
            autocompletion=names,
        ),
    ] = None


def run(given: FaultsOptions) -> None:
    """Do what `faults` says."""
    from rich.table import Table

    from emulators.bench.faults import KINDS
    from firmware_bridge.cli.tables import terminal

    robot = None if given.robot is None else find_robot(given.robot)
    places = {kind.name: _who(kind) for kind in KINDS.values()} if robot is None else _of(robot)
    table = Table(title="faults" if robot is None else f"faults of {robot.name}")
    for heading in HEADINGS:
        table.add_column(heading, overflow="fold")
    for name, where in places.items():
        table.add_row(name, where, ", ".join(_keys(KINDS[name])), KINDS[name].happens)
    terminal().print(table)


def _of(robot: "AnyRobot") -> dict[str, str]:
    """Return where each kind that a robot can have may be put."""
    from emulators.fmea.failures import failures_of

    found: dict[str, dict[str, None]] = {}
    for failure in failures_of(robot):
        found.setdefault(failure.kind, {})[failure.place] = None
    return {name: ", ".join(filter(None, places)) for name, places in found.items()}


def _who(kind: "Kind") -> str:
    return kind.fault.among.value if "node" in kind.fault.model_fields else ""


def _keys(kind: "Kind") -> Iterator[str]:
    for name, field in kind.fault.model_fields.items():
        if name not in COMMON:
            yield name if field.is_required() else f"({name})"


faults: Final = command(EXAMPLES, work=run)(FaultsOptions)
