"""`faults`: which faults a mission, a test and the failure report can put on a robot, and where."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.robot_argument import find_robot, names

if TYPE_CHECKING:
    from emulators.bench.faults import FaultKind
    from firmware_bridge.robot import AnyRobot

EXAMPLES: Final = """Examples:

`firmware-bridge faults` lists all of them, `firmware-bridge faults rome` those that ROME can have, and where.

`firmware-bridge faults board` lists those of `emulate board --fault`, `faults epos2` those of a drive.

In a mission: `[[fault]]` with `kind`, `at_s`, `for_s` and the keys; in a test:
`rig.fault("encoder_cable_off", node="one", for_s=2.0)`; keys in brackets may be left out."""
COMMON: Final = frozenset({"at_s", "title", "until_s", "for_s"})
"""Keys of every fault."""
HEADINGS: Final = ("fault", "where", "keys", "what happens")


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultsOptions:
    """List the faults of missions and tests; for a robot those that are possible on it, and where.

    docs/faults.md has the reaction of the emulated device to each, and the values of the keys.
    """

    robot: Annotated[
        str | None,
        typer.Argument(
            metavar="ROBOT|DEVICE",
            help="An installed robot, or the path of a robot file; or a device: board, epos2, cia402.",
            show_default=False,
            autocompletion=names,
        ),
    ] = None


def run(given: FaultsOptions) -> None:
    """Run the command `faults`."""
    from rich.table import Table

    from emulators.bench.faults import kinds
    from firmware_bridge.cli.tables import terminal

    stand_in = _alone().get(given.robot or "")
    if stand_in is not None:
        places = _of(stand_in(), alone=True)
    elif given.robot is not None:
        places = _of(find_robot(given.robot))
    else:
        places = {kind.name: _who(kind) for kind in kinds().values()}
    table = Table(title="faults" if given.robot is None else f"faults of {given.robot}")
    for heading in HEADINGS:
        table.add_column(heading, overflow="fold")
    for name, where in places.items():
        table.add_row(name, where, ", ".join(_keys(kinds()[name])), kinds()[name].happens)
    terminal().print(table)


def _of(robot: "AnyRobot", *, alone: bool = False) -> dict[str, str]:
    """Return where each kind that a robot can have may be put; `alone`: a device on a real bus or line."""
    from emulators.bench.faults import kinds
    from emulators.bench.faults.failures import failures_of
    from emulators.control.live import ON_PTYS

    found: dict[str, dict[str, None]] = {}
    for failure in failures_of(robot):
        fault = kinds()[failure.kind].fault.model_validate({"at_s": 0.0, **failure.keys})
        if not alone or failure.kind in ON_PTYS or not fault.real_bus_problem(robot):
            found.setdefault(failure.kind, {})[failure.place] = None
    return {name: ", ".join(filter(None, places)) for name, places in found.items()}


def _alone() -> "dict[str, Callable[[], AnyRobot]]":
    """Return the families of which `emulate` runs a device alone, and what returns its stand-in."""
    from emulators.family import families

    return {
        word: one.alone
        for name, one in families().items()
        for word in (name, *one.aliases)
        if one.alone is not None
    }


def _who(kind: "FaultKind") -> str:
    return kind.fault.among.value if "node" in kind.fault.model_fields else ""


def _keys(kind: "FaultKind") -> Iterator[str]:
    for name, field in kind.fault.model_fields.items():
        if name not in COMMON:
            yield name if field.is_required() else f"({name})"


faults: Final = command(EXAMPLES, work=run)(FaultsOptions)
