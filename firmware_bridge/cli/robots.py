"""`robots`: the installed robots and their files, each one checked; and the schema of a kind's robot file."""

import json
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Annotated, Final

import typer
from rich.table import Table

from firmware_bridge import robot_types
from firmware_bridge.cli.commands import command, completing
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.tables import terminal
from firmware_bridge.cli.watchdogs import RUNS_ON
from firmware_bridge.drivers.shield.plan import shield_plan
from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.robot.settings.ar2 import Ar2Link
from firmware_bridge.robot.settings.capture import CaptureLink
from firmware_bridge.robot.settings.shield import ShieldLink, ShieldProtocol
from firmware_bridge.units import MILLISECOND

EXAMPLES: Final = """Examples:

`firmware-bridge robots`

`firmware-bridge robots rover` checks one of them, `robots my_robot.toml` at a file of your own.

`firmware-bridge robots --schema rars > rars.schema.json` gives an editor all keys of such a file."""


@command(EXAMPLES)
def robots(
    wanted: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="ROBOT|FILE",
            help="Only these: installed robots, or robot files.",
            show_default=False,
            autocompletion=completing("firmware_bridge.cli.robot_argument:names"),
        ),
    ] = None,
    *,
    schema: Annotated[
        str | None,
        typer.Option(
            metavar="KIND",
            help="Print the JSON schema of this kind's robot files instead.",
            show_default=False,
            autocompletion=completing("firmware_bridge.cli.robot_argument:names"),
        ),
    ] = None,
) -> None:
    """List the robots that are installed, each file checked, with all its mistakes at once.

    Lists only those that are named, where some are.
    """
    if schema is not None:
        with one_message(RobotFileError):
            say(json.dumps(robot_types.schema_of(schema), indent=2))
        return
    table = Table(title="robots")
    for heading in ("robot", "axes", "links", "file", "check"):
        table.add_column(heading, overflow="fold")
    wrong = []
    for name, path in _named(wanted) if wanted else robot_types.robots().items():
        # A file of one's own has the name given in it.
        read = partial(robot_types.find, name) if name else partial(robot_types.load, path)
        try:
            # With the plant, so that a wrong parameter is reported here and not at the bench's start.
            table.add_row(*_row(name, read(plant_too=True), path))
        except RobotFileError as error:
            wrong.append(error)
            table.add_row(name or path.stem, "", "", str(path) if path.name else "", "[red]wrong[/]")
    for name, why in () if wanted else robot_types.unloadable().items():
        wrong.append(why)
        table.add_row(name, "", "", "", "[red]cannot be loaded[/]")
    terminal().print(table)
    if wrong:
        raise refusal("\n".join(map(str, wrong)))


def _named(wanted: Iterable[str]) -> Iterator[tuple[str, Path]]:
    """Yield each robot's name and file; the name is empty where it is a path."""
    installed = robot_types.robots()
    for word in wanted:
        path = Path(word)
        # A name wins over a folder of the same name; a path has a suffix or is a file.
        named = word in installed or (path.name == word and path.suffix != ".toml" and not path.is_file())
        yield (word, installed.get(word, Path())) if named else ("", path)


def _row(name: str, robot: AnyRobot, path: Path) -> tuple[str, str, str, str, str]:
    axes = "\n".join(f"{axis.settings.number} {axis.title}" for axis in robot.axes)
    links = "\n".join(_link(robot, name) for name in robot.links)
    weaker: dict[str, list[str]] = {}
    for axis, strong, row in robot_types.weaker_rows(robot):
        weaker.setdefault(f"{row.name} in place of {strong.name}", []).append(axis)
    check = "\n".join(["[green]good[/]", *(f"{what}: {', '.join(axes)}" for what, axes in weaker.items())])
    return f"{name or robot.name}\n[dim]{robot.title}[/]", axes, links, str(path), check


def _link(robot: AnyRobot, name: str) -> str:
    """Say what a link is, how often its devices are commanded, and how full a line to a board is then."""
    link = robot.links[name]
    every = f"every {link.every * robot.cycle_ms} ms"
    if isinstance(link, CaptureLink):
        return f"{name}: {link.driver.value} from {link.server}"
    if isinstance(link, Ar2Link):
        return f"{name}: {link.driver.value}, {link.line_rate} Bd, moves of {link.move_ms} ms\n{every}"
    if not isinstance(link, ShieldLink):
        return f"{name}: {link.driver.value}, {link.bit_rate // 1000} kbit/s\n{every}"
    rows = [f"{name}: {link.driver.value}, {link.protocol.value}, {link.line_rate} Bd", every]
    for protocol in ShieldProtocol:
        other = robot.with_links({name: link.over(protocol, robot.cycle_ms, None)})
        plan, table = shield_plan(other, name), other.shield_link(name)
        rows.append(
            f"{protocol.value}: {table.counted} encoders, a reversal takes {plan.time / MILLISECOND:.0f} of "
            f"{plan.cycle // MILLISECOND} ms" + ("; NO WATCHDOG" if table.unwatched else "")
        )
    if link.unwatched:
        rows.insert(1, f"NO WATCHDOG: {RUNS_ON}")
    return "\n".join(rows)
