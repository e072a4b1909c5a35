"""`faults`: which faults a mission, a test and the failure report can put on a robot, and where."""

from collections.abc import Callable, Iterator, Mapping
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
ONE: Final = "a drive"
"""Place of a fault that takes the keys of a mission."""
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
            help="An installed robot, or the path of a robot file; or a device: board, epos2.",
            show_default=False,
            autocompletion=names,
        ),
    ] = None


def run(given: FaultsOptions) -> None:
    """Run the command `faults`."""
    from rich.table import Table

    from emulators.bench.faults import kinds
    from firmware_bridge.cli.tables import terminal

    alone = _alone()
    robot = None if given.robot is None or given.robot in alone else find_robot(given.robot)
    if robot is not None:
        places = _of(robot)
    elif given.robot is not None:
        places = dict(alone[given.robot]())
    else:
        places = {kind.name: _who(kind) for kind in kinds().values()}
    table = Table(title="faults" if given.robot is None else f"faults of {given.robot}")
    for heading in HEADINGS:
        table.add_column(heading, overflow="fold")
    for name, where in places.items():
        # `emulate board` takes no key but the motor.
        keys = ["node"][: bool(where)] if given.robot in alone and where != ONE else _keys(kinds()[name])
        table.add_row(name, where, ", ".join(keys), kinds()[name].happens)
    terminal().print(table)


def _of(robot: "AnyRobot") -> dict[str, str]:
    """Return where each kind that a robot can have may be put."""
    from emulators.bench.faults.failures import failures_of

    found: dict[str, dict[str, None]] = {}
    for failure in failures_of(robot):
        found.setdefault(failure.kind, {})[failure.place] = None
    return {name: ", ".join(filter(None, places)) for name, places in found.items()}


def _alone() -> "dict[str, Callable[[], Mapping[str, str]]]":
    """Return the families of which one device alone can have faults, and what lists these."""
    from emulators.family import families

    return {
        word: one.alone_faults
        for name, one in families().items()
        for word in (name, *one.aliases)
        if one.alone_faults is not None
    }


def _who(kind: "FaultKind") -> str:
    return kind.fault.among.value if "node" in kind.fault.model_fields else ""


def _keys(kind: "FaultKind") -> Iterator[str]:
    for name, field in kind.fault.model_fields.items():
        if name not in COMMON:
            yield name if field.is_required() else f"({name})"


faults: Final = command(EXAMPLES, work=run)(FaultsOptions)
